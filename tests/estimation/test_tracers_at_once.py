"""Tracers that read at once: the estimate is that of as many set-ups from the same distances, stations are found."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.estimation import located
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.located import absorbed
from axiscal.estimation.stations import BentReadings, Optimum, closed_form, mode
from axiscal.exceptions import AmbiguityError
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator, VirtualMachine
from benchmarks.nonlinear.stations import at_once, tracers


def read_at_once(case: Case, seed: int, points: int, flat: float | None = None) -> tuple[VirtualMachine, list[Reading]]:
    """Return a machine and readings at random poses; flat : all of them at one height, m."""
    machine, rng = Simulator(case.description.machine, case.description.setups).drawn(seed), np.random.default_rng(seed)
    low, high = np.array([axis.travel for axis in case.description.machine.axes]).T
    setup, readings = case.description.setups[0], []
    for _ in range(points):
        pose, side = rng.uniform(low, high), tuple(int(s) for s in rng.choice([-1, 1], len(low)))
        pose[2] = pose[2] if flat is None else flat
        value, *others = machine.read_all(setup, tuple(pose.tolist()), side, rng)
        readings.append(Reading(setup.name, tuple(pose.tolist()), side, value, others=tuple(others), time=0.0))
    return machine, readings


@pytest.mark.long
def test_the_estimate_is_that_of_four_set_ups_with_the_same_distances() -> None:
    case, apart = at_once("5 mm", "10 mm"), tracers("5 mm", "10 mm")
    _, readings = read_at_once(case, 2, 12)
    same = [
        Reading(setup.name, r.pose, r.approach, r.values[number], time=0.0)
        for r in readings
        for number, setup in enumerate(apart.description.setups)
    ]
    optima = [mode(BentReadings(*each)) for each in ((case, readings), (apart, same))]
    scale = np.sqrt(np.diagonal(case.prior.covariance))[: len(optima[0].point)]
    np.testing.assert_allclose(optima[0].point / scale, optima[1].point / scale, atol=1e-5)
    assert optima[0].cost == pytest.approx(optima[1].cost, rel=1e-9)
    known = [
        absorbed(each.linear_about(optima[0].point), those, {}).knowledge.belief
        for each, those in ((case, readings), (apart, same))
    ]
    np.testing.assert_allclose(known[0].mean[: len(scale)] / scale, known[1].mean[: len(scale)] / scale, atol=1e-8)
    one, other = (np.sqrt(np.diagonal(each.covariance))[: len(scale)] for each in known)
    np.testing.assert_allclose(one, other, rtol=1e-8)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(2))
def test_four_stations_anywhere_within_300_mm_are_found(seed: int) -> None:
    case = at_once("300 mm", "100 mm")
    machine, readings = read_at_once(case, seed, 25)
    belief = concluded(case, readings).knowledge.belief
    names = [unknown.name for unknown in case.description.setups[0].unknowns]
    truth = np.array([machine.offsets["beams"][name] for name in names])
    size = case.errors.size
    off = belief.mean[size : size + 16] - truth
    assert np.abs(truth).max() > 0.2
    assert np.abs(off).max() < 1e-3
    assert (
        off @ np.linalg.solve(belief.covariance[size : size + 16, size : size + 16], off) < 40
    )  # χ² of 16: 1 in 1,000
    start = closed_form(case, readings, case.prior.mean)[size:]
    assert np.abs(start - truth).max() < 0.05


@pytest.mark.long
def test_a_mirror_image_of_one_of_them_is_refused_with_its_number() -> None:
    """From points in one plane the image of any of the stations fits as well; the fourth stands far above it."""
    case = at_once("300 mm", "100 mm")
    _, readings = read_at_once(case, 0, 12, flat=0.2)
    with pytest.raises(AmbiguityError, match=r'station [1-4] of "beams" fits its readings as well'):
        concluded(case, readings)


def test_a_station_of_several_that_fits_in_two_places_is_named_with_both() -> None:
    case = at_once("300 mm", "100 mm")
    here, there = np.zeros(case.observation.size), np.zeros(case.observation.size)
    there[list(case.station_columns(0)[2])] = 0.1, 0.0, -0.2
    x, y, z = (1e3 * each for each in case.description.setups[0].standing[2])
    said = located._ambiguity(case, 0, 2, Optimum(here, 1.0), Optimum(there, 2.0)).what
    assert said.startswith('station 3 of "')
    assert f"as well at ({x:.1f}, {y:.1f}, {z:.1f}) mm as at ({x + 100:.1f}, {y:.1f}, {z - 200:.1f}) mm" in said
