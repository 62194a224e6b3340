"""`axiscal study`: from a file to a page, gone on with, refused, and stopped by Ctrl-C."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from axiscal.ports.study.results import FILE
from tests.commands import Command
from tests.ports.texts import STUDY, written


def _rows(folder: Path) -> list[tuple[str, Any, str]]:
    _, *lines = (folder / FILE).read_text().splitlines()
    return sorted((row["key"], row["result"], row["error"]) for row in map(json.loads, lines))


@pytest.mark.long
def test_processes_give_the_bytes_that_one_gives_and_what_is_there_is_not_computed_again(
    tmp_path: Path, command: Command
) -> None:
    file, one, two = str(written(tmp_path)), tmp_path / "one", tmp_path / "two"
    first = command("study", file, "--out", one, "--workers", "1", "--json").document
    second = command("study", file, "--out", two, "--workers", "2", "--json").document
    assert (first["computed"], first["failed"]) == (4, 0)
    assert {**first, "written": 0} == {**second, "written": 0}
    assert _rows(one) == _rows(two)
    for name in ("cases.csv", "study.html"):
        assert (one / name).read_bytes() == (two / name).read_bytes()
    lines = (one / FILE).read_text().splitlines(keepends=True)
    (one / FILE).write_text("".join(line for line in lines if '\\"machine\\":1}' not in line))
    again = command("study", file, "--out", one, "--resume", "--workers", "1", "--json").document
    assert (again["there_before"], again["computed"]) == (2, 2)
    assert _rows(one) == _rows(two)


def test_results_that_are_there_are_neither_doubled_nor_mixed(tmp_path: Path, command: Command) -> None:
    file, out = written(tmp_path), tmp_path / "study-results"
    assert "4 cases computed" in command("study", file, "--workers", "1").printed
    before = _rows(out)
    assert "--resume" in command("study", file).refusal
    file.write_text(STUDY.replace("machines = 2", "machines = 3"))
    assert "has been changed since" in command("study", file, "--resume").refusal
    assert _rows(out) == before


def test_a_case_that_cannot_be_computed_is_a_row_and_status_1(tmp_path: Path, command: Command) -> None:
    hopeless = STUDY.replace("{ readings = 6 }", '{ budget = "1 s" }').replace('["laser"], ', "")
    assert (
        "2 cases of 2 could not be computed" in command("study", written(tmp_path, hopeless), "--workers", "1").refusal
    )
    assert all("that the first reading takes" in error for _, _, error in _rows(tmp_path / "study-results"))
    assert "that the first reading takes" in (tmp_path / "study-results" / "study.html").read_text()


def test_a_disk_that_is_full_is_named_with_its_file_and_what_is_kept(
    tmp_path: Path, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*given: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("axiscal.ports.study.results.write_at", full)
    said = command("study", written(tmp_path), "--workers", "1").refusal
    assert f"{tmp_path / 'study-results' / FILE}: The results cannot be written: No space left on device" in said
    assert "0 of 4 cases are kept; go on with: axiscal study" in said


def test_a_dry_run_counts_and_writes_nothing(tmp_path: Path, command: Command) -> None:
    found = command("study", written(tmp_path), "--dry-run", "--json").document
    assert (found["cases"], found["ways"], found["failed"]) == (4, 2, None)
    assert found["processor_hours"] > 0
    assert {path.name for path in tmp_path.iterdir()} == {"campaign.toml", "study.toml"}


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGINT of another process")
def test_ctrl_c_ends_at_once_and_keeps_what_is_done(tmp_path: Path) -> None:
    file, out = written(tmp_path, STUDY.replace("machines = 2", "machines = 400")), tmp_path / "out"
    command = [sys.executable, "-m", "axiscal.cli", "study", str(file), "--out", str(out), "--workers", "2"]
    head = subprocess.Popen(
        command,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # ignored where tests run in the background
    )
    while not (out / FILE).exists() or len(_rows(out)) < 3:
        assert head.poll() is None
        time.sleep(0.1)
    head.send_signal(signal.SIGINT)
    said = " ".join(head.communicate(timeout=60)[1].split())
    assert head.returncode == 1
    kept = len(_rows(out))
    assert 3 <= kept < 800
    counted = [kept - 1, kept]  # one that is being written as Ctrl-C comes is not counted
    assert any(f"Stopped by Ctrl-C. {n} of 800 cases are kept; go on with: axiscal study" in said for n in counted)
