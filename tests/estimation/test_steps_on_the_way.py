"""Steps on the way to an estimate: which stages are said, what decides between two places, what two axes leave."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
from axiscal.estimation.departed_volume import field as left_over_the_volume
from axiscal.estimation.statements import _least
from axiscal.measurement.departures import Departure

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.mirrors import _decisive
from axiscal.machine import load_machine
from axiscal.numerics.stages import Stage, listening
from benchmarks.nonlinear.stations import tracers
from tests.estimation.test_off_the_lines import plate
from tests.generators.laser_axis import CASE, machine, read


@dataclass
class Heard:
    """Who notes which stages begin and end."""

    every: list[Stage] = field(default_factory=list)
    open: int = 0

    def begun(self, stage: Stage) -> None:
        """Note it."""
        self.every.append(stage)
        self.open += 1

    def moved(self, number: int) -> None:
        """Nothing is counted here."""

    def ended(self) -> None:
        """Note that it has ended."""
        self.open -= 1


def test_the_four_stages_of_a_conclusion_are_said_in_their_order() -> None:
    heard = Heard()
    with listening(heard):
        concluded(CASE, read(machine(1), 4))
    assert [(stage.number, stage.of) for stage in heard.every if stage.of == 4] == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert heard.open == 0


TRACKER = """machine = "m"
[target]
readings = 1
[[setups]]
name = "tracker"
instrument = "tracker"
station = ["300 mm", "-1500 mm", "-200 mm"]
unknowns = { zero_x = "3 mm", turn_x = "20 mrad", turn_y = "20 mrad", turn_z = "20 mrad" }
"""


def test_a_tracker_that_is_turned_bends_and_has_no_station_to_be_found() -> None:
    case = Case(campaign_from_texts(TRACKER, "c.toml", load_machine("three-axis-mill").text, "m"))
    assert case.bends
    assert case.station_columns(0) == ()
    mean = case.prior.mean.copy()
    names = [unknown.name for unknown in case.observation.unknowns]
    mean[case.errors.size + names.index("turn_y")] = 4e-3
    there = case.located(mean)
    assert there is not None
    assert there.description.setups[0].found == pytest.approx((0.0, 4e-3, 0.0))
    (setup,) = case.description.setups
    units = {unknown.name: case.unit_of(setup, unknown) for unknown in setup.unknowns}
    assert units == {"zero_x": "um", "turn_x": "urad", "turn_y": "urad", "turn_z": "urad"}


def test_what_decides_between_two_places_of_a_station_is_where_its_distances_differ_most() -> None:
    """By the places that may be read, each with the distance to either, less that to where it is stated to stand."""
    case = tracers("300 mm", "100 mm")
    columns = list(case.station_columns(1)[0])
    here, there = np.zeros(case.observation.size), np.zeros(case.observation.size)
    there[columns] = 0.1, 0.05, -0.2
    pose, differ = _decisive(case, 1, 0, here, there)
    poses, sides = case.lattice.of(1)
    one, two = (case.observation.shown(1, poses, sides, point)[:, 0] for point in (here, there))
    apart = np.abs(one - two)
    assert differ == pytest.approx(apart.max())
    assert apart[[place == pose for place in poses.tolist()]].max() == pytest.approx(differ)
    stated = np.array(case.description.setups[1].standing[0])
    by_hand = np.linalg.norm(np.array(pose) - stated) - np.linalg.norm(np.array(pose) - stated - there[columns])
    assert differ == pytest.approx(abs(by_hand), rel=0.25)
    assert 0.05 < differ <= np.linalg.norm(there[columns]) + 1e-9


@pytest.mark.parametrize(
    ("place", "square"),
    [(0.0, 1 / 9), (1.0, (0.5 - 4 / np.pi**2) ** 2)],
    ids=["twist", "sag"],
)
def test_what_two_axes_leave_over_the_volume_is_the_mean_square_of_their_shape(place: float, square: float) -> None:
    """∫∫ (u v)² over ±1 is a ninth, of (cos πu/2 − 2/π)(cos πv/2 − 2/π) the square of 1/2 − 4/π²; splines hold none."""
    case = plate("10 um")
    index = next(n for n, each in enumerate(case.errors.functions) if each.name == "EZY")
    departure = Departure("together", "EZXY", np.zeros((1, 1)), place, index, (0, 1))
    followed, beside = left_over_the_volume(case.yardstick, departure)
    assert not followed.any()
    assert beside == pytest.approx(square, rel=0.02)


@pytest.mark.parametrize(
    ("shares", "promise"),
    [
        ([0.3, 0.1, 0.03, 0.01, 0.0], 2.5),
        ([0.3, 0.1, 0.06, 0.03, 0.01], 3.5),
        ([0.3, 0.1, 0.06, 0.05, 0.04], 4.0),
        ([0.01, 0.03, 0.01, 0.03, 0.0], 3 + 1 / 3),
        ([0.03, 0.0, 0.0, 0.0, 0.0], 1 / 3),
        ([0.02, 0.01, 0.0, 0.0, 0.0], 0.0),
    ],
    ids=["between", "before the last", "no fewer at the last", "where it falls last", "at the first", "never more"],
)
def test_a_promise_is_borne_from_where_no_more_than_one_in_fifty_are_spoilt(
    shares: list[float], promise: float
) -> None:
    assert _least(np.arange(5.0), np.array(shares)) == pytest.approx(promise)
