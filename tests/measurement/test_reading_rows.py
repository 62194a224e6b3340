"""Rows of many readings at once, of mixed set-ups, against those of each reading alone; places in words."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from axiscal.measurement.reading import Reading, place_text, reading_text
from axiscal.measurement.reading_rows import seen
from tests.generators.campaigns import drawn, mixed
from tests.planning.test_out_and_back import one_axis


def _readings(count: int = 40) -> list[Reading]:
    """Readings of probes and a nest whose zeros wander, some with a std of their own, later from sides nobody told."""
    readings = drawn(mixed(), count)
    readings = [replace(r, approach=(1, 1, -1)) if i < count // 3 else r for i, r in enumerate(readings)]
    return [replace(r, std=4e-6) if i % 5 == 0 else r for i, r in enumerate(readings)]


def test_numbers_of_all_readings_are_those_of_each_in_order() -> None:
    readings, observation = _readings(), mixed().observation
    together, values = seen(observation, readings)
    np.testing.assert_array_equal(together.place, np.repeat(np.arange(40), [len(r.values) for r in readings]))
    for i, reading in enumerate(readings):
        (alone, own), mine = seen(observation, [reading]), together.place == i
        np.testing.assert_allclose(together.rows[mine], alone.rows, rtol=1e-12, atol=1e-15)
        np.testing.assert_allclose(together.noise[mine], alone.noise, rtol=1e-12)
        np.testing.assert_allclose(values[mine], own, rtol=1e-12)


def test_a_sentence_names_a_place_to_the_micrometre_and_an_answer_to_where_it_is_all_of_it() -> None:
    case, _ = one_axis()
    axes, setup = case.description.machine.axes, case.description.setups[0]
    reading = Reading(setup.name, (0.123456789,), (1,), 0.0)
    assert reading_text(axes, setup, reading, 6).endswith("at X = 123.457 mm")
    assert place_text(axes, reading.pose) == "X = 123.456789 mm"
