"""What two linear axes do together and no sum of their curves holds, as a departure from the model."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from axiscal.measurement.departures import SAG, TWIST, Departure, departures, joint_shape

from axiscal.description.campaign import campaign_from_texts
from axiscal.error_model.model import ErrorModel
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading

PLATE = """
chain = "w-Y'-b-X-t"
[axes.X]
travel = ["-100 mm", "300 mm"]
[axes.Y]
travel = ["0 mm", "200 mm"]
[errors]
EZX = { std = "10 um", knots = 7 }
EZY = { std = "10 um", knots = 7 }
"""
BOTH = """
[[setups]]
name = "dial"
instrument = "indicator"
direction = "z"
reach = { X = ["-100 mm", "300 mm"], Y = ["0 mm", "200 mm"] }
"""
ONE_BY_ONE = """
[[setups]]
name = "along X"
instrument = "straightedge"
direction = "z"
moves = ["X"]
[[setups]]
name = "along Y"
instrument = "straightedge"
direction = "z"
moves = ["Y"]
"""
GRID = tuple(itertools.product(np.linspace(0.0, 0.2, 5), np.linspace(-0.1, 0.3, 7)))
"""Poses of Y and X, in the order of the chain."""


def described(machine: str, setups: str) -> Observation:
    """Return what set-ups see of a machine."""
    found = campaign_from_texts(f'machine = "m"\n[target]\nreadings = 9\n{setups}', "c.toml", machine, "m")
    return Observation(ErrorModel(found.machine), found.setups)


def together(machine: str, setups: str, names: tuple[str, ...]) -> list[Departure]:
    observation = described(machine, setups)
    readings = [Reading(name, (float(y), float(x)), (1, 1), 0.0) for name, (y, x) in zip(itertools.cycle(names), GRID)]
    return [each for each in departures(observation, readings) if each.family == "together"]


def test_a_twist_and_a_sag_show_where_one_set_up_moves_both_axes() -> None:
    twist, sag = together(PLATE, BOTH, ("dial",))
    assert [(each.owner, each.place) for each in (twist, sag)] == [("EZYX", TWIST), ("EZYX", SAG)]
    y, x = np.array(GRID).T
    u, v = (y - 0.1) / 0.1, (x - 0.1) / 0.2
    assert twist.columns[:, 0] == pytest.approx(u * v)
    assert sag.columns[:, 0] == pytest.approx((np.cos(np.pi * u / 2) - 2 / np.pi) * (np.cos(np.pi * v / 2) - 2 / np.pi))


def test_what_is_described_or_read_axis_by_axis_is_no_departure() -> None:
    plane = PLATE + 'EZXY = { std = "5 um", knots = [5, 5] }\n'
    assert together(plane, BOTH, ("dial",)) == []
    assert together(PLATE, ONE_BY_ONE, ("along X", "along Y")) == []


@pytest.mark.parametrize("place", [TWIST, SAG])
def test_curves_of_each_axis_hold_none_of_it(place: float) -> None:
    """Its mean along either axis is nought wherever the other one stands."""
    axes = campaign_from_texts(f'machine = "m"\n[target]\nreadings = 9\n{BOTH}', "c.toml", PLATE, "m").machine.axes
    middles = [a.travel[0] + a.length * (np.arange(400) + 0.5) / 400 for a in axes]
    for fixed, moving in ((0, 1), (1, 0)):
        for share in (0.0, 0.3, 1.0):
            poses = np.zeros((400, 2))
            poses[:, fixed] = axes[fixed].travel[0] + share * axes[fixed].length
            poses[:, moving] = middles[moving]
            assert np.mean(joint_shape(place, (0, 1), axes, poses)) == pytest.approx(0.0, abs=1e-5)
