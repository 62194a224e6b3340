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
from collections.abc import Mapping, Sequence
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


class Signature(NamedTuple):
    """Who answers for something: public key and signature in hex."""

    person: str
    computer: str
    key: str
    signature: str


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


def hand_of(text: str) -> Hand | None:
    """Return who wrote an event, by its JSON text; None where that does not say it."""
    found = json.loads(text)
    return Hand(*(found[name] for name in Hand._fields)) if found.keys() >= set(Hand._fields) else None


def key_file() -> Path:
    """Return where the key of this person is, or would be."""
    if named := os.environ.get(KEY):
        return Path(named)
    return user_folder() / "key.pem"


def is_own(key: str) -> bool:
    """Return whether a public key is this person's."""
    with contextlib.suppress(RecordError):
        own = _own_key()
        return own is not None and own.public_key().public_bytes_raw().hex() == key
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


def signature(document: Mapping[str, object]) -> Signature | None:
    """Return the signature of this person over a document, None without a key; raises RecordError for a bad one."""
    key = _own_key()
    if key is None:
        return None
    public = key.public_key().public_bytes_raw().hex()
    unsigned = Signature(*own_hand(), public, "")
    return unsigned._replace(signature=key.sign(_message(document, unsigned)).hex())


def holds(document: Mapping[str, object], signed: Signature) -> bool:
    """Return whether a signature is of this document."""
    from cryptography.exceptions import InvalidSignature
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey

    try:
        public = Ed25519PublicKey.from_public_bytes(bytes.fromhex(signed.key))
        public.verify(bytes.fromhex(signed.signature), _message(document, signed))
    except (InvalidSignature, ValueError):
        return False
    return True


def _message(document: Mapping[str, object], by: Signature) -> bytes:
    whole = {**document, "person": by.person, "computer": by.computer, "key": by.key}
    text = json.dumps(whole, ensure_ascii=False, separators=(",", ":"), sort_keys=True)
    return f"axiscal-signature/1\n{text}".encode()


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

    reading : the number of the last reading that stood then
    """

    number: int
    by: Signature
    holds: bool
    reading: int


def signed_until(events: Sequence[Stored], rows: Sequence[EventText]) -> SignedUntil | None:
    """Return the last signature of a record, or the first that does not hold; None where nobody has signed."""
    found = None
    for number, event in ((each.number, each.event) for each in events if isinstance(each.event, Signed)):
        found = number, *signed_by(rows[number - 1], event, rows[: number - 1])
        if not found[2]:
            break
    if found is None:
        return None
    readings = fold(events[: found[0]]).readings
    return SignedUntil(*found, readings[-1].numbered(len(readings) - 1) if readings else 0)


def signed_by(row: EventText, event: Signed, before: Sequence[EventText]) -> tuple[Signature, bool]:
    """Return whose signature one is, and whether it is of the events before it."""
    by = Signature(*(hand_of(row.payload) or Hand("", "")), event.key, event.signature)
    return by, holds(signable(row.at, before), by)


def signable(at: str, rows: Sequence[EventText]) -> dict[str, object]:
    """Return the document that a signature is of: its time, and time and chain of all events before it."""
    digest, chain = hashlib.sha256(), EMPTY
    for row in rows:
        chain = chained(chain, row)
        digest.update(f"{row.at} {chain}\n".encode())
    return {"at": at, "before": digest.hexdigest()}
