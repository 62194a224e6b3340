"""The last screen, and what is said after a reading: budgets in both languages, first line, commands."""

import re
import shlex
from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.description.target import rows_of
from axiscal.language.spoken import LANGUAGES, speaking
from axiscal.machine import load_machine
from axiscal.present.answer import NextStep, Outcome, TablesChecked, Verdict
from axiscal.present.answer_words import LINES, WIDTH, screen
from tests.commands import Command
from tests.generators.answers import aim, answer, answer_row
from tests.generators.laser_axis import CASE, machine, read

WORDS = 60
"""Beside the rows."""
NUMBERS, SIGNED = 3, 4
"""In a row, beside the columns of what is left; where they have signs."""
STEPS = [NextStep(code="load", control="linuxcnc-volumetric"), NextStep(code="verify")]
MISTAKE = 'the zero of "laser along X" jumped before reading 14 ("laser along X", X = 120 mm, from +). Take it again'
CONTRADICTING = f"The readings contradict each other (p = 1e-09): {MISTAKE}; or {MISTAKE}"
UNUSED = '14 of 15 readings agree; not used: 7 ("laser")'


AT = {"C": 180.0, "B": -75.5}
CHECKED = TablesChecked(places=12, found=27.1, left=4.93, expected=4.42, farthest=9.2, at=AT, verdict="promised")


def _screen(found: Outcome) -> str:
    agreement = CONTRADICTING if found.verdict == "contradict" else UNUSED
    return screen(found.model_copy(update={"steps": STEPS}), agreement, "mill.axiscal", "demo-out", "demo-out/r.pdf")


@pytest.mark.parametrize("language", sorted(LANGUAGES))
@pytest.mark.parametrize("verdict", ["measured", "reached", "more", "unreachable", "contradict"])
@pytest.mark.parametrize("name", ["three-axis-mill", "dmu60"])
@pytest.mark.parametrize("silent", [(), ("backlash", "yaw"), ("positioning", "straightness", "squareness")])
def test_the_screen_keeps_its_budgets(language: str, verdict: Verdict, name: str, silent: tuple[str, ...]) -> None:
    built = load_machine(name)
    controls = ("linuxcnc", "linuxcnc-volumetric", "heidenhain")
    rows = [answer_row(row, built, row.kind not in silent, controls) for row in rows_of(built)]
    aims = [aim("rms", 4.9, 5.0, 1.0), aim("positioning X", 12.0, 5.0, 6.0, measured=False, unread=1)]
    checked = CHECKED if verdict == "reached" else None
    with speaking(language):
        _within_budgets(_screen(answer(verdict=verdict, rows=rows, aims=aims, checked=checked)))


def _within_budgets(text: str) -> None:
    lines = text.splitlines()
    assert len(lines) <= LINES, text
    assert max(map(len, lines)) <= WIDTH, text
    rows = [line for line in lines if line.startswith("  ") and "±" in line]
    beside_rows = [line for line in lines if line not in rows and not line.startswith("    ")]
    assert sum(bool(re.search(r"[^\W\d_]{2}", word)) for line in beside_rows for word in line.split()) <= WORDS, text
    for row in rows:
        beside = row.partition("±")[0] + row.partition("±")[2].split("   ")[0]
        beside = re.sub(r"\b[X-Z] [0-9]+", "", beside)  # where a line is
        most = SIGNED if re.search("[+−][0-9]", row) else NUMBERS
        assert len(re.findall(r"[0-9]+(?:[.,][0-9]+)?", beside)) <= most, row
        assert not re.search(r"[1-9][0-9]*[.,]?[0-9]*[1-9][0-9]*[.,]?[0-9]*[1-9]", row), row


def _record(folder: Path) -> Path:
    path = folder / "axis.axiscal"
    with Campaign.create(path, CASE.description) as campaign:
        campaign.adopt(tuple(read(machine(3), 12)))
    return path


@pytest.mark.long
def test_status_and_finish_show_it_and_its_commands_work(tmp_path: Path, command: Command) -> None:
    record = _record(tmp_path)
    _says(command("status", record).printed, "")
    text = command("finish", record, "--out", tmp_path / "out").printed
    assert f"Report  {tmp_path}/out/report.pdf" in text
    short = _says(text, str(tmp_path))
    for shown in re.findall(r"^(?:Next)? +axiscal (.+)$", text, re.MULTILINE):
        words = shlex.split(shown, comments=True)  # as a shell takes it
        assert run(words if "measure" not in words else ["next", str(record)]) == 0, shown
    long = command("finish", record, "--out", tmp_path / "out", "--details").printed
    assert len(long.split()) > 2 * len(short.split())
    assert "Holds: for a tool of" in long


def _says(text: str, folder: str) -> str:
    """Return the screen with short paths, within its budgets."""
    short = text.replace(f"{folder}/", "") if folder else re.sub(r"\S*/", "", text)
    _within_budgets(short)
    return short
