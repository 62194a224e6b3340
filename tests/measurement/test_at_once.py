"""Tracers that read at once: each number is that of a tracer alone, and what is said of them, filled in and refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.description.placed_readings import placed_readings
from axiscal.machine import load_machine
from axiscal.measurement.charts.kinds import Sight
from axiscal.measurement.observation import Observation
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.reading import Places, columns_of
from axiscal.measurement.reading_rows import blank_readings
from axiscal.measurement.setup import Unknown
from tests.generators.campaigns import built_in

PLACES = ('["-900 mm", "-700 mm", "-500 mm"]', '["900 mm", "-600 mm", "-100 mm"]', '["100 mm", "100 mm", "700 mm"]')
UNKNOWNS = 'unknowns = { zero = "10 mm", station_x = "5 mm", station_y = "5 mm", station_z = "5 mm", tool_x = "1 mm" }'
TOGETHER = f'[[setups]]\nname = "beams"\ninstrument = "tracer"\nstations = [{", ".join(PLACES)}]\n{UNKNOWNS}\n'
FOUND = ((0.11, -0.2, 0.05), (-0.07, 0.02, 0.13), (0.01, 0.3, -0.2))


def one(number: int) -> str:
    place = f'name = "beam {number + 1}"\ninstrument = "tracer"\nstation = {PLACES[number]}'
    return f"[[setups]]\n{place}\n{UNKNOWNS}\n"


@pytest.mark.parametrize("located", [False, True])
def test_each_number_is_that_of_a_tracer_alone(located: bool) -> None:
    together = built_in(TOGETHER).setups[0]
    alone = built_in("".join(map(one, range(3)))).setups
    if located:
        together = replace(together, found=tuple(each for place in FOUND for each in place))
        alone = tuple(replace(setup, found=place) for setup, place in zip(alone, FOUND, strict=True))
    model, rng = load_machine("three-axis-mill"), np.random.default_rng(3)
    poses, sides = rng.uniform(0.0, 0.3, (5, 3)), np.ones((5, 3))
    whole = Observation(model, (together,))
    point = rng.normal(0.0, 1e-5, model.size + len(together.unknowns))
    shown, beyond = whole.shown(0, poses, sides, point), whole.nonlinear_part(0, poses, sides)
    places = Places.of_setup(0, poses, sides)
    rows = whole.numbers(places).rows.reshape(5, -1, whole.size).swapaxes(0, 1)
    names = [unknown.name for unknown in together.unknowns]
    assert names[:5] == ["zero_1", "station_x_1", "station_y_1", "station_z_1", "zero_2"]
    assert names[-1] == "tool_x"
    for number, setup in enumerate(alone):
        single = Observation(model, (setup,))
        at = [names.index(u.name if u.name == "tool_x" else f"{u.name}_{number + 1}") for u in setup.unknowns]
        columns = [*range(model.size), *(model.size + k for k in at)]
        np.testing.assert_array_equal(rows[number][:, columns], single.numbers(places).rows)
        others = np.setdiff1d(np.arange(whole.size), columns)
        assert not rows[number][:, others].any()
        np.testing.assert_array_equal(shown[:, number], single.shown(0, poses, sides, point[columns])[:, 0])
        # what unknowns do is summed over those of all stations, in another order: rounding alone differs
        np.testing.assert_allclose(beyond[:, number], single.nonlinear_part(0, poses, sides)[:, 0], rtol=1e-14)


def test_all_of_them_have_to_see_the_tool() -> None:
    sight = 'range = ["0.4 m", "1.45 m"]\n'
    chart = built_in(TOGETHER + sight).setups[0].chart
    each = [built_in(one(number) + sight).setups[0].chart for number in range(3)]
    poses = np.random.default_rng(0).uniform(0.0, 0.4, (300, 3))
    assert isinstance(chart, Sight)
    seen = np.all([single.feasible(poses) for single in each if single is not None], axis=0)
    assert 20 < seen.sum() < 280
    np.testing.assert_array_equal(chart.feasible(poses), seen)


def test_readings_of_all_are_columns_in_the_order_of_the_stations(tmp_path: Path) -> None:
    description, path = built_in(TOGETHER + one(0)), tmp_path / "r.csv"
    assert columns_of(description.setups) == ["value_um", "value_1_um", "value_2_um", "value_3_um"]
    path.write_text("setup,X_mm,Y_mm,Z_mm,value_1_um,value_2_um,value_3_um\nbeams,100,200,50,1,-2,3\n")
    (reading,) = placed_readings(read_any(path), description, path)
    assert reading.values == pytest.approx((1e-6, -2e-6, 3e-6), rel=1e-12)
    (blank,) = blank_readings(description.setups[:1], [reading.place])
    assert len(blank.values) == 3


def test_what_nobody_says_is_that_of_each_tracer() -> None:
    unknowns = built_in(TOGETHER.replace(UNKNOWNS, "")).setups[0].unknowns
    assert Unknown("station_y_2", 5e-3) in unknowns
    assert len(unknowns) == 12
