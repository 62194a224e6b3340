"""The form of a first description: in a real browser by keyboard, and its documents word for word."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from axiscal.description.campaign import read_campaign
from tests.cli.test_init import INI
from tests.web.browser import Browser
from tests.web.served import PATIENCE, Served
from tests.web.test_page import looked_at, tab_to

WANTED = {"source": 0, "instruments": ["interferometer"], "target": "20 um"}


@contextmanager
def form(folder: Path, *options: str, told: str) -> Iterator[Served]:
    """Serve the form of a folder until the end of the block; it then ends, by itself or by Ctrl-C, and says `told`."""
    home = folder / "home"
    (home / "linuxcnc" / "configs" / "mill").mkdir(parents=True)
    (home / "linuxcnc" / "configs" / "mill" / "my-mill.ini").write_text(
        INI.replace("[AXIS_Z]\nMIN_LIMIT = 0\n", "[AXIS_Z]\n")
    )
    command = [sys.executable, "-m", "axiscal.cli", "init", "mill", "--page", *options]
    surroundings = {**os.environ, "HOME": str(home), "AXISCAL_LANGUAGE": "en"}
    process = subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=surroundings
    )
    assert process.stdout is not None
    try:
        words = process.stdout.readline().split()
        assert words[:1] == ["Open"], process.communicate(timeout=PATIENCE)
        yield Served(words[1], folder, process.pid)
        if "nothing was" in told:
            process.send_signal(signal.SIGINT)
        printed, complaint = process.communicate(timeout=PATIENCE)
        assert (process.returncode, complaint) == (0, "")
        assert told in printed
    finally:
        process.kill()
        process.communicate()


def posted(server: Served, path: str, **body: Any) -> tuple[int, dict[str, Any]]:
    """Return what the form answers to what was chosen."""
    answer = server.call(f"first/{path}", **(WANTED | body))
    return answer.status, answer.document


def test_what_is_written_is_a_campaign_and_the_server_has_done_its_work(tmp_path: Path) -> None:
    with form(tmp_path, "--machine", "three-axis-mill", told="are written") as server:
        shown = server.call("first").document
        assert [source["name"] for source in shown["sources"]][:2] == ["my-mill", shown["sources"][1]["name"]]
        assert shown["sources"][shown["chosen"]] == {"name": "three-axis-mill", "file": ""}
        assert server.call(f"first/machine?source={shown['chosen']}").document["sure"] is True
        status, looked = posted(server, "preview", source=shown["chosen"])
        assert (status, looked["setups"], (tmp_path / "mill").exists()) == (200, 3, False)
        status, written = posted(server, "files", source=shown["chosen"])
        assert status == 200
        assert (tmp_path / "mill" / "campaign.toml").read_text() == written["campaign"] == looked["campaign"]
    assert len(read_campaign(tmp_path / "mill" / "campaign.toml").setups) == 3


def test_what_an_ini_file_leaves_open_is_asked_for(tmp_path: Path) -> None:
    with form(tmp_path, told="are written") as server:
        assert server.call("first/machine?source=0").document == {
            "chain": "",
            "sure": False,
            "lacking": [{"axis": "Z", "unit": "mm"}],
        }
        assert "no MIN_LIMIT of Z" in posted(server, "preview")[1]["sentence"]
        assert "no limit of Z" in posted(server, "preview", limits={"Z": ["low", "0"]})[1]["sentence"]
        assert "lower limit comes first" in posted(server, "preview", limits={"Z": ["3", "0"]})[1]["sentence"]
        assert "does not leave" in posted(server, "preview", limits={"X": ["0", "3"]})[1]["sentence"]
        status, written = posted(server, "files", limits={"Z": ["-250,5", "0"]}, chain="w-Y'-b-X-Z-t")
        assert status == 200, written
        assert "the length of the tool" in written["look"]
    machine = read_campaign(tmp_path / "mill" / "campaign.toml").machine
    assert (machine.axis("Z").travel, machine.chain) == ((-0.2505, 0.0), "w-Y'-b-X-Z-t")


@pytest.mark.parametrize(
    ("body", "status", "said"),
    [
        ({"source": 10000}, 422, "not offered"),
        ({"source": -1}, 422, "source"),
        ({"source": 2, "instruments": []}, 422, "No instrument"),
        ({"source": 2, "instruments": ["yardstick"]}, 422, "Offered are"),
        ({"source": 2, "target": "9"}, 422, "unit"),
        ({"source": 2, "file": "/etc/passwd"}, 422, "file"),
    ],
)
def test_what_cannot_be_is_a_sentence(tmp_path: Path, body: dict[str, Any], status: int, said: str) -> None:
    with form(tmp_path, told="nothing was written") as server:
        found, answer = posted(server, "files", **body)
        assert found == status
        assert said in answer["sentence"]
        strangers = server.ask("POST", "/api/1/first/files", json.dumps(WANTED).encode())
        assert strangers.status == 403
    assert not (tmp_path / "mill").exists()


def test_nothing_is_written_over(tmp_path: Path) -> None:
    (tmp_path / "mill").mkdir()
    (tmp_path / "mill" / "campaign.toml").write_text("mine")
    with form(tmp_path, told="nothing was written") as server:
        status, answer = posted(server, "files", source=2)
        assert (status, "exists already" in answer["sentence"]) == (422, True)
    assert [(each.name, each.read_text()) for each in (tmp_path / "mill").iterdir()] == [("campaign.toml", "mine")]


@pytest.mark.chromium
@pytest.mark.long
def test_the_form_by_keyboard_at_every_size(browser: Browser, tmp_path: Path) -> None:
    page = browser.page(1400, 900)
    with form(tmp_path, told="are written") as server:
        page.open(server.address)
        page.until("document.activeElement.id === 'source'")
        assert "token" not in page.value("location.href")
        page.value("(s => { s.value = '0'; s.dispatchEvent(new Event('change')); })(document.activeElement)")
        page.until("document.querySelectorAll('#axes input').length === 2")
        looked_at(page)
        for text in ("-300", "0"):
            page.press("Tab")
            page.type(text)
        page.press("Tab")  # how it is built: left as it is supposed
        page.press("Tab")
        page.press(" ")
        tab_to(page, "target")
        page.type("20 um")
        tab_to(page, "look")
        page.press("Enter")
        page.until("!document.getElementById('files').hidden")
        looked_at(page)
        page.value("document.querySelectorAll('details').forEach(each => { each.open = true; })")
        looked_at(page)
        tab_to(page, "target")
        page.press("Enter")
        page.until("document.querySelectorAll('#after li').length === 3")
        looked_at(page)
        assert page.complaints() == []
        page.value("document.documentElement.removeAttribute('lang')")
        assert [rule.partition(":")[0] for rule in page.broken_rules()] == ["html-has-lang"]
    assert read_campaign(tmp_path / "mill" / "campaign.toml").machine.axis("Z").travel == (-0.3, 0.0)
