"""The last screen, and what is said after a reading: budgets in both languages, first line, commands."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from pathlib import Path

import pytest

from axiscal.answers.answer import Aim, AnswerLine, NextStep, ResultAnswer, TablesChecked, Verdict
from axiscal.answers.answer_words import LINES, WIDTH, screen
from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.description.campaign import campaign_from_texts
from axiscal.description.target import RowName, rows_of
from axiscal.language.spoken import LANGUAGES, speaking
from axiscal.machine import load_machine
from axiscal.measurement.reading import Reading
from axiscal.present.guide.progress import contradictions
from tests.commands import Command
from tests.generators.answers import aim, answer, answer_row
from tests.generators.laser_axis import CAMPAIGN, CASE, MACHINE, machine, plus, read

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


def _screen(found: ResultAnswer) -> str:
    agreement = CONTRADICTING if found.verdict == "contradict" else UNUSED
    return screen(found.model_copy(update={"steps": STEPS}), agreement, "mill.axiscal", "demo-out", "demo-out/r.pdf")


@pytest.mark.parametrize("advised", ["klipper", "marlin", "reprapfirmware"])
def test_the_control_whose_tables_are_to_be_loaded_has_a_column(advised: str) -> None:
    built = load_machine("printer-gantry")
    rows = [answer_row(row, built, True, ("klipper", "marlin", "reprapfirmware")) for row in rows_of(built)]
    steps = [NextStep(code="load", control=advised), NextStep(code="verify", control=advised)]
    heading = screen(answer(rows=rows).model_copy(update={"steps": steps}), "", "bed.axiscal", "out").splitlines()[1]
    assert advised in heading.split() or heading.split()[-1] == "left"  # the next command names it
    assert f"verify bed.axiscal --to {advised}" in screen(answer(rows=rows, steps=steps), "", "bed.axiscal", "out")


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


MILL = load_machine("three-axis-mill")
POSITIONING = answer_row(RowName("positioning", ("X",)), MILL)


@pytest.mark.parametrize(
    ("verdict", "aims", "begins"),
    [
        ("measured", [], "MEASURED   32 readings, 25 min by the plan"),
        ("unmeasured", [], "NOT ALL MEASURED   32 readings"),
        ("reached", [aim("rms", 4.876, 5.0, 1.0)], "TARGET REACHED   volume RMS 4.88 of 5 um   32 readings"),
        ("reached", [aim("U", 8.14, 20.0, 1.0)], "TARGET REACHED   volume U 8.1 of 20 um   32 readings"),
        ("more", [aim("worst", 7.16, 5.0, 1.0)], "123 MORE READINGS, 56 MIN\n  worst place 7.2 of 5 um   32 readings"),
        ("unreachable", [aim("rms", 7.16, 5.0, 6.0)], "CANNOT BE REACHED WITH THESE SET-UPS\n  volume RMS 7.2 of 5 um"),
        (
            "unreachable",
            [aim("positioning X", 20, 4, 1), aim("positioning Z", 8, 4, 5, reachable=False)],
            "CANNOT BE REACHED WITH THESE SET-UPS\n  0 of 2 limits: positioning Z 8.0 of 4 um",
        ),
        ("contradict", [aim("rms", 4.0, 5.0, 1.0)], "READINGS CONTRADICT   32 readings"),
        ("nothing", [], "NO READINGS YET   32 readings"),
        (
            "more",
            [aim("backlash X", 4, 1, 0), aim("yaw X", 1, 2, 0)],
            "123 MORE READINGS, 56 MIN\n  1 of 2 limits: backlash X 4.0 of 1 um",
        ),
    ],
)
def test_the_first_line_says_what_became_of_the_target(verdict: Verdict, aims: list[Aim], begins: str) -> None:
    assert _screen(answer(verdict=verdict, rows=[POSITIONING], aims=aims)).startswith(begins)


LINE = AnswerLine(
    setup="laser", axis="X", ends=(0, 900), at={"Y": 200.0, "Z": 100.0}, places={"+": 9, "-": 9, "both": 9}
)


@pytest.mark.parametrize(
    ("language", "name"), [("en", "X on the line Y 200, Z 100"), ("de", "X auf der Linie Y 200, Z 100")]
)
def test_a_volume_that_is_a_line_is_called_so(language: str, name: str) -> None:
    volume = answer_row(RowName("volume"), MILL).model_copy(update={"lines": [LINE]})
    found = answer(verdict="reached", rows=[POSITIONING, volume], aims=[aim("U", 8.14, 20.0, 1.0)], offset=3.92)
    with speaking(language):
        text = _screen(found)
    _within_budgets(text)
    assert re.search(rf"{name} +230 um +± 130 um", text)
    assert f"{name} U 8" in text.splitlines()[0] + text.splitlines()[1]
    assert "100 mm" in text
    assert "3.9 um" in text.replace(",", ".")
    assert "100 mm" not in _screen(found.model_copy(update={"offset": None}))


def test_what_is_not_measured_is_named_with_its_reason() -> None:
    rows = [answer_row(RowName("backlash", (name,)), MILL, measured=False) for name in "XY"]
    text = " ".join(_screen(answer(rows=rows)).split())
    assert "Not measured: backlash X Y (one side read; one reading more: ± 0.84 um)." in text
    lines = [line.model_copy(update={"places": {"+": 2, "-": 3, "both": 0}}) for line in rows[0].lines]
    apart = " ".join(_screen(answer(rows=[rows[0].model_copy(update={"lines": lines})])).split())
    assert "backlash X (no place read from both sides; one reading more: ± 0.84 um)." in apart
    far = rows[0].model_copy(update={"one_more": None, "kind": "yaw", "unit": "urad"})
    assert "yaw X (4 places read tell too little: ± 130 urad)" in _screen(answer(rows=[far]))
    assert "Not measured: backlash X (one side read; " in " ".join(_screen(answer(rows=[far, rows[0]])).split())
    held = far.model_copy(update={"floor": 125.0})
    assert "yaw X (more readings would leave as much: ± 130 urad)" in " ".join(_screen(answer(rows=[held])).split())
    scale = held.model_copy(update={"row": "scale X", "kind": "scale", "unit": "um/m", "kelvin": 0.7})
    text = " ".join(_screen(answer(rows=[held, scale])).split())
    assert "yaw X (temperature not stated: ± 130 urad)" in text
    assert "lead error" not in text  # of a scale that is not measured
    unread = aim("positioning X", 7.8, 10.0, 7.5, measured=False, reachable=False)
    assert "0 of 1 limits: " not in (told := _screen(answer(verdict="unreachable", rows=[held], aims=[unread])))
    assert "positioning X not measured" in told
    none = far.model_copy(update={"row": "yaw Y", "axes": ("Y",), "lines": [], "known_to": 290.0})
    apart = "yaw X (4 places read tell too little: ± 130 urad), yaw Y (not read)."
    assert apart in " ".join(_screen(answer(rows=[none, far])).split())


def test_before_the_first_reading_nothing_is_measured(tmp_path: Path, command: Command) -> None:
    record = tmp_path / "axis.axiscal"
    Campaign.create(record, CASE.description).close()
    text = command("status", record).said
    assert text.startswith("NO READINGS YET volume RMS 12 of 3 um 0 readings")
    assert "Not measured: positioning X (not read), scale X (not read), backlash X (not read), volume" in text
    assert f"axiscal measure {record}" in text


def test_a_check_of_the_tables_says_found_left_and_its_verdict() -> None:
    text = _screen(answer(verdict="reached", rows=[POSITIONING], checked=CHECKED))
    assert "12 places checked: 27 um found, 4.9 left (4.4 expected): AS PROMISED." in text
    assert "Farthest: 9.2 um, C 180, B -75.5." in " ".join(text.split())


def test_no_figure_stands_where_uncertainty_is_withheld() -> None:
    text = _screen(answer(verdict="contradict", withheld=True))
    assert "±" not in text
    assert "The readings contradict each other" in text


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


NARROW = campaign_from_texts(f'usual = "off"\nsure = "exactly"\n{CAMPAIGN}', "c.toml", MACHINE, "m")
JUMPED = [0.0] * 7 + [20e-6] * 17
"""m: before reading 8."""


def _said(path: Path, readings: Sequence[Reading]) -> list[str]:
    with Campaign.create(path, NARROW) as campaign:
        campaign.adopt(tuple(readings))
        return contradictions(campaign)


def test_a_zero_that_jumped_is_said_while_measuring(tmp_path: Path) -> None:
    still = read(machine(2), 24)
    assert _said(tmp_path / "still.axiscal", still) == []
    (said,) = _said(tmp_path / "jumped.axiscal", plus(still, JUMPED))
    assert said.startswith("The readings contradict each other (p = ")
    number = said.partition('the zero of "laser" jumped before reading ')[2].partition(" ")[0]
    assert 8 <= int(number) <= 10  # the first after it may be taken for bad readings
