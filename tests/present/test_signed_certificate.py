"""A certificate of somebody who has a key: signed, and still as the schemas want it."""

from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree
from signxml.xades.xades import XAdESSignatureConfiguration, XAdESVerifier

from axiscal.present.rendering import certificate
from axiscal.record.signing import KEY, make_key
from tests.present.test_page import five_axis_summary

DCC = "https://ptb.de/dcc"


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
