"""Stations that nobody knows: found from the prior as from closed form, numbers done elsewhere, mirrors refused."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.promise.posterior import sorted_out
from axiscal.estimation.stations import BentReadings, closed_form, indices, polished
from axiscal.exceptions import AmbiguityError
from axiscal.measurement.reading import Reading
from benchmarks.nonlinear.stations import read, tracers
from tests.generators.problems import stated


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
def test_stations_anywhere_within_300_mm_are_found_from_the_prior_as_from_closed_form(seed: int) -> None:
    case = tracers("300 mm", "100 mm")
    machine, readings = read(case, seed)
    problem = BentReadings(case, readings)
    assert float(np.max(indices(case.knowledge, readings))) > 1e4
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
