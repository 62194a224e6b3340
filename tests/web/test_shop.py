"""Devices of the shop: over TLS, each person's by a code that works once, and what they read bears a name."""

from __future__ import annotations

import hashlib
import json
import os
import re
import socket
import ssl
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
import segno

from axiscal.exceptions import InputError, RecordError
from axiscal.record.signing import shop_certificate
from axiscal.web.shop import CODE_LASTS, ShopDoor
from tests.commands import Command
from tests.web.browser import Browser, Page
from tests.web.served import Answer, Served, served, started
from tests.web.test_page import looked_at, stand, type_reading

SHOP = ("--shop", "--person", "Anna", "--person", "Ben", "--at", "127.0.0.1:0")


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A campaign that is served to the shop."""
    folder = tmp_path_factory.mktemp("shop")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_DATA_HOME", str(folder / "data"))
        with served(started(folder), *SHOP) as running:
            yield running


def codes(page: Served) -> dict[str, str]:
    """Return the addresses that codes open, by person, as a terminal shows them."""
    return dict(re.findall(r"^(\w+): scan it within 10 min, or open (\S+)$", page.printed, re.MULTILINE))


def device(page: Served, address: str = "") -> Served:
    """Return the same server as a device sees it that trusts the certificate alone."""
    folder = Path(os.environ["XDG_DATA_HOME"])
    trusted = ssl.create_default_context(cafile=folder / "axiscal" / "shop.pem")
    trusted.check_hostname = False  # addresses change, the fingerprint does not
    return replace(page, address=address or next(iter(codes(page).values())), devices=trusted)


def come_in(device: Served, code: str) -> Answer:
    """Return what the server says to a code."""
    return device.ask("POST", "/api/1/devices", json.dumps({"code": code}).encode())


def let_in(page: Served, person: str) -> Served:
    """Return the server as a device sees it that a code of the page has let in."""
    code = page.call("codes", person=person).document["address"]
    outside = device(page, code)
    found = come_in(outside, code.partition("=")[2]).document
    assert found["person"] == person
    return replace(outside, address=f"{code.partition('#')[0]}#{found['bearer']}")


def test_the_certificate_is_the_one_whose_fingerprint_is_shown(page: Served) -> None:
    shown = re.findall(r"SHA-256 of the certificate: (\S+)", page.printed)[0]
    certificate = ssl.get_server_certificate(("127.0.0.1", device(page).port))
    assert hashlib.sha256(ssl.PEM_cert_to_DER_cert(certificate)).hexdigest().upper() == shown.replace(":", "")
    assert page.call("codes", person="Eve").document["fingerprint"] == shown
    assert device(page).ask("GET", "/").status == 200


def test_a_certificate_is_made_once_and_nobody_else_reads_its_key(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    file, fingerprint = shop_certificate()
    assert (shop_certificate(), file.stat().st_mode & 0o777) == ((file, fingerprint), 0o600)
    file.chmod(0o640)
    with pytest.raises(RecordError, match="chmod 600"):
        shop_certificate()
    file.chmod(0o600)
    file.write_text("nothing")
    with pytest.raises(RecordError, match="Remove it"):
        shop_certificate()


def test_nobody_comes_in_without_a_code_and_a_code_lets_one_in_once(page: Served) -> None:
    outside = device(page)
    for bearer in ("", "Bearer x", f"Bearer {page.token}"):
        answer = outside.ask("GET", "/api/1/state", Authorization=bearer)
        assert (answer.status, answer.document["problem"]) == (403, "forbidden")
        assert "Scan a code" in answer.document["sentence"]
    code = codes(page)["Anna"].partition("=")[2]
    assert page.ask("GET", "/api/1/state", Authorization=f"Bearer {code}").status == 403
    first = come_in(outside, code)
    assert (first.status, first.document["person"]) == (200, "Anna")
    assert "set-cookie" not in first.headers
    assert come_in(outside, code).status == come_in(outside, "x").status == 422
    bearer = f"Bearer {first.document['bearer']}"
    assert outside.ask("GET", "/api/1/state", Authorization=bearer).status == 200
    assert page.ask("GET", "/api/1/state", Authorization=bearer).status == 403  # of the other door


def test_a_code_lapses_and_names_somebody(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setattr("axiscal.web.guard.monotonic", lambda: now[0])
    shop = ShopDoor("127.0.0.1:0")
    first, second = (shop.code(person).address.partition("=")[2] for person in ("Anna", " Ben\tB. "))
    now[0] = CODE_LASTS - 1
    assert shop.let_in(second).person == "Ben B."
    now[0] = CODE_LASTS + 1
    with pytest.raises(InputError, match="lets nobody in"):
        shop.let_in(first)
    for nobody in ("", " ", "a\u202eb"):
        with pytest.raises(InputError, match="for a person"):
            shop.code(nobody)
    shop.listener.close()


def test_a_device_shows_no_codes_and_another_page_cannot_use_it(page: Served) -> None:
    tablet = let_in(page, "Ben")
    assert tablet.call("codes", person="Eve").status == 403
    body, bearer = b'{"path": "/setup.svg?width=640"}', {"Authorization": f"Bearer {tablet.token}"}
    own = f"https://127.0.0.1:{tablet.port}"
    assert tablet.ask("POST", "/api/1/addresses", body, Origin=own, **bearer).status == 200
    for origin in ("http://evil.example", "null", own.replace("https", "http"), f"http://127.0.0.1:{page.port}"):
        assert tablet.ask("POST", "/api/1/addresses", body, Origin=origin, **bearer).status == 403
        assert tablet.ask("POST", "/api/1/devices", b'{"code": "x"}', Origin=origin).status == 403
    for host in ("evil.example", f"localhost:{tablet.port}", f"127.0.0.1:{page.port}"):
        assert tablet.ask("GET", "/", Host=host).status == 400


def test_without_a_shop_no_device_comes_in(tmp_path: Path, command: Command) -> None:
    with served(started(tmp_path)) as alone:
        refused = alone.call("codes", person="Anna").document["sentence"]
        assert refused == "No device can come in. End axiscal serve, and start axiscal serve --shop."
    assert "say --shop as well" in command("serve", "--person", "Anna").err
    assert "is no address" in command("serve", "--shop", "--at", "127.0.0.1:x").err


def test_a_greeting_that_never_comes_is_cut(page: Served) -> None:
    with socket.create_connection(("127.0.0.1", device(page).port), timeout=20) as slow:
        begun = time.monotonic()
        assert slow.recv(1) == b""
        assert time.monotonic() - begun < 15


def test_readings_bear_the_name_of_who_took_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    record = started(tmp_path)
    with served(record, *SHOP) as page:
        tablet = let_in(page, "Anna")
        for server, text in ((page, "-1.7"), (tablet, "0.5"), (tablet, "0.4")):
            assert server.call("readings", after=page.state()["last"], text=text).status == 200
        assert [each["by"] for each in page.state()["readings"]] == ["by Anna", "by Anna", ""]
        assert "by Anna" in page.state()["undo"]
        assert page.call("finish", after=page.state()["last"]).status == 200
    assert "By Anna: readings 2, 3." in command("status", record).printed
    report = (tmp_path / "mill-results" / "report.html").read_text()
    assert report.count(" by Anna</td>") == 2
    assert record.read_bytes().count(b'"person":"Anna"') >= 2


@pytest.mark.long
@pytest.mark.chromium
def test_a_tablet_scans_the_code_that_the_computer_shows(
    browser: Browser, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    computer, tablet = browser.page(1400, 900), browser.page(768, 1024)
    tablet.call("Security.setIgnoreCertificateErrors", ignore=True)  # a person has compared it
    with served(started(tmp_path), *SHOP) as page:
        computer.open(page.address)
        computer.until("document.activeElement.id === 'stands'")
        computer.value("document.getElementById('device').click()")
        computer.enter("Anna")
        words = computer.until("document.getElementById('device-words').textContent")
        code = str(words).split()[-1]
        drawn = computer.value("document.querySelector('#device-picture path').getAttribute('d')")
        rows = enumerate(segno.make_qr(code, error="l").matrix)
        assert re.findall(r"\d+ \d+", drawn) == [f"{x} {y}" for y, row in rows for x, dark in enumerate(row) if dark]
        looked_at(computer)
        _measured_on(tablet, code)
        looked_at(tablet)
        assert tablet.value("location.href + document.cookie") == code.partition("#")[0]
        assert tablet.value("document.getElementById('device').hidden")
        tablet.value("localStorage.clear()")  # another device
        tablet.open(code)
        tablet.until("document.getElementById('trouble').textContent.startsWith('Scan a code')")
        assert [each["by"] for each in page.state()["readings"]] == ["by Anna"]
        assert computer.complaints() == []


def _measured_on(tablet: Page, code: str) -> None:
    """Open a code, mount the laser, and take a reading."""
    tablet.open(code)
    tablet.until("document.getElementById('who').textContent.includes('Anna')")
    tablet.until("document.activeElement.id === 'stands'")
    stand(tablet)
    type_reading(tablet, "-1.7")
    tablet.until("document.getElementById('latest').textContent.includes('by Anna')")
