"""Who writes, and how a person answers for what is written: the one place with keys.

    signature = Ed25519("axiscal-signature/1" newline JSON of document, person, computer and public key, keys in order)

The key is a file of the user's that nobody else may read. Whoever has none writes the same, unsigned.

Few readers of XML know Ed25519. So each XML document gets an ECDSA key of its own, which is forgotten afterwards, and
the person's key certifies it (X.509, RFC 8410).
"""

from __future__ import annotations

import contextlib
import datetime
import getpass
import hashlib
import json
import os
import platform
from collections.abc import Iterable, Iterator, Mapping
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from axiscal.document.consent import user_folder
from axiscal.exceptions import RecordError

if TYPE_CHECKING:
    from cryptography import x509
    from cryptography.hazmat.primitives.asymmetric.ec import EllipticCurvePrivateKey, EllipticCurvePublicKey
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey, Ed25519PublicKey

PERSON, KEY, PEOPLE = "AXISCAL_PERSON", "AXISCAL_KEY", "AXISCAL_PEOPLE"
"""Variables of the environment: the name of who writes, the file of the key, and that of the keys of people."""
_YEARS = 20
"""Of the shop's certificate: longer than a computer lasts."""


class Hand(NamedTuple):
    """Who writes."""

    person: str
    computer: str


class Writer(NamedTuple):
    """Who takes a step, "" for the user of this computer, and the id of that step, "" for none."""

    person: str = ""
    step: str = ""


_NOBODY = Writer()
_WRITER: ContextVar[Writer] = ContextVar("writer", default=_NOBODY)


@contextlib.contextmanager
def writing(**by: str) -> Iterator[None]:
    """Let all that is written in the block be by a person, or of a step.  by : fields of `Writer`"""
    before = _WRITER.set(_WRITER.get()._replace(**by))
    try:
        yield
    finally:
        _WRITER.reset(before)


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


def hand_now() -> Hand:
    """Return who takes a step now: the person of the block that is `writing`, else of this computer."""
    own = own_hand()
    return own._replace(person=_WRITER.get().person or own.person)


def step_now() -> str:
    """Return the id of the step that is taken now, "" for none."""
    return _WRITER.get().step


def key_file() -> Path:
    """Return where the key of this person is, or would be."""
    if named := os.environ.get(KEY):
        return Path(named)
    return user_folder() / "key.pem"


def people_file() -> Path:
    """Return where the keys of the people are that this one knows: lines of a public key in hex and a name."""
    return Path(os.environ.get(PEOPLE) or key_file().with_name("people.txt"))


def is_known(key: str) -> bool:
    """Return whether a public key is this person's own, or of somebody in the file of people."""
    with contextlib.suppress(OSError, UnicodeDecodeError):
        if key in (line.split()[0].lower() for line in people_file().read_text("utf-8").splitlines() if line.strip()):
            return True
    with contextlib.suppress(RecordError):
        own = _own_key()
        return own is not None and own.public_key().public_bytes_raw().hex() == key
    return False


def make_key() -> None:
    """Make the key of this person unless there is one; raises OSError."""
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

    path = key_file()
    if path.exists():
        return
    _keep_secret(path, Ed25519PrivateKey.generate(), b"")


def _keep_secret(path: Path, key: Ed25519PrivateKey | EllipticCurvePrivateKey, behind: bytes) -> None:
    """Write a key that nobody else may read, and what stands behind it in its file; raises OSError."""
    from cryptography.hazmat.primitives import serialization as form

    path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    secret = key.private_bytes(form.Encoding.PEM, form.PrivateFormat.PKCS8, form.NoEncryption())
    with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
        file.write(secret + behind)


def shop_certificate() -> tuple[Path, str]:
    """Return the file of the certificate by which this computer answers its shop, with its key, and its fingerprint.

    It is made once and signs itself, so that a person compares the fingerprint: SHA-256, in pairs of hex digits.
    Raises OSError, RecordError for one that cannot be used.
    """
    from cryptography import x509
    from cryptography.hazmat.primitives.hashes import SHA256

    folder = os.environ.get("XDG_DATA_HOME") or os.environ.get("LOCALAPPDATA")
    path = (Path(folder) if folder else Path.home() / ".local" / "share") / "axiscal" / "shop.pem"
    if not path.exists():
        _make_certificate(path)
    _refuse_shared(path)
    try:
        found = x509.load_pem_x509_certificate(path.read_bytes())
    except ValueError as fault:
        what, remedy = "The certificate cannot be read: {reason}", "Remove it; another one is made"
        raise RecordError(what, remedy, path, reason=fault) from None
    return path, found.fingerprint(SHA256()).hex(":").upper()


def _make_certificate(path: Path) -> None:
    from cryptography import x509
    from cryptography.hazmat.primitives import serialization as form
    from cryptography.hazmat.primitives.asymmetric import ec
    from cryptography.hazmat.primitives.hashes import SHA256

    key, computer = ec.generate_private_key(ec.SECP256R1()), own_hand().computer[:64] or "axiscal"
    name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, computer)])
    today = datetime.datetime.now(datetime.UTC)
    certificate = (
        x509.CertificateBuilder(name, name, key.public_key(), x509.random_serial_number())
        .not_valid_before(today - datetime.timedelta(days=1))  # clocks of tablets differ
        .not_valid_after(today + datetime.timedelta(days=_YEARS * 365))
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .sign(key, SHA256())
    )
    _keep_secret(path, key, certificate.public_bytes(form.Encoding.PEM))


def signature(document: Mapping[str, object]) -> Signature | None:
    """Return the signature of this person over a document, None without a key; raises RecordError for a bad one."""
    key = _own_key()
    if key is None:
        return None
    public = key.public_key().public_bytes_raw().hex()
    unsigned = Signature(*own_hand(), public, "")
    return unsigned._replace(signature=key.sign(_message(document, unsigned)).hex())


def signed_xml(document: bytes, what: str) -> bytes:
    """Return an XML document with this person's XAdES signature as its last element, the same one without a key.

    It covers the whole document, time and certificates (ETSI EN 319 132-1).  Raises RecordError for a bad key.
    what : the document's kind
    """
    key = _own_key()
    if key is None:
        return document
    from cryptography.hazmat.primitives.asymmetric import ec
    from lxml import etree
    from signxml.algorithms import CanonicalizationMethod as Canonical
    from signxml.xades.xades import XAdESDataObjectFormat, XAdESSigner

    once = ec.generate_private_key(ec.SECP256R1())
    # Where a reference names no canonical form, readers take this one (XML Signature, 4.4.3.2).
    signer = XAdESSigner(
        signature_algorithm="ecdsa-sha256",
        c14n_algorithm=Canonical.CANONICAL_XML_1_0,
        data_object_format=XAdESDataObjectFormat(Description=what),
    )
    chain = [_certificate(once.public_key(), key), _certificate(key.public_key(), key)]
    root = signer.sign(etree.fromstring(document), key=once, cert=chain, always_add_key_value=False)
    return bytes(etree.tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"


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


def what_is_signed(at: str, entries: Iterable[tuple[str, str]]) -> dict[str, object]:
    """Return the document that a signature in a log is of.

    at : time of the signature;  entries : time of writing and chain of all events before it
    """
    lines = "".join(f"{written} {chain}\n" for written, chain in entries)
    return {"at": at, "before": hashlib.sha256(lines.encode()).hexdigest()}


def _message(document: Mapping[str, object], by: Signature) -> bytes:
    whole = {**document, "person": by.person, "computer": by.computer, "key": by.key}
    text = json.dumps(whole, ensure_ascii=False, separators=(",", ":"), sort_keys=True)
    return f"axiscal-signature/1\n{text}".encode()


def _certificate(of: EllipticCurvePublicKey | Ed25519PublicKey, by: Ed25519PrivateKey) -> x509.Certificate:
    """Return a certificate by a person, of the person's own key or of one for a single document; it always holds."""
    from cryptography import x509

    own, key = of == by.public_key(), by.public_key().public_bytes_raw().hex()
    person = x509.NameAttribute(x509.NameOID.COMMON_NAME, own_hand().person[:64])
    issuer = x509.Name([person, x509.NameAttribute(x509.NameOID.SERIAL_NUMBER, key)])
    subject = issuer if own else x509.Name([person])
    signs = x509.KeyUsage(not own, not own, False, False, False, own, own, False, False)
    identifier = x509.SubjectKeyIdentifier.from_public_key(of)
    return (
        x509.CertificateBuilder(issuer, subject, of, int.from_bytes(identifier.digest[:16]) + 1)
        .not_valid_before(datetime.datetime(2000, 1, 1))
        .not_valid_after(datetime.datetime(9999, 12, 31, 23, 59, 59))  # RFC 5280, 4.1.2.5
        .add_extension(x509.BasicConstraints(ca=own, path_length=0 if own else None), critical=True)
        .add_extension(signs, critical=True)
        .add_extension(identifier, critical=False)
        .sign(by, None)
    )


def _refuse_shared(path: Path) -> None:
    if os.name == "posix" and path.stat().st_mode & 0o077:
        raise RecordError("Others may read this key", "Keep it to yourself: chmod 600 {path}", path, path=path)


def _own_key() -> Ed25519PrivateKey | None:
    path = key_file()
    if not path.exists():
        return None
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
    from cryptography.hazmat.primitives.serialization import load_pem_private_key

    _refuse_shared(path)
    try:
        key = load_pem_private_key(path.read_bytes(), None)
    except (OSError, TypeError, ValueError) as fault:
        raise RecordError("The key cannot be read: {reason}", "Put it back from a copy", path, reason=fault) from None
    if not isinstance(key, Ed25519PrivateKey):
        raise RecordError("This is no key of Ed25519", "Name another file by {key}", path, key=KEY)
    return key
