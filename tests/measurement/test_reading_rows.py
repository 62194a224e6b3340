"""Rows of many readings at once, of mixed set-ups, against those of each reading alone; places in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading, place_text, reading_text
from axiscal.measurement.reading_rows import places_of, seen, visited
from tests.generators.campaigns import drawn, mixed
from tests.planning.test_out_and_back import one_axis


def visited_by(observation: Observation, readings: Sequence[Reading]) -> Observation:
    """Return the map with columns for what comes with readings."""
    return visited(observation, places_of(observation.setups, readings))


def _readings(count: int = 40) -> list[Reading]:
    """Readings of probes and a nest whose zeros wander, some with a std of their own, later from sides nobody told."""
    readings = drawn(mixed(), count)
    readings = [replace(r, approach=(1, 1, -1)) if i < count // 3 else r for i, r in enumerate(readings)]
    return [replace(r, std=4e-6) if i % 5 == 0 else r for i, r in enumerate(readings)]


def test_a_map_is_widened_by_all_readings_as_by_each() -> None:
    readings, one_by_one = _readings(), mixed().observation
    for reading in readings:
        one_by_one = visited_by(one_by_one, [reading])
    together = visited_by(mixed().observation, readings)
    assert together.size > mixed().observation.size
    assert together.cells == one_by_one.cells
    assert visited_by(together, readings) is together


def test_numbers_of_all_readings_are_those_of_each_in_order() -> None:
    readings = _readings()
    for observation in (mixed().observation, visited_by(mixed().observation, readings)):
        together = seen(observation, readings)
        np.testing.assert_array_equal(together.reading, np.repeat(np.arange(40), [len(r.values) for r in readings]))
        for i, reading in enumerate(readings):
            alone, mine = seen(observation, [reading]), together.reading == i
            np.testing.assert_allclose(together.rows[mine], alone.rows, rtol=1e-12, atol=1e-15)
            np.testing.assert_allclose(together.variances[mine], alone.variances, rtol=1e-12)
            np.testing.assert_allclose(together.values[mine], alone.values, rtol=1e-12)


def test_a_sentence_names_a_place_to_the_micrometre_and_an_answer_to_where_it_is_all_of_it() -> None:
    case, _ = one_axis()
    axes, setup = case.description.machine.axes, case.description.setups[0]
    reading = Reading(setup.name, (0.123456789,), (1,), 0.0)
    assert reading_text(axes, setup, reading, 6).endswith("at X = 123.457 mm")
    assert place_text(axes, reading.pose) == "X = 123.456789 mm"
