"""Who writes, and signatures: with the key of a person, and without one."""

from __future__ import annotations

import ast
import json
import platform
import re
import subprocess
import sys
from pathlib import Path

import pytest

from axiscal.cli.app import run
from axiscal.exceptions import RecordError
from axiscal.record import signing
from axiscal.record.events import Noted
from axiscal.record.lines import HEAD, EventText, head
from axiscal.record.payload import decode
from axiscal.record.signing import KEY, PERSON, hand_of, key_file
from axiscal.record.store import Record
from tests.commands import Command
from tests.generators.begun import begun
from tests.generators.plain_records import CAMPAIGN, MACHINE
from tests.golden.surfaces import of_paper
from tools.check_record import checked, main

TOOL = Path(__file__).parents[2] / "tools" / "check_record.py"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A campaign with one reading."""
    at = ("--setup", "along x", "--at", "X=100mm")
    begin = ("start", "campaign.toml", "mill.axiscal")
    few = CAMPAIGN.replace("500", "5")  # a plan of a moment
    begun(tmp_path, {"machine.toml": MACHINE, "campaign.toml": few}, begin, ("record", "mill.axiscal", "1 um", *at))
    return tmp_path / "mill.axiscal"


@pytest.fixture
def key(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Be Anna, whose key is to be in this file."""
    monkeypatch.setenv(PERSON, "Anna")
    monkeypatch.setenv(KEY, str(tmp_path / "keys" / "anna.pem"))
    return tmp_path / "keys" / "anna.pem"


def public(path: Path) -> str:
    found = Record.open(path, write=False).signed()
    assert found is not None
    return found.key


def test_each_entry_says_who_wrote_it(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(PERSON, 'Anna "Å" Berg')
    with Record.open(path) as record:
        record.append(Noted("warm"))
        row = record.rows[-1]
        assert all(map(all, map(hand_of, record.rows)))
    assert hand_of(row).person == 'Anna "Å" Berg'
    assert decode(row.kind, row.payload) == Noted("warm")


def test_the_key_lies_where_it_is_named_else_in_the_folder_of_this_person(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in (KEY, "XDG_CONFIG_HOME", "APPDATA"):
        monkeypatch.delenv(name, raising=False)
    assert key_file() == Path.home() / ".config" / "axiscal" / "key.pem"
    for name in ("APPDATA", "XDG_CONFIG_HOME"):  # the latter counts where both are there
        monkeypatch.setenv(name, f"/folder/{name}")
        assert key_file() == Path(f"/folder/{name}/axiscal/key.pem")
    monkeypatch.setenv(KEY, "/else/mine.pem")
    assert key_file() == Path("/else/mine.pem")


def test_entries_of_before_say_nobody() -> None:
    assert not any(hand_of(EventText("", "noted", '{"text":"warm"}')))
    assert decode("noted", '{"text":"warm"}') == Noted("warm")


def test_without_a_key_nothing_is_signed(path: Path, command: Command, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["finish", str(path), "--out", str(path.parent / "out")]) == 0
    capsys.readouterr()
    assert "The record is unsigned" in command("status", path, "--details").printed
    assert main([str(path)]) == 1
    assert "events 1 to" in capsys.readouterr().out


def test_a_record_is_signed_and_a_stranger_can_tell(
    path: Path, key: Path, command: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    said = command("sign", path).printed
    assert "by Anna on" in said
    assert key.stat().st_mode & 0o777 == 0o600
    assert public(path) in said
    alone = [sys.executable, str(TOOL), str(path), "--key", public(path)]
    told = subprocess.run(alone, capture_output=True, text=True, check=False)
    assert (told.returncode, "All of it is signed" in told.stdout) == (0, True), told.stdout + told.stderr
    assert run(["note", str(path), "warm"]) == 0
    capsys.readouterr()
    assert "unsigned since: 1 event" in command("status", path, "--details").printed
    assert main([str(path), "--key", public(path)]) == 1
    assert run(["finish", str(path), "--out", str(path.parent / "out")]) == 0
    assert run(["sign", str(path)]) == 0
    capsys.readouterr()
    assert main([str(path), "--key", public(path)]) == 0
    assert main([str(path), "--key", 64 * "0"]) == 1
    assert "a key that was not given" in capsys.readouterr().out


def test_the_check_needs_nothing_of_ours() -> None:
    tree = ast.parse(TOOL.read_text())
    imported = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    imported |= {name.name for node in ast.walk(tree) if isinstance(node, ast.Import) for name in node.names}
    roots = {str(name).partition(".")[0] for name in imported}
    assert roots <= {*sys.stdlib_module_names, "cryptography"}
    assert len(TOOL.read_text().splitlines()) <= 200
    assert checked(head(1), []).faults[0].startswith("its counts")  # the head itself is known
    assert checked(head(1)[:-1].ljust(HEAD), []).faults[0].startswith("its head")


def test_only_a_person_who_says_so_signs(
    path: Path, key: Path, monkeypatch: pytest.MonkeyPatch, command: Command
) -> None:
    assert run(["sign", str(path)]) == 0
    monkeypatch.setattr(signing, "now", lambda: "2100-01-02T08:00:00.000+00:00")
    with Record.open(path) as record:
        record.append(Noted("next day"))
    assert run(["finish", str(path), "--out", str(path.parent / "out")]) == 0
    with Record.open(path, write=False) as record:
        assert [row.kind for row in record.rows].count("signed") == 1


def test_two_people_sign_and_nobody_twice(path: Path, key: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert run(["sign", str(path)]) == 0
    assert run(["sign", str(path)]) == 0
    anna = public(path)
    monkeypatch.setenv(KEY, str(key.with_name("otto.pem")))
    assert run(["sign", str(path)]) == 0
    with Record.open(path) as record:
        assert [row.kind for row in record.rows[-3:]] == ["continued", "signed", "signed"]
        otto = public(path)
        assert not checked(path.read_bytes(), [anna, otto]).faults
        assert "of a key that was not given" in checked(path.read_bytes(), [otto]).faults[0]
        found = record.signed()
    assert found is not None
    assert found.key == otto


def test_a_key_that_others_may_read_signs_nothing(path: Path, key: Path, command: Command) -> None:
    assert run(["sign", str(path)]) == 0
    assert run(["note", str(path), "warm"]) == 0
    key.chmod(0o644)
    assert "chmod 600" in command("sign", path).refusal
    key.chmod(0o600)
    key.write_text("no key")
    with Record.open(path) as record, pytest.raises(RecordError, match="cannot be read"):
        record.sign()


def test_a_copy_and_a_repaired_record_keep_their_signature(path: Path, key: Path, tmp_path: Path) -> None:
    assert run(["sign", str(path)]) == 0
    assert run(["undo", str(path)]) == 0
    assert run(["sign", str(path)]) == 0
    copy, new = tmp_path / "copy.axiscal", tmp_path / "new.axiscal"
    with Record.open(path, write=False) as record:
        record.copy_to(copy)
    assert run(["salvage", str(path), str(new)]) == 0
    assert not checked(copy.read_bytes(), [public(path)]).faults
    found = Record.open(new, write=False).signed()
    assert found is not None
    assert (found.number, found.holds) == (7, True)


def test_every_surface_says_who_answers_for_a_record(path: Path, key: Path, command: Command) -> None:
    for x in (20, 280):
        assert run(["record", str(path), f"{x / 10} um", "--setup", "along x", "--at", f"X={x}mm"]) == 0
    assert run(["sign", str(path)]) == 0
    report = path.with_suffix(".pdf")
    signed = "signed by Anna on [^ ]+ until reading 3"
    assert re.search(rf"The record is {signed}\.", command("status", path).said)
    assert run(["report", str(path), "--out", str(report)]) == 0
    assert re.search("TherecordissignedbyAnnaon.+untilreading3", of_paper(report))


def test_the_key_of_somebody_else_is_said(
    path: Path, key: Path, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert run(["sign", str(path)]) == 0
    assert f"Anna on {platform.node()} until reading 1" in command("status", path).said
    monkeypatch.setenv(KEY, str(key.with_name("otto.pem")))
    assert f"Anna on {platform.node()}, key {public(path)[:16]} until" in command("status", path).said


def test_results_are_held_against_the_record_that_they_are_of(
    path: Path, key: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = path.parent / "out"
    assert run(["finish", str(path), "--out", str(out)]) == 0
    assert run(["sign", str(path)]) == 0
    manifest = out / "manifest.json"
    whole = [str(path), "--key", public(path), "--manifest", str(manifest)]
    assert main(whole) == 0
    before = json.loads(manifest.read_text())
    assert "signed" not in before
    manifest.write_text(json.dumps({**before, "signed": {"person": "Anna"}}))
    assert main(whole) == 0
    assert "a kind that is no longer verified" in capsys.readouterr().out
    (out / "result.json").write_text("{}")
    assert main(whole) == 1
    assert "result.json is missing, or not what" in capsys.readouterr().out
    manifest.write_text(manifest.read_text().replace('"event": ', '"event": 1'))
    assert main(whole) == 1
    assert "not of this record" in capsys.readouterr().out
