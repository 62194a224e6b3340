"""XAdES signatures: what they cover, whose they are, that a change breaks them, and ETSI's schema."""

from __future__ import annotations

import re
from base64 import b64decode
from pathlib import Path

import pytest
import signxml
from cryptography import x509
from cryptography.hazmat.primitives.serialization import load_pem_private_key
from lxml import etree
from signxml.exceptions import InvalidSignature
from signxml.xades.xades import XAdESSignatureConfiguration, XAdESVerifier

from axiscal.exceptions import RecordError
from axiscal.record.signing import KEY, PERSON, make_key, signed_xml

DS, XADES = "http://www.w3.org/2000/09/xmldsig#", "http://uri.etsi.org/01903/v1.3.2#"
USAGES = (
    *("digital_signature", "content_commitment", "key_encipherment", "data_encipherment", "key_agreement"),
    *("key_cert_sign", "crl_sign"),
)
DOCUMENT = """<?xml version="1.0" encoding="utf-8"?>
<all xmlns="of:all">
  <each>1.5</each>
  <each>å</each>
</all>
""".encode()


@pytest.fixture
def signed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> bytes:
    """A document that Anna signed."""
    _be(monkeypatch, tmp_path, "Anna Å")
    return signed_xml(DOCUMENT, "list")


def _be(monkeypatch: pytest.MonkeyPatch, folder: Path, person: str) -> None:
    monkeypatch.setenv(KEY, str(folder / f"{person}.pem"))
    monkeypatch.setenv(PERSON, person)
    make_key()


def _chain(document: bytes) -> list[x509.Certificate]:
    """Return the certificates in a signature: of the key that signed, and of the person."""
    found = etree.fromstring(document).iter(f"{{{DS}}}X509Certificate")
    return [x509.load_der_x509_certificate(b64decode(each.text)) for each in found]


def _covered(document: bytes) -> list[etree._Element]:
    """Return what the signature of a certificate covers; raises InvalidSignature."""
    config = XAdESSignatureConfiguration(expect_references=3)
    found = XAdESVerifier().verify(document, x509_cert=_chain(document)[0], expect_config=config)
    return [each.signed_xml for each in found]


def test_the_signature_covers_the_certificate_its_time_and_its_keys(signed: bytes) -> None:
    whole, properties, keys = _covered(signed)
    assert [each.text for each in whole] == ["1.5", "å"]
    assert properties.find(f".//{{{XADES}}}SigningTime") is not None
    assert properties.findtext(f".//{{{XADES}}}Description") == "list"
    assert len(keys.findall(f".//{{{DS}}}X509Certificate")) == 2


def test_the_key_of_the_person_answers_for_it(signed: bytes, tmp_path: Path) -> None:
    once, own = _chain(signed)
    once.verify_directly_issued_by(own)
    own.verify_directly_issued_by(own)
    key = load_pem_private_key((tmp_path / "Anna Å.pem").read_bytes(), None)
    assert own.public_key() == key.public_key()
    assert once.subject.rfc4514_string() == "CN=Anna Å"
    again = _chain(signed_xml(DOCUMENT, "list"))
    assert again[1] == own  # whoever has seen it once knows it
    assert again[0].public_key() != once.public_key()


def test_the_person_certifies_one_key_that_signs_and_certifies_nothing(signed: bytes) -> None:
    for each, own in zip(_chain(signed), (False, True), strict=True):
        limits, usage = (
            each.extensions.get_extension_for_class(kind).value for kind in (x509.BasicConstraints, x509.KeyUsage)
        )
        assert limits == x509.BasicConstraints(ca=own, path_length=0 if own else None)
        may = {name for name in USAGES if getattr(usage, name)}
        assert may == ({"key_cert_sign", "crl_sign"} if own else {"digital_signature", "content_commitment"})
        critical = {extension.oid: extension.critical for extension in each.extensions}
        assert critical[x509.BasicConstraints.oid]  # RFC 5280, 4.2.1.9 and 4.2.1.3
        assert critical[x509.KeyUsage.oid]
        assert 0 < each.serial_number < 2**159  # 4.1.2.2: positive, and 20 octets at most
        assert (each.not_valid_before_utc.year, each.not_valid_after_utc.isoformat()[:10]) == (2000, "9999-12-31")


@pytest.mark.parametrize(
    "change",
    [
        (rb"1\.5", b"1.6"),
        (rb"<each>.*?</each>", b""),
        (rb"(<xades:SigningTime>)2", rb"\g<1>3"),
        (rb"</ds:X509Certificate><ds:X509Certificate>[^<]*", b""),
    ],
    ids=["figure", "element", "time", "person"],
)
def test_a_change_breaks_the_signature(signed: bytes, change: tuple[bytes, bytes]) -> None:
    changed = re.sub(*change, signed, count=1)
    assert changed != signed
    with pytest.raises(InvalidSignature):
        _covered(changed)


def test_a_signature_stands_below_no_other_document(signed: bytes) -> None:
    other = signed_xml(DOCUMENT.replace(b"1.5", b"2.5"), "list")
    cut = [text.index(b"<ds:Signature ") for text in (other, signed)]
    with pytest.raises(InvalidSignature):
        _covered(other[: cut[0]] + signed[cut[1] :])


def test_nobody_signs_for_somebody_else(signed: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    anna = _chain(signed)[1]
    _be(monkeypatch, tmp_path, "Otto")
    otto = signed_xml(DOCUMENT, "list")
    _covered(otto)
    with pytest.raises(ValueError, match="subject"):
        _chain(otto)[0].verify_directly_issued_by(anna)


def test_what_is_added_is_as_etsi_wants_it(signed: bytes) -> None:
    root = etree.fromstring(signed)
    assert root[-1].tag == f"{{{DS}}}Signature"
    schemas = Path(signxml.__file__).parent / "xades" / "schemas"
    added = root.find(f".//{{{XADES}}}QualifyingProperties")
    etree.XMLSchema(file=str(schemas / "XAdES01903v132-201601.xsd")).assertValid(added)


def test_without_a_key_there_is_no_signature() -> None:
    assert signed_xml(DOCUMENT, "list") == DOCUMENT


def test_a_bad_key_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "bad.pem").write_text("no key")
    (tmp_path / "bad.pem").chmod(0o600)
    monkeypatch.setenv(KEY, str(tmp_path / "bad.pem"))
    with pytest.raises(RecordError, match=r"bad\.pem"):
        signed_xml(DOCUMENT, "list")
