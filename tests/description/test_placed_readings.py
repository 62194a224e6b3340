"""Readings that do not fit their set-up or machine: each refusal says what is wrong and what would be right."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axiscal.description.placed_readings import placed_approach, placed_pose, placed_readings
from axiscal.exceptions import ReadingError
from axiscal.measurement.readers.csv_readings import Around, RawReading
from axiscal.measurement.readers.files import recognised
from tests.generators.campaigns import built_in, on
from tests.generators.texts import artefact_text, machine_text, setup_text

MILL = setup_text(
    "laser", "interferometer", direction="x", moves=["X"], park={"Y": "250 mm", "Z": "100 mm"}
) + setup_text("dial", "straightedge", direction="y", moves=["X"])
BALLS = artefact_text("balls", balls={"low": ["200 mm", "0 mm", "-80 mm"]}) + setup_text(
    "nest", "rtest", artefact="balls"
)
LINE = setup_text("diagonal", "interferometer", along=[["100 mm", "100 mm", "50 mm"], ["300 mm", "300 mm", "200 mm"]])


TWICE = MILL.replace('direction = "y"', 'direction = "z"').replace('direction = "x"', 'direction = "-z"')


@pytest.mark.parametrize(
    ("campaign", "position", "error", "why"),
    [
        (MILL, {"X": 0.1}, "z", "no set-up reads a length along z while X moves"),
        (TWICE, {"X": 0.1}, "z", "several set-ups read a length along z"),
        (MILL, {"": 0.1}, "", "the campaign has more than one of them"),
    ],
)
def test_a_reading_that_does_not_fit_a_set_up_is_refused(
    campaign: str, position: dict[str, float], error: str, why: str
) -> None:
    row = RawReading("", position, {}, 1e-6, None, "length", 7, error=error)
    with pytest.raises(ReadingError, match=why) as refused:
        placed_readings((row,), built_in(campaign), "r.csv")
    assert str(refused.value).startswith("r.csv, line 7: ")


def test_a_test_is_of_the_only_set_up() -> None:
    alone = built_in(MILL.rpartition("[[setups]]")[0])
    tested = RawReading("", {"": 0.1}, {"": -1}, 1e-6, None, "length", 3, test="positioning")
    (reading,) = placed_readings((tested,), alone, "r.csv")
    assert (reading.setup, reading.pose[0], reading.approach[0]) == ("laser", 0.1, -1)


@pytest.mark.parametrize(("direction", "sign"), [("x", 1), ("-x", -1)])
def test_a_test_says_how_far_the_axis_goes_whichever_way_its_set_up_looks(direction: str, sign: int) -> None:
    campaign = built_in(setup_text("laser", "interferometer", direction=direction, moves=["X"]))
    tested = RawReading("", {"": 0.1}, {"": 1}, 1e-6, None, "length", 3, test="positioning")
    (reading,) = placed_readings((tested,), campaign, "r.csv")
    assert reading.value == sign * 1e-6


def test_a_test_needs_a_set_up_that_looks_along_its_axis_where_the_table_stands() -> None:
    laser: dict[str, Any] = {"direction": "x", "moves": ["X"]}
    for turned, sign in (("0 deg", 1), ("180 deg", -1)):
        campaign = built_in(setup_text("laser", "interferometer", **laser, park={"B": "0 deg", "C": turned}), "dmu60")
        tested = RawReading("", {"": 0.1}, {"": 1}, 1e-6, None, "length", 3, test="positioning")
        assert placed_readings((tested,), campaign, "r.csv")[0].value == sign * 1e-6


def _bar(name: str, plane: str, **more: Any) -> str:
    return setup_text(name, "ballbar", length="150 mm", station=["300 mm", "200 mm", "80 mm"], plane=plane, **more)


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("angle", [20.0, 130.0, 250.0])
def test_a_circular_test_is_read_where_its_angle_is(angle: float, way: int) -> None:
    """In the plane xy the bar points along x at 0 and turns to y; the axes come from where it came."""
    campaign, turned = built_in(_bar("flat", "xy")), np.radians(angle)
    tested = RawReading("", {"": float(turned)}, {"": way}, 1e-6, None, "length", 3, test="circle")
    (reading,) = placed_readings((tested,), campaign, "r.csv")
    machine, towards = campaign.machine, np.array([np.cos(turned), np.sin(turned), 0.0])
    assert machine.frames(np.array([reading.pose])).tcp[0] == pytest.approx([0.3, 0.2, 0.08] + 0.15 * towards)
    axes = {axis.name: k for k, axis in enumerate(machine.axes)}
    came = [reading.approach[axes[name]] for name in "XYZ"]
    assert came == [-way * np.sign(np.sin(turned)), way * np.sign(np.cos(turned)), 0]


def test_a_circular_test_names_its_set_up_or_its_only_one_and_stays_on_the_arc() -> None:
    both = built_in(_bar("flat", "xy", arc=["0 deg", "90 deg"]) + _bar("up", "zx"))
    (reading,) = placed_readings(
        (RawReading("up", {"": 0.1}, {"": 1}, 1e-6, None, "length", 3, test="circle"),), both, "r.csv"
    )
    assert reading.setup == "up"


def test_where_a_ball_is_held_the_slides_follow_and_a_place_beside_it_is_named() -> None:
    campaign = built_in(BALLS, "dmu60")
    (setup,), machine = campaign.setups, campaign.machine
    pose = placed_pose(setup, machine, {"B": 0.1, "C": 0.2})
    np.testing.assert_allclose(machine.frames(np.array([pose])).tcp[0], [0.2, 0.0, -0.08], atol=1e-12)
    assert placed_approach(setup, machine, {"C": -1})[machine.index("C")] == -1


def test_a_place_beside_a_line_is_named() -> None:
    campaign = built_in(LINE)
    (setup,) = campaign.setups
    assert setup.chart is not None
    (pose,) = setup.chart.poses(np.array([[0.1]])).tolist()
    said = dict(zip((axis.name for axis in campaign.machine.axes), pose, strict=True))
    assert placed_pose(setup, campaign.machine, said) == pytest.approx(pose)


WIDE = machine_text("w-b-X-t", {"X": (-350, 600)}, {"EXX": "10 um"})


def placed_x(tmp_path: Path, unit: str, text: str) -> float:
    """Return where a table has X, m, on a travel from -350 mm to 600 mm."""
    laser = setup_text("laser", "interferometer", direction="x", moves=["X"])
    campaign = on(WIDE, laser)
    file = tmp_path / "readings.csv"
    file.write_text(f"setup,X_{unit},approach,value_um\nlaser,{text},X+,1\n")
    raw = recognised(file, Around(campaign.machine.axes, campaign.setups)).readings
    (reading,) = placed_readings(raw, campaign, file)
    return reading.pose[0]


@pytest.mark.parametrize(
    ("unit", "text", "end"),
    [
        ("in", "23.62205", 0.6),
        ("in", "2.362205e1", 0.6),
        ("in", "-13.780", -0.35),
        ("in", "\N{MINUS SIGN}13.77953", -0.35),
        ("mm", "600.00", 0.6),
    ],
)
def test_an_end_of_the_travel_may_be_rounded_in_its_last_digit(
    tmp_path: Path, unit: str, text: str, end: float
) -> None:
    assert placed_x(tmp_path, unit, text) == end
