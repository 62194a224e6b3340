"""An instrument that is sick is weighed as the dense density says, named, and put right."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from axiscal.campaign.agreement_words import acceptance, agreement_words
from axiscal.estimation.estimate import estimated
from axiscal.estimation.promise.slip import flickering
from axiscal.record.accepted import put_right
from tests.generators.foreign_axis import DIAL, LASER, foreign_case, foreign_readings

RIGHT = foreign_readings(LASER, 18, 4)
VALUES = [each.value for each in RIGHT]


@pytest.mark.parametrize("values", [[3.0, 3.2, 3.2, 3.0, 3.2], [2.0, 0.0, 1.0, 1.0], [0.0, 0.0, 0.0, 0.0]])
def test_digits_that_flicker_are_as_probable_as_throws_of_a_die_over_their_step(values: list[float]) -> None:
    """Anywhere is a thousand noises; a display of which one digit was seen has steps of a hundredth."""
    digits = len(set(values))
    step = (max(values) - min(values)) / (digits - 1) if digits > 1 else 0.01
    anywhere = norm.logpdf(values[0], scale=1e3) + np.log(step)
    wanted = anywhere - len(values) * np.log(digits * step / np.sqrt(2 * np.pi))
    assert flickering(np.array(values)) == pytest.approx(wanted, rel=1e-4)
    assert flickering(np.array([*values, 9.0, 30.0])) == -np.inf


SICK: dict[str, tuple[Callable[[list[float]], list[float]], str, list[float]]] = {
    "flickers": (lambda values: [1e-7 * (i % 2) for i in range(len(values))], "shows one value at all places", []),
    "late": (lambda values: [values[0], *values[:-1]], "belong to the place before or after", VALUES[:-1]),
    "early": (lambda values: [*values[1:], values[-1]], "belong to the place before or after", VALUES[1:]),
    "in mm": (lambda values: [value / 1000 for value in values], "times what they should be", VALUES),
}
"""What an instrument shows, what is said of it, and the values that are left when that is accepted."""


@pytest.mark.parametrize("how", SICK)
def test_what_is_sick_is_named_and_put_right(how: str) -> None:
    change, words, right = SICK[how]
    shown = [replace(each, value=value) for each, value in zip(RIGHT, change(VALUES), strict=True)]
    known = estimated(foreign_case(LASER), shown)
    assert words in agreement_words(known)
    mended = put_right(shown, acceptance(known.agreement.described or known.agreement.explained[0], known))
    assert [each.value for each in mended] == pytest.approx(right, rel=1e-9)


def test_a_noise_below_a_tenth_of_what_is_stated_is_a_contradiction() -> None:
    """The record is right, of a laser whose noise is stated thirty times too large."""
    found = estimated(foreign_case(LASER.replace('"0.3 um"', '"10 um"')), foreign_readings(LASER, 40, 4))
    assert found.agreement.withheld
    assert found.agreement.described is not None
    assert found.agreement.described.mistake == "noise"
    assert "of its stated noise. Check unit and display" in agreement_words(found)


@pytest.mark.long
@pytest.mark.parametrize("setup", [DIAL, LASER], ids=["dial", "laser"])
def test_right_records_are_not_called_sick(setup: str) -> None:
    found = [estimated(foreign_case(setup), foreign_readings(setup, 18, seed)).agreement for seed in range(8)]
    assert [each for each in found if each.explained or each.described] == []
