"""Rows have the sign of the axis as it counts, wherever a table stands and whichever way an instrument looks.

The truth is a machine that goes where other coordinates, or other axis lines, would bring it, by its exact chain.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.description.setup_of_reading import setup_of
from axiscal.estimation.functionals.asked import asked_rows
from axiscal.machine import DescribedMachine
from axiscal.machine.description import load_machine, machine_from_text
from axiscal.machine.kinematics import turn_between
from axiscal.measurement.readers.csv_readings import RawReading
from axiscal.numerics import Array
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine
from tests.generators.campaigns import on
from tests.generators.texts import Said, campaign_text, setup_text

TOO_FAR, OPENS, LAGS = 40e-6, 25e-6, 6e-6
"""Truth: X goes too far, 40 um/m, and leaves square towards +Y, 25 urad; it lags behind by 6 um."""
STANDS: tuple[Mapping[str, float], ...] = ({}, {"C": 90}, {"C": 180}, {"C": 270}, {"B": 90, "C": 180}, {"B": 90})


@cache
def five(*reversed_axes: str) -> DescribedMachine:
    """Return the built-in machine of five axes, of which some count against ISO 841."""
    text = load_machine("dmu60").text
    for name in reversed_axes:
        text = text.replace(f"[axes.{name}]\n", f'[axes.{name}]\ndirection = "reversed"\n')
    return machine_from_text(text, "machine.toml")


def deviation(machine: Machine, poses: Array, sides: Array) -> Array:
    """Return where the tool point is in the workpiece frame less where it should be, (m, 3) m."""
    went, x, y = poses.copy(), machine.index("X"), machine.index("Y")
    went[:, x] += TOO_FAR * poses[:, x] - LAGS / 2 * sides[:, x]
    went[:, y] += OPENS * poses[:, x]
    return np.asarray(machine.frames(went).tcp - machine.frames(poses).tcp)


def laser(machine: Machine, stands: Mapping[str, float], against: bool) -> str:
    """Return a set-up that looks along X as it counts, or against it, while a table stands somewhere."""
    pose = np.zeros((2, len(machine.axes)))
    for name, degrees in stands.items():
        pose[:, machine.index(name)] = np.radians(degrees)
    pose[1, machine.index("X")] = 1.0
    at, past = machine.frames(pose).tcp
    direction = np.round((past - at) * (-1 if against else 1)).tolist()
    park = {"Y": "0 mm", "Z": "250 mm", "B": "0 deg", "C": "0 deg"} | {k: f"{v} deg" for k, v in stands.items()}
    said: dict[str, Said] = {"direction": direction, "moves": ["X"], "approach": "both", "park": park}
    return setup_text("laser", "interferometer", unknowns={"zero": "1 mm"}, drift="0 um/h", noise="0.3 um", **said)


def described(machine: DescribedMachine, setup: str, *wants: str) -> CampaignDescription:
    """Return a campaign of one set-up."""
    return on(machine.text, setup, target={"readings": 60, "wants": list(wants)})


@pytest.mark.parametrize("against", [False, True])
@pytest.mark.parametrize("reversed_axes", [(), ("X",), ("Y",), ("X", "C"), ("X", "Y", "Z")])
@pytest.mark.parametrize("stands", STANDS)
def test_rows_of_a_linear_axis_are_the_same_wherever_a_table_stands(
    stands: Mapping[str, float], reversed_axes: tuple[str, ...], against: bool
) -> None:
    machine = five(*reversed_axes)
    campaign = described(machine, laser(machine, stands, against))
    found = {}
    for row in asked_rows(campaign, ()):
        if row.map is not None:
            found[row.want.row.name] = row.map.row(deviation(machine, row.map.poses, row.map.sides))
    assert list(found) == ["positioning X", "scale X", "backlash X"]
    assert found["scale X"] == pytest.approx([TOO_FAR], rel=1e-6)
    assert found["backlash X"] == pytest.approx([-LAGS], rel=1e-6)
    ramp = TOO_FAR * np.linspace(-0.3, 0.3, 41)
    both = np.concatenate([ramp - LAGS / 2, ramp + LAGS / 2])
    np.testing.assert_allclose(found["positioning X"], both, atol=1e-10)


@pytest.mark.parametrize("reversed_axes", [(), ("X",), ("Y",), ("X", "Y")])
@pytest.mark.parametrize("stands", [(0, 360), (170, 190), (85, 95)])
def test_squareness_is_above_zero_where_the_angle_between_both_ways_of_counting_is_above_90_degrees(
    stands: tuple[float, float], reversed_axes: tuple[str, ...]
) -> None:
    machine = five(*reversed_axes)
    text = laser(machine, {}, against=False) + f'[target.volume]\nC = ["{stands[0]} deg", "{stands[1]} deg"]\n'
    setups, volume = text.split("[target.volume]")
    head = campaign_text("m", target={"readings": 60, "wants": ["squareness XY"]})
    campaign = campaign_from_texts(f"{head}[target.volume]{volume}{setups}", "c.toml", machine.text, "m")
    (square,) = asked_rows(campaign, ())
    assert square.map is not None
    assert square.map.row(deviation(machine, square.map.poses, square.map.sides)) == pytest.approx([-OPENS], rel=1e-4)


def displaced(machine: Machine, name: str, shift: Array, lean: Array) -> Machine:
    """Return a machine with the line of a rotary axis elsewhere.  shift : (3,) m; lean : (3,) rad, machine frame"""

    def moved(axis: Axis) -> Axis:
        if axis.name != name:
            return axis
        x, y, z = np.array(axis.origin) + shift
        leaning = replace(axis, origin=(x, y, z))
        way = np.array(axis.direction) + np.cross(lean, axis.direction)
        object.__setattr__(leaning, "direction", tuple(way.tolist()))  # no description states such a line
        return leaning

    return replace(machine, axes=tuple(map(moved, machine.axes)))


@pytest.mark.parametrize(
    ("axis", "other", "reversed_axes", "signs"),
    [
        ("C", ("B", 35, 45), (), {}),
        ("B", ("C", 170, 190), (), {}),
        ("B", ("C", 85, 95), ("C",), {}),
        ("B", ("C", 170, 190), ("B", "X", "Z"), {"X": -1, "Z": -1}),
        ("C", ("B", 35, 45), ("X", "B"), {"X": -1}),
    ],
)
def test_the_line_of_a_rotary_axis_is_where_the_axes_count_it(
    axis: str, other: tuple[str, float, float], reversed_axes: tuple[str, ...], signs: Mapping[str, int]
) -> None:
    machine, (name, low, high) = five(*reversed_axes), other
    shift, lean = np.array([12e-6, -5e-6, 9e-6]), np.array([30e-6, -40e-6, 20e-6])
    head = campaign_text("m", target={"readings": 60, "wants": [f"centre of {axis}", f"tilt of {axis}"]})
    volume = f'[target.volume]\n{name} = ["{low} deg", "{high} deg"]\n'
    text = head + volume + laser(machine, {}, against=False)
    centre, tilt = (row.map for row in asked_rows(campaign_from_texts(text, "c.toml", machine.text, "m"), ()))
    assert centre is not None
    assert tilt is not None
    at = displaced(machine, axis, shift, np.zeros(3)).frames(centre.poses).tcp - machine.frames(centre.poses).tcp
    leaning = displaced(machine, axis, np.zeros(3), lean)
    turned = turn_between(machine.frames(tilt.poses).tool, leaning.frames(tilt.poses).tool)
    every = dict(zip("XYZABC", (*shift, *lean), strict=True))
    for functional, values in ((centre, at), (tilt, turned)):
        expected = {way: every[way] * signs.get(way, 1) for way in functional.directions}
        assert len(expected) == 2
        found = dict(zip(functional.directions, functional.row(values).tolist(), strict=True))
        assert found == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("against", [False, True])
def test_a_reading_of_an_axis_has_the_sign_of_the_axis(against: bool) -> None:
    machine = five("X")
    campaign = described(machine, laser(machine, {"C": 90}, against))
    raw = RawReading("", {"": 0.1}, {"": 1}, 1e-6, None, "length", 1, test="positioning")
    assert setup_of(raw, campaign) == (campaign.setups[0], -1 if against else 1)
