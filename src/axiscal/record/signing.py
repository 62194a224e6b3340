"""Who writes, and how a person answers for what is written: the one place with keys.

    signature = Ed25519("axiscal-signature/1" newline JSON of document, person, computer and public key, keys in order)

The key is a file of the user's that nobody else may read. Whoever has none writes the same, unsigned.
"""

from __future__ import annotations

import contextlib
import getpass
import hashlib
import json
import os
import platform
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from axiscal.document.consent import user_folder
from axiscal.exceptions import RecordError
from axiscal.record.events import Event, Signed, Stored, fold
from axiscal.record.lines import EMPTY, EventText, chained
from axiscal.record.payload import encode

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

PERSON, KEY = "AXISCAL_PERSON", "AXISCAL_KEY"
"""Variables of the environment: the name of who writes, and the file of the key."""


class Hand(NamedTuple):
    """Who writes."""

    person: str
    computer: str


def own_hand() -> Hand:
    """Return who writes here: the user of this computer, unless AXISCAL_PERSON names somebody."""
    try:
        person = os.environ.get(PERSON) or getpass.getuser()
    except (KeyError, OSError):  # a user without a name, as in containers
        person = "nobody"
    return Hand(*(name.encode("utf-8", "replace").decode() for name in (person, platform.node())))


def rows_of(events: Sequence[Event]) -> list[EventText]:
    """Return events as this person writes them now; raises ValueError for one that cannot be kept."""
    at, by = now(), own_hand()._asdict()
    return [EventText(at, *encode(event, **by)) for event in events]


def now() -> str:
    """Return the time as a record has it: ISO 8601, UTC."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def hand_of(row: EventText) -> Hand:
    """Return who wrote an event, "" where it does not say it."""
    found = json.loads(row.payload)
    return Hand(*(found.get(name, "") for name in Hand._fields))


def key_file() -> Path:
    """Return where the key of this person is, or would be."""
    if named := os.environ.get(KEY):
        return Path(named)
    return user_folder() / "key.pem"


def is_own(key: str) -> bool:
    """Return whether a public key is this person's."""
    with contextlib.suppress(RecordError):
        own = _own_key()
        return own is not None and _public(own) == key
    return False


def make_key() -> None:
    """Make the key of this person, which nobody else may read, unless there is one; raises OSError."""
    from cryptography.hazmat.primitives import serialization as form
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

    path = key_file()
    if path.exists():
        return
    path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    secret = Ed25519PrivateKey.generate().private_bytes(
        form.Encoding.PEM, form.PrivateFormat.PKCS8, form.NoEncryption()
    )
    with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
        file.write(secret)


def signed_row(rows: Sequence[EventText]) -> EventText | None:
    """Return the event by which this person answers for all events so far; None without a key, or if that is the last.

    Raises RecordError for a key that is none
    """
    if (key := _own_key()) is None:
        return None
    at, hand, public = now(), own_hand(), _public(key)
    if rows[-1].kind == "signed" and public in rows[-1].payload:
        return None
    event = Signed(public, key.sign(_message(at, rows, hand, public)).hex())
    return EventText(at, *encode(event, **hand._asdict()))


def holds(row: EventText, event: Signed, before: Sequence[EventText]) -> bool:
    """Return whether a signature is of the events before it.  row : the event as it was written"""
    from cryptography.exceptions import InvalidSignature
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey

    try:
        public, message = bytes.fromhex(event.key), _message(row.at, before, hand_of(row), event.key)
        Ed25519PublicKey.from_public_bytes(public).verify(bytes.fromhex(event.signature), message)
    except (InvalidSignature, ValueError):
        return False
    return True


def _message(at: str, rows: Sequence[EventText], hand: Hand, key: str) -> bytes:
    """Return what is signed: who signs and when, and time and chain of all events before it."""
    digest, chain = hashlib.sha256(), EMPTY
    for row in rows:
        chain = chained(chain, row)
        digest.update(f"{row.at} {chain}\n".encode())
    whole = {"at": at, "before": digest.hexdigest(), "key": key, **hand._asdict()}
    text = json.dumps(whole, ensure_ascii=False, separators=(",", ":"), sort_keys=True)
    return f"axiscal-signature/1\n{text}".encode()


def _public(key: Ed25519PrivateKey) -> str:
    return key.public_key().public_bytes_raw().hex()


def _own_key() -> Ed25519PrivateKey | None:
    path = key_file()
    if not path.exists():
        return None
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
    from cryptography.hazmat.primitives.serialization import load_pem_private_key

    if os.name == "posix" and path.stat().st_mode & 0o077:
        raise RecordError("Others may read this key", "Keep it to yourself: chmod 600 {path}", path, path=path)
    try:
        key = load_pem_private_key(path.read_bytes(), None)
    except (OSError, TypeError, ValueError) as fault:
        raise RecordError("The key cannot be read: {reason}", "Put it back from a copy", path, reason=fault) from None
    if not isinstance(key, Ed25519PrivateKey):
        raise RecordError("This is no key of Ed25519", "Name another file by {key}", path, key=KEY)
    return key


class SignedUntil(NamedTuple):
    """How far a log is signed: the number of the event, whose it is, whether every signature is of what was before.

    key, signature : in hex; reading : the number of the last reading that stood then
    """

    number: int
    person: str
    computer: str
    key: str
    signature: str
    holds: bool
    reading: int


def signed_until(events: Sequence[Stored], rows: Sequence[EventText]) -> SignedUntil | None:
    """Return the last signature of a record, or the first that does not hold; None where nobody has signed."""
    found = None
    for number, event in ((each.number, each.event) for each in events if isinstance(each.event, Signed)):
        row = rows[number - 1]
        found = number, *hand_of(row), event.key, event.signature, holds(row, event, rows[: number - 1])
        if not found[-1]:
            break
    if found is None:
        return None
    readings = fold(events[: found[0]]).readings
    return SignedUntil(*found, readings[-1].numbered(len(readings) - 1) if readings else 0)
