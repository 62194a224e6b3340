"""The command line, end to end on a machine of one axis: what it prints, keeps, refuses, and with which exit status."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.commands import Command
from tests.generators.begun import begun
from tests.generators.texts import FOUR_READINGS

STARTED = ("start", "c.toml", "m.axiscal")


@pytest.fixture
def axiscal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command) -> Command:
    """Run a command in a folder that holds a campaign."""
    (tmp_path / "c.toml").write_text(FOUR_READINGS)
    monkeypatch.chdir(tmp_path)
    return command


@pytest.fixture
def started(axiscal: Command, tmp_path: Path) -> Command:
    begun(tmp_path, {"c.toml": FOUR_READINGS}, STARTED)
    return axiscal


def test_finishing_beside_another_campaign_writes_nothing(started: Command) -> None:
    Path("r").mkdir()
    assert started("start", "c.toml", "r/campaign.axiscal").status == 0
    started("finish", "m.axiscal", "--out", "r").refused("no earlier copy of this record")
    assert [file.name for file in Path("r").glob("*.json")] == []
    assert "Finished" not in started("status", "m.axiscal", "--details").out


@pytest.mark.parametrize(
    "words",
    [
        [],
        ["mesure"],
        ["next", "m.axiscal", "n.axiscal"],
        ["next", "--colour"],
        ["record", "m.axiscal"],
        ["skip", "m.axiscal"],
        ["record", "m.axiscal", "1 um", "--setup", "laser"],
        ["start", "c.toml", "r.axiscal", "d"],
        ["run", "c.toml", "--out", "d"],
        ["machine"],
        ["machine", "sell"],
    ],
)
def test_wrong_usage_is_status_2(started: Command, words: list[str]) -> None:
    outcome = started(*words)
    assert outcome.status == 2
    assert "Traceback" not in outcome.err


@pytest.mark.long
def test_a_run_is_not_overwritten_and_can_be_resumed(axiscal: Command, tmp_path: Path) -> None:
    (tmp_path / "two.csv").write_text("value_um\n1\n2\n")
    failed = axiscal("run", "c.toml", "--source", "csv:two.csv", "--out", "d")
    failed_text = " ".join(failed.err.split())
    assert failed.status == 1
    assert "there are 2 readings in it" in failed_text
    assert "2 readings are kept in d/campaign.axiscal; go on with: axiscal step run c.toml" in failed_text
    axiscal("run", "c.toml", "--source", "csv:two.csv", "--out", "d").refused("holds a campaign already", "--resume")
    (tmp_path / "four.csv").write_text("value_um\n1\n2\n3\n4\n")
    resumed = axiscal("run", "c.toml", "--source", "csv:four.csv", "--out", "d", "--resume", "--json")
    assert resumed.document["readings"] == 4
    (tmp_path / "c.toml").write_text(FOUR_READINGS.replace("readings = 4", "readings = 12"))
    axiscal("run", "c.toml", "--source", "sim", "--out", "d", "--resume").refused("has been changed")


INSTRUMENT = """
import json, sys, time
for number, line in enumerate(sys.stdin, 1):
    if number == 3:
        open("third", "w").close()
        time.sleep(60)
    print(json.dumps({"value": 0.01 * json.loads(line)["position"]["X"], "unit": "um"}), flush=True)
"""


def spawned(folder: Path, *words: str) -> subprocess.Popen[str]:
    environment = os.environ | {"PYTHONIOENCODING": "utf-8"}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    command = [sys.executable, "-m", "axiscal", *words]
    return subprocess.Popen(command, cwd=folder, env=environment, text=True, **pipes)  # type: ignore[call-overload,no-any-return]


@pytest.mark.long
def test_ctrl_c_keeps_the_readings_and_says_how_to_go_on(tmp_path: Path) -> None:
    (tmp_path / "c.toml").write_text(FOUR_READINGS)
    (tmp_path / "instrument.py").write_text(INSTRUMENT)
    waiting = f"exec:{shlex.quote(sys.executable)} instrument.py"
    process = spawned(tmp_path, "run", "c.toml", "--source", waiting, "--out", "d")
    while not (tmp_path / "third").exists():
        assert process.poll() is None, "it ended before its third reading"
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    text = " ".join(err.split())
    assert process.returncode == 1
    assert "Stopped by Ctrl-C. 2 readings are kept in d/campaign.axiscal; go on with: axiscal step run c.toml" in text
    assert "--resume" in text
    assert "Traceback" not in text


def test_a_reader_that_goes_away_is_no_failure_to_talk_about(tmp_path: Path) -> None:
    process = spawned(tmp_path, "machine", "show", "dmu60")
    assert process.stdout is not None
    process.stdout.close()
    assert process.stderr is not None
    assert "Traceback" not in process.stderr.read()
    process.stderr.close()
    assert process.wait() in (0, 1)


SLOW = ("jinja2", "rich", "scipy.stats")
HEAVY = ("numpy", "typer", "scipy", "pydantic", "rich")
COMMANDS = ("axiscal.campaign", "axiscal.cli.plan", "axiscal.cli.report", "numpy")


@pytest.mark.parametrize(
    ("words", "without", "says"),
    [
        (["--version"], HEAVY, "axiscal 0."),
        (["--help"], COMMANDS, "Commands:"),
        (["plan", "--help"], (*COMMANDS, "numpy"), "--readings"),
        (["next", "m.axiscal"], SLOW, "Reading 1"),
        (["status", "m.axiscal"], SLOW, "READINGS"),
    ],
)
def test_a_command_loads_nothing_that_it_does_not_need(
    started: Command, tmp_path: Path, words: list[str], without: tuple[str, ...], says: str
) -> None:
    program = (
        f"import sys; sys.argv = ['axiscal', *{words!r}]; from axiscal.cli import main; main();"
        f"sys.exit(' '.join({{*{without!r}}} & set(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert says in run.stdout
    assert run.stderr.strip() == ""


def test_a_defect_is_not_a_traceback(started: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("float division by zero")

    monkeypatch.setattr("axiscal.campaign.campaign.Campaign.open", broken)
    started("next", "m.axiscal").refused("A defect in axiscal: ZeroDivisionError", "AXISCAL_TRACEBACK=1")
    monkeypatch.setenv("AXISCAL_TRACEBACK", "1")
    with pytest.raises(ZeroDivisionError):
        started("next", "m.axiscal")
