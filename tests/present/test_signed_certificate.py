"""A certificate of somebody who has a key: signed, and still as the schemas want it."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
import signxml
from lxml import etree
from signxml.xades.xades import XAdESSignatureConfiguration, XAdESVerifier

from axiscal.present.rendering import certificate
from axiscal.record.signing import KEY, make_key
from tests.present.test_page import five_axis_summary

DCC = "https://ptb.de/dcc"
SCHEMA = """<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema" targetNamespace="https://ptb.de/dcc"
  xmlns:ds="http://www.w3.org/2000/09/xmldsig#" elementFormDefault="qualified">
<xs:import namespace="http://www.w3.org/2000/09/xmldsig#" schemaLocation="xmldsig-core-schema.xsd"/>
<xs:element name="digitalCalibrationCertificate"><xs:complexType><xs:sequence>
<xs:element name="administrativeData"/><xs:element name="measurementResults"/>
<xs:element ref="ds:Signature" minOccurs="0" maxOccurs="unbounded"/></xs:sequence>
<xs:attribute name="schemaVersion"/></xs:complexType></xs:element></xs:schema>"""
"""The root of PTB's schema: signatures come last, as W3C's schema wants them."""


@pytest.fixture
def signed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> bytes:
    """A certificate that somebody signed."""
    monkeypatch.setenv(KEY, str(tmp_path / "key.pem"))
    make_key()
    return certificate(five_axis_summary(2))


def test_the_signature_covers_the_whole_certificate(signed: bytes) -> None:
    config = XAdESSignatureConfiguration(expect_references=3)
    first = next(etree.fromstring(signed).iter("{*}X509Certificate")).text
    whole = XAdESVerifier().verify(signed, x509_cert=first, expect_config=config)[0].signed_xml
    assert whole is not None
    assert len(whole.findall(f".//{{{DCC}}}quantity")) == signed.count(b"<dcc:quantity>") > 0


def test_the_signature_is_as_the_schemas_want_it(signed: bytes, tmp_path: Path) -> None:
    schema = tmp_path / "dcc.xsd"
    schema.write_text(SCHEMA)
    shutil.copy(Path(signxml.__file__).parent / "schemas" / "xmldsig-core-schema.xsd", tmp_path)
    wanted = etree.XMLSchema(file=str(schema))
    wanted.assertValid(etree.fromstring(signed))
    assert not wanted.validate(etree.fromstring(signed.replace(b":SignatureValue>", b":Value>")))


def test_without_a_key_there_is_no_signature() -> None:
    assert b"Signature" not in certificate(five_axis_summary(2))
