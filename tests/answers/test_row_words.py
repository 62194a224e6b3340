"""Numbers with their signs in words, in both languages."""

from __future__ import annotations

import pytest

from axiscal.answers.answer import SignedNumber
from axiscal.answers.row_words import signed_text
from axiscal.description.target import RowName
from axiscal.language.spoken import speaking
from axiscal.machine import load_machine
from tests.generators.answers import answer_row

FIVE = load_machine("dmu60")


def _text(row: RowName, *numbers: tuple[str, float, float], times: int = 1) -> str:
    signed = [SignedNumber(direction=name, value=value, U=u) for name, value, u in numbers]
    return signed_text([answer_row(row, FIVE).model_copy(update={"signed": signed})] * times)


CENTRE, SQUARE = RowName("centre", ("B",)), RowName("squareness", ("X", "Y"))


@pytest.mark.parametrize(
    ("value", "u", "shown"),
    [
        (43.21, 10.4, "+43 urad"),
        (-43.21, 9.4, "−43 urad"),
        (3.04, 0.92, "+3.0 urad"),
        (-0.2, 5.1, "0 urad"),
        (1214.3, 3.4, "+1214 urad"),
        (1214.3, 143.0, "+1210 urad"),
        (1.2345, 0.023, "+1.234 urad"),
        (0.0, 0.0, "0 urad"),
    ],
)
def test_a_number_ends_where_it_is_known(value: float, u: float, shown: str) -> None:
    assert _text(SQUARE, ("XY", value, u)) == shown


def test_a_vector_names_its_directions_each_with_its_own_uncertainty() -> None:
    vector = ("Y", 121.3, 3.2), ("Z", -69.4, 3.1)
    assert _text(CENTRE, *vector) == "Y +121 ± 3, Z −69 ± 3 um"
    with speaking("de"):
        assert _text(CENTRE, ("Y", 12.13, 0.32), ("Z", -6.94, 0.31)) == "Y +12,1 ± 0,3, Z −6,9 ± 0,3 um"
    assert _text(CENTRE, *vector, times=2) == "Y +121, Z −69; Y +121, Z −69 um"


def test_the_one_number_of_a_vector_that_some_error_makes_is_named() -> None:
    assert _text(RowName("tilt", ("B",)), ("C", -9.7, 27.5)) == "C −10 urad"
