"""Stations that nobody knows, alone and several at once: mirrors refused."""

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation import located
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.stations import Optimum
from axiscal.exceptions import AmbiguityError
from axiscal.measurement.reading import Reading
from tests.generators.tracers import at_once, read, tracers


def test_a_station_of_several_that_fits_in_two_places_is_named_with_both() -> None:
    case = at_once("300 mm", "100 mm")
    here, there = np.zeros(case.observation.size), np.zeros(case.observation.size)
    there[list(case.station_columns(0)[2])] = 0.1, 0.0, -0.2
    x, y, z = (1e3 * each for each in case.description.setups[0].standing[2])
    said = located._ambiguity(case, 0, 2, Optimum(here, 1.0), Optimum(there, 2.0)).what
    assert said.startswith('station 3 of "')
    assert f"as well at ({x:.1f}, {y:.1f}, {z:.1f}) mm as at ({x + 100:.1f}, {y:.1f}, {z - 200:.1f}) mm" in said


@pytest.mark.long
def test_a_station_and_its_mirror_image_are_refused_with_the_reading_that_decides() -> None:
    case = tracers("300 mm", "100 mm")
    machine, _ = read(case, 0)
    setup, rng = case.description.setups[1], np.random.default_rng(5)
    poses = [(float(rng.uniform(0, 0.5)), float(rng.uniform(0, 0.4)), 0.2) for _ in range(30)]
    flat = [Reading(setup.name, p, (1, 1, 1), machine.read_all(setup, p, (1, 1, 1), rng)[0], time=0.0) for p in poses]
    with pytest.raises(AmbiguityError, match=r'the station of "tracer 2" fits .* Read "tracer 2" at X = .*, Z = '):
        concluded(case, flat)
    above = [(*pose[:2], 0.45) for pose in poses[:6]]
    more = [Reading(setup.name, p, (1, 1, 1), machine.read_all(setup, p, (1, 1, 1), rng)[0], time=0.0) for p in above]
    known = concluded(case, [*flat, *more])
    columns = list(known.case.station_columns(1)[0])
    truth = [machine.offsets[setup.name][name] for name in ("station_x", "station_y", "station_z")]
    assert known.knowledge.belief.mean[columns] == pytest.approx(truth, abs=2e-3)


def test_a_ball_bar_on_a_machine_without_a_third_axis_stays_in_its_plane() -> None:
    """All its places are at a height of exactly nought, which no scale divides."""
    chain = 'chain = "w-b-X-Y-t"\n[axes.X]\ntravel = ["0 mm", "400 mm"]\n[axes.Y]\ntravel = ["0 mm", "400 mm"]\n'
    bar = '[[setups]]\nname = "bar"\ninstrument = "ballbar"\nlength = "100 mm"\nplane = "xy"\n'
    text = f'machine = "m.toml"\n{bar}station = ["200 mm", "200 mm", "0 mm"]\n'
    errors = '[errors]\nEXX = { std = "5 um", knots = 5 }\nEYY = { std = "5 um", knots = 5 }\n'
    case = Case(campaign_from_texts(text, "c.toml", chain + errors, "m.toml"))
    at = [(0.2 + 0.1 * np.cos(turn), 0.2 + 0.1 * np.sin(turn)) for turn in np.linspace(0.0, 6.0, 8)]
    readings = [Reading("bar", (float(x), float(y)), (1, 1), 1e-6) for x, y in at]
    columns = list(case.station_columns(0)[0])
    assert concluded(case, readings).knowledge.belief.mean[columns] == pytest.approx(np.zeros(3), abs=1e-4)
