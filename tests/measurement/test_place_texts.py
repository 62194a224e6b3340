"""Places as sentences name them."""

from __future__ import annotations

from axiscal.measurement.reading import Reading, place_text, reading_text
from tests.planning.test_out_and_back import one_axis


def test_a_sentence_names_a_place_to_the_micrometre_and_an_answer_to_where_it_is_all_of_it() -> None:
    case, _ = one_axis()
    axes, setup = case.description.machine.axes, case.description.setups[0]
    reading = Reading(setup.name, (0.123456789,), (1,), 0.0)
    assert reading_text(axes, setup, reading, 6).endswith("at X = 123.457 mm")
    assert place_text(axes, reading.pose) == "X = 123.456789 mm"
