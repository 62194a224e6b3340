"""A lathe whose display shows diameters: readings say which they are, programs, tables and the prompt speak of radii.

The cross slide is written out here: its lead error is 180 um/m of the radius.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from tests.zoo.animals import Job
from tests.zoo.answers import Answer
from tests.zoo.mills import LATHE
from tests.zoo.running import described, given, rows_of

LEAD = 0.18
"""um per mm of the radius."""
RADIUS = np.linspace(-5.0, 115.0, 13)


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return described(Job(LATHE, ("laser",), "20 um"), tmp_path_factory.mktemp("lathe") / "job")


def estimated(campaign: Path, folder: Path, column: str, places: np.ndarray) -> Answer:
    noise = np.random.default_rng(4).normal(0, 0.3, 2 * len(RADIUS))
    there = np.concatenate([RADIUS, RADIUS[::-1]])
    shown = np.round(LEAD * there + noise, 2).tolist()
    ways = ["X+"] * len(RADIUS) + ["X-"] * len(RADIUS)
    at = np.concatenate([places, places[::-1]]).tolist()
    rows = zip(["laser along X"] * len(shown), at, ways, shown, strict=True)
    (folder / "r.csv").write_text(rows_of(f"setup,{column},approach,value_um", rows))
    return Answer(folder / "out", given("data", "estimate", campaign, folder / "r.csv", "--out", folder / "out"))


def test_readings_say_what_they_are(campaign: Path, tmp_path: Path) -> None:
    """Diameters are read, radii are written, and what is written is read again."""
    answer = estimated(campaign, tmp_path, "X_diameter_mm", 2 * RADIUS)
    where, values = answer.axis_table("X")
    assert np.polyfit(where, values.mean(axis=0), 1)[0] == pytest.approx(LEAD, rel=0.05)
    assert "Coordinates and corrections of X are radii" in next(tmp_path.rglob("csv/README.txt")).read_text()
    written = answer.folder / "data" / "readings.csv"
    with written.open(newline="") as file:
        assert "X_radius_mm" in next(csv.reader(file))
    again = given("data", "estimate", campaign, written, "--out", tmp_path / "again")
    assert again.status == 0


def test_programs_and_their_sheet_say_the_radius(campaign: Path, tmp_path: Path) -> None:
    assert given("plan", campaign, "--readings", 6, "--gcode", "linuxcnc", "--out", tmp_path / "nc").status == 0
    program = next(path for path in tmp_path.rglob("*.ngc") if path.stem.endswith("_X"))
    assert "(X IS THE RADIUS)" in program.read_text().splitlines()
    assert "X_radius_mm" in (tmp_path / "nc" / "readings.csv").read_text()


def test_the_prompt_says_both(campaign: Path, tmp_path: Path) -> None:
    record = tmp_path / "l.axiscal"
    assert given("step", "start", campaign, record).status == 0
    asked = given("step", "next", record).out
    assert "(the diameter " in asked
