"""Stations that nobody knows: found from the prior as from closed form, numbers done elsewhere, mirrors refused."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.promise.posterior import sorted_out
from axiscal.estimation.stations import BentReadings, closed_form, polished
from axiscal.exceptions import AmbiguityError
from axiscal.machine import load_machine
from axiscal.measurement.instruments.distance import Distance
from axiscal.measurement.instruments.kind import Nominal
from axiscal.measurement.instruments.tracker import Tracker
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup, Unknown
from axiscal.numerics import Array
from benchmarks.nonlinear.stations import read, tracers
from tests.generators.problems import stated


class _At(Nominal):
    """Tool points anywhere, whatever machine would bring a tool there."""

    def __init__(self, places: Array) -> None:
        super().__init__(load_machine("three-axis-mill"), np.zeros((len(places), 3)), ())
        self.__dict__["tcp"] = places


_CORNERS = np.array([[x, y, z] for x in (0.0, 0.5) for y in (0.0, 0.5) for z in (0.0, 0.5)])


@pytest.mark.parametrize(("std", "expected"), [(0.1, 1.08e5), (5e-3, 270.0), (1e-4, 0.108)])
def test_the_index_of_a_distance_is_that_of_the_design(std: float, expected: float) -> None:
    """Eight corners of a cube of half a metre, σ = 0.3 um; the largest of √(μ² + τ²)/σ."""
    names = ("station_x", "station_y", "station_z")
    setup = Setup(
        "s", "tracer", (0.0, 0.0, 1.0), (0,), (0.0,) * 3, 3e-7, tuple(Unknown(name, std) for name in names),
        0.0, 0.0, 1.0, (0.0,) * 3, "+", station=(0.8, -0.3, 0.1),
    )  # fmt: skip
    curved = Distance().curvature(setup, np.zeros(3), _At(_CORNERS)) * std**2
    index = np.sqrt((np.trace(curved, axis1=1, axis2=2) / 2) ** 2 + np.einsum("mij,mji->m", curved, curved) / 2) / 3e-7
    assert index.max() == pytest.approx(expected, rel=0.01)


def test_the_curvature_of_a_tracker_is_the_difference_of_what_it_shows() -> None:
    names = ("turn_x", "turn_y", "turn_z")
    setup = Setup(
        "t", "tracker", (0.0, 0.0, 1.0), (0,), (0.0,) * 3, 1e-5, tuple(Unknown(name, 0.1) for name in names),
        0.0, 0.0, 1.0, (0.0,) * 3, "+", station=(1.0, -0.3, 0.1),
    )  # fmt: skip
    at, direction, step = _At(_CORNERS), np.array([0.6, 0.0, 0.8]), 1e-3
    from axiscal.measurement.instruments.kind import Actual

    still = Actual(np.zeros((8, 3)), np.zeros((8, 3)))

    def shown(turn: Array) -> Array:
        return Tracker().shown(setup, direction, at, still, dict(zip(names, turn.tolist(), strict=True)))

    found = Tracker().curvature(setup, direction, at)
    for j in range(3):
        for k in range(3):
            one, two = step * np.eye(3)[j], step * np.eye(3)[k]
            second = (shown(one + two) - shown(one - two) - shown(two - one) + shown(-one - two)) / (4 * step**2)
            assert found[:, j, k] == pytest.approx(second, abs=1e-5)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
def test_stations_anywhere_within_300_mm_are_found_from_the_prior_as_from_closed_form(seed: int) -> None:
    case = tracers("300 mm", "100 mm")
    machine, readings = read(case, seed)
    problem = BentReadings(case, readings)
    assert float(np.max(problem.second_order(case.prior.mean, case.prior.factor))) > 1e8
    damped, by_form = (
        polished(problem, start) for start in (case.prior.mean, closed_form(case, readings, case.prior.mean))
    )
    assert damped.cost == pytest.approx(by_form.cost, rel=1e-6)
    truth = np.concatenate([list(machine.offsets[setup.name].values()) for setup in case.description.setups])
    assert np.abs(damped.point[case.errors.size :] - truth).max() < 5e-4
    assert 0.5 < damped.cost / (len(problem.values) / 2) < 1.5


@pytest.mark.long
def test_a_station_and_its_mirror_image_are_refused_with_the_reading_that_decides() -> None:
    case = tracers("300 mm", "100 mm")
    machine, _ = read(case, 0)
    setup, rng = case.description.setups[1], np.random.default_rng(5)
    poses = [(float(rng.uniform(0, 0.5)), float(rng.uniform(0, 0.4)), 0.2) for _ in range(30)]
    flat = [Reading(setup.name, p, (1, 1, 1), machine.read(setup, p, (1, 1, 1), rng), time=0.0) for p in poses]
    with pytest.raises(AmbiguityError, match=r'the station of "tracer 2" fits .* Read "tracer 2" at X = .*, Z = '):
        concluded(case, flat)
    above = [(*pose[:2], 0.45) for pose in poses[:6]]
    more = [Reading(setup.name, p, (1, 1, 1), machine.read(setup, p, (1, 1, 1), rng), time=0.0) for p in above]
    known = concluded(case, [*flat, *more])
    columns = list(known.case.station_columns(1)[0])
    truth = [machine.offsets[setup.name][name] for name in ("station_x", "station_y", "station_z")]
    assert known.knowledge.belief.mean[columns] == pytest.approx(truth, abs=2e-3)


@pytest.mark.long
def test_readings_agree_about_stations_as_found() -> None:
    """About stations that are 300 mm off no prior fits; about those that were found this one does."""
    case = tracers("300 mm", "100 mm")
    _, readings = read(case, 1)
    known = concluded(case, readings)
    assert sorted_out(stated(case, readings)).posterior().agreement.contradicts
    assert not known.agreement.contradicts


def test_a_ball_bar_on_a_machine_without_a_third_axis_stays_in_its_plane() -> None:
    """All its places are at a height of exactly nought, which no scale divides."""
    chain = 'chain = "w-b-X-Y-t"\n[axes.X]\ntravel = ["0 mm", "400 mm"]\n[axes.Y]\ntravel = ["0 mm", "400 mm"]\n'
    bar = '[[setups]]\nname = "bar"\ninstrument = "ballbar"\nlength = "100 mm"\nplane = "xy"\n'
    text = f'machine = "m.toml"\n{bar}station = ["200 mm", "200 mm", "0 mm"]\n'
    errors = '[errors]\nEXX = { std = "5 um", knots = 5 }\nEYY = { std = "5 um", knots = 5 }\n'
    case = Case(campaign_from_texts(text, "c.toml", chain + errors, "m.toml"))
    at = [(0.2 + 0.1 * np.cos(turn), 0.2 + 0.1 * np.sin(turn)) for turn in np.linspace(0.0, 6.0, 8)]
    readings = [Reading("bar", (float(x), float(y)), (1, 1), 1e-6) for x, y in at]
    assert closed_form(case, readings, case.prior.mean) == pytest.approx(case.prior.mean)
