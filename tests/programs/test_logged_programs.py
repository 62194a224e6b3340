"""Programs that touch spheres by themselves and write logs: run, read back, and what a log may not be."""

import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.description.placed_readings import logged_readings
from axiscal.exceptions import InputError, ProgramError, ReadingError
from axiscal.machine.kinematics import drawn_back
from axiscal.measurement.readers.touch_log import read_touch_log
from axiscal.measurement.reading import Place
from axiscal.measurement.touched import TOUCHES
from axiscal.programs import dialect, programs, write_programs
from tests.generators import touched_table as table
from tests.generators.texts import campaign_text, setup_text
from tests.programs.touching_controls import TouchingMachine, run_linuxcnc


@cache
def run(count: int) -> tuple[CampaignDescription, list[Place], dict[str, bytes], str]:
    """Return campaign and plan, the files of its program, and the log that the control writes."""
    campaign = table.description()
    places = table.places(campaign, count)
    with TemporaryDirectory() as folder:
        write_programs(campaign.machine, campaign.setups, places, "linuxcnc", Path(folder), log=True)
        files = {path.name: path.read_bytes() for path in Path(folder).iterdir()}
    (program,) = programs(campaign.machine, campaign.setups, places, dialect("linuxcnc"), log=True)
    machine = TouchingMachine()
    lines = run_linuxcnc(program.text, machine)
    assert machine.touches == 2 * TOUCHES * count
    return campaign, places, files, "\n".join(lines) + "\n"


def logged(folder: Path, count: int = 3) -> tuple[CampaignDescription, list[Place], Path]:
    """Put the program of a plan and its log into a folder, and return campaign, plan and the file of the log."""
    campaign, places, files, text = run(count)
    for name, content in files.items():
        (folder / name).write_bytes(content)
    (folder / "log.txt").write_text(text, encoding="utf-8", newline="")
    return campaign, places, folder / "log.txt"


def test_what_a_control_writes_is_read_back_as_what_the_machine_does(tmp_path: Path) -> None:
    campaign, places, log = logged(tmp_path)
    readings, told = logged_readings(log, tmp_path, campaign)
    assert told == ()
    assert [reading.number for reading in readings] == [1, 2, 3]
    for reading, place in zip(readings, places, strict=True):
        np.testing.assert_allclose(
            1e6 * np.array([reading.value, *reading.others]), table.expected_at(campaign, place), atol=0.01
        )


def refusal(log: Path, folder: Path, campaign: CampaignDescription) -> str:
    with pytest.raises(ReadingError) as refused:
        logged_readings(log, folder, campaign)
    return str(refused.value)


def test_the_log_of_another_plan_is_refused(tmp_path: Path) -> None:
    campaign, _, log = logged(tmp_path)
    other = tmp_path / "other"
    write_programs(campaign.machine, campaign.setups, table.places(campaign, 2), "linuxcnc", other, log=True)
    assert "has no programs of that plan" in refusal(log, other, campaign)
    assert "has no programs of that plan" in refusal(log, tmp_path / "none", campaign)
    write_programs(campaign.machine, campaign.setups, table.places(campaign, 3), "heidenhain", tmp_path)
    assert len(logged_readings(log, tmp_path, campaign)[0]) == 3  # lists of other programs beside it
    (own,) = tmp_path.glob("AXISCAL_01_SPHERES*.csv")
    own.write_text(own.read_text().replace("C+", "C-"))
    assert "have been changed" in refusal(log, tmp_path, campaign)
    write_programs(campaign.machine, campaign.setups, table.places(campaign, 3), "linuxcnc", tmp_path, log=True)
    joined = log.read_text().replace("END 3\n", "END 3\nAXISCAL LOG 1 PLAN 00000000 MM\n")
    log.write_text(joined)
    assert "here begins the log of plan 00000000" in refusal(log, tmp_path, campaign)


def test_lists_of_another_plan_that_has_its_logs_are_not_written_over(tmp_path: Path) -> None:
    campaign, _, _ = logged(tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    with pytest.raises(ProgramError, match="of another plan, whose logs are read with it"):
        write_programs(campaign.machine, campaign.setups, table.places(campaign, 2), "linuxcnc", tmp_path, log=True)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_linuxcnc_is_called_for_each_touch_between_the_lines_of_its_log() -> None:
    campaign = table.description()
    (program,) = programs(campaign.machine, campaign.setups, table.places(campaign, 2), dialect("linuxcnc"), log=True)
    lines = program.text.splitlines()
    calls = [line for line in lines if line.startswith("O<axiscal_touch> CALL [")]
    assert len(calls) == 2 * TOUCHES
    assert calls[-1].startswith(f"O<axiscal_touch> CALL [2] [{TOUCHES}] [")
    opened, closed = (next(k for k, line in enumerate(lines) if word in line) for word in ("LOGAPPEND", "(LOG,END 2)"))
    assert opened < lines.index(calls[0]) < lines.index(calls[-1]) < closed
    assert lines[closed + 1] == "(LOGCLOSE)"
    stood = "G53 G1 C[ROUND[#5425 * 1000000] / 1000000] A[ROUND[#5423 * 1000000] / 1000000]"
    after = [lines[k - 1] for k, line in enumerate(lines) if line == stood]
    assert after == ["O102 ENDIF", "O103 ENDIF"]  # before any move that a rotary axis 1e-17 beyond its limit would end


def test_touches_that_the_axes_cannot_make_are_refused() -> None:
    campaign = table.description()
    places, (setup,) = table.places(campaign, 3), campaign.setups
    poses = drawn_back(campaign.machine, np.array([place.pose for place in places]), setup.retract)
    near = campaign.machine.index("X")
    ends = (float(poses[:, near].min()) - 1e-3, float(poses[:, near].max()) + 1e-3)
    axes = tuple(replace(a, travel=ends) if k == near else a for k, a in enumerate(campaign.machine.axes))
    narrow = replace(campaign.machine, axes=axes)
    with pytest.raises(ProgramError, match="touching leaves the travel of X"):
        programs(narrow, [setup], places, dialect("linuxcnc"), log=True)


def test_any_line_that_is_missing_doubled_or_moved_is_said(tmp_path: Path) -> None:
    campaign, _, log = logged(tmp_path, 2)
    lines = log.read_text().splitlines()
    for line in range(1, 2 * TOUCHES + 1):
        ways = {
            "missing": lines[:line] + lines[line + 1 :],
            "doubled": [*lines[:line], lines[line], *lines[line:]],
            "moved": [*lines[:line], *lines[line + 1 : -1], lines[line], lines[-1]],
        }
        for way, text in ways.items():
            if text == lines:
                continue
            log.write_text("\n".join(text))
            assert re.search(r"log.txt, line \d+: reading \d", refusal(log, tmp_path, campaign)), (line, way)


def test_a_program_run_twice_is_said_with_both_lines(tmp_path: Path) -> None:
    campaign, _, log = logged(tmp_path)
    log.write_text(log.read_text() * 2)
    assert "line 22: reading 1 was touched in the lines from 2 on, and here again" in refusal(log, tmp_path, campaign)


def test_a_program_that_did_not_end_brings_what_it_has(tmp_path: Path) -> None:
    campaign, _, log = logged(tmp_path)
    log.write_text("\n".join(log.read_text().splitlines()[:10]))
    readings, told = logged_readings(log, tmp_path, campaign)
    assert [reading.number for reading in readings] == [1]
    assert [each.partition(": ")[2] for each in told] == [
        "a run did not come to its end.",
        "reading 2 has 3 of 6 touches and is left out.",
        "of the readings that are planned 2 and 3 do not stand in the log.",
    ]


def test_a_touch_that_meets_nothing_ends_the_program_and_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    campaign = table.description()
    places = table.places(campaign, 2)
    monkeypatch.setattr(table, "met", lambda start, stop: None)
    (program,) = programs(campaign.machine, campaign.setups, places, dialect("linuxcnc"), log=True)
    machine = TouchingMachine()
    (tmp_path / "log.txt").write_text("\n".join(run_linuxcnc(program.text, machine)))
    assert machine.touches == 1
    assert read_touch_log(tmp_path / "log.txt").said == ("at touch 1 of reading 1 the probe met nothing (line 2)",)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (lambda text: re.sub(r" X(-?)", r" X\g<1>9", text, count=1), "met something"),
        (
            lambda text: re.sub(r"(R1\.0+ T2\.0+ X)(\S+)", lambda m: f"{m[1]}{float(m[2]) + 2}", text),
            "show a radius of",
        ),
        (
            lambda text: re.sub(r"(R1\.0+ T6\.0+ .*Z)(\S+)", lambda m: f"{m[1]}{float(m[2]) + 0.2}", text),
            "was 200 um from itself",
        ),
        (lambda text: text.replace("R1.000000 T1", "R7.000000 T1"), "reading"),
        (lambda text: text.replace("R3.", "R7."), "the plan has no reading 7"),
        (lambda text: text.replace("END 3", "END 4"), "took 4 readings, and 3 of them"),
        (lambda text: text.replace(" Y", " Q", 1), "is no line of a log"),
        (lambda text: text.replace("AXISCAL LOG 1", "AXISCAL LOG 2"), "is no line of a log"),
        (lambda text: text.partition("\n")[2], "is no line of a log, or in no run of it"),
        (lambda text: text.replace(" MM", " INCH"), "is no line of a log"),
        (lambda text: "", "this is no log of a measuring program"),
    ],
)
def test_what_is_no_log_of_this_sphere_is_refused(change: object, why: str, tmp_path: Path) -> None:
    assert callable(change)
    campaign, _, log = logged(tmp_path)
    log.write_text(change(log.read_text()))
    assert why in refusal(log, tmp_path, campaign)


def test_sizes_must_be_known_and_something_must_touch() -> None:
    campaign = table.description()
    places = table.places(campaign, 1)
    for text, machine, why in [
        (table.CAMPAIGN.replace('diameter = "25 mm"\n', ""), table.MACHINE, 'diameter = "25 mm"'),
        (table.CAMPAIGN, table.MACHINE.replace('stylus = "6 mm"\n', ""), 'stylus = "6 mm"'),
    ]:
        described = campaign_from_texts(text, "campaign.toml", machine, "machine.toml")
        with pytest.raises(InputError, match=re.escape(why)):
            programs(described.machine, described.setups, places, dialect("linuxcnc"), log=True)
        assert programs(described.machine, described.setups, places, dialect("linuxcnc"))
    with pytest.raises(ProgramError, match="write no log"):
        dialect("fanuc").logging()
    probed = campaign_text("machine.toml", setup_text(places[0].setup, "probe", direction="x"))
    described = campaign_from_texts(probed, "campaign.toml", table.MACHINE, "machine.toml")
    with pytest.raises(ProgramError, match="reads by itself"):
        programs(described.machine, described.setups, places, dialect("linuxcnc"), log=True)
