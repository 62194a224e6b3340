"""An instrument that is sick is weighed as the dense density says and named; of right records hardly one is."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm

from axiscal.campaign.agreement_words import acceptance, agreement_words
from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.estimate import estimated
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.promise.sick import flickering
from axiscal.record.accepted import put_right
from tests.generators.sick_records import JOBS, MILL, SICK, case_for, right_record, sick_record

NAMES = {
    "flicker": {"still", "stuck"},
    "zeros": {"still", "stuck"},
    "late": {"shifted"},
    "early": {"shifted"},
    "stuck": {"stuck"},
    "repeated": {"stuck"},
    "in mm": {"unit", "still", "noise"},
}
"""What each may be called; a stuck display has zeros, too, and of a noise too small one is told to check the unit."""
SURE = {"flicker": 0.82, "zeros": 1.0, "late": 0.78, "early": 0.76, "stuck": 0.86, "repeated": 0.86, "in mm": 1.0}
"""Share named, at least. Who knows how they are drawn has odds above 20 in 45, 50, 43, 44, 49 and 45 of 50."""


def _named(job: str, seed: int, sick: str = "") -> str:
    """Return the likeliest mistake that is named of a record, "" for none."""
    readings = sick_record(job, seed, sick) if sick else right_record(job, seed)
    found = estimated(case_for(job), readings).agreement
    return found.described.mistake if found.described else next((each.mistake for each in found.explained), "")


@pytest.mark.parametrize("values", [[3.0, 3.2, 3.2, 3.0, 3.2], [2.0, 0.0, 1.0, 1.0], [0.0, 0.0, 0.0, 0.0]])
def test_digits_that_flicker_are_as_probable_as_throws_of_a_die_over_their_step(values: list[float]) -> None:
    """Anywhere is a thousand noises; a display of which one digit was seen has steps of a hundredth."""
    digits = len(set(values))
    step = (max(values) - min(values)) / (digits - 1) if digits > 1 else 0.01
    anywhere = norm.logpdf(values[0], scale=1e3) + np.log(step)
    wanted = anywhere - len(values) * np.log(digits * step / np.sqrt(2 * np.pi))
    assert flickering(np.array(values)) == pytest.approx(wanted, rel=1e-4)
    assert flickering(np.array([*values, 9.0, 30.0])) == -np.inf


def test_a_display_that_flickers_is_asked_about_and_left_out() -> None:
    known = estimated(case_for("dial"), shown := sick_record("dial", 0, "flicker"))
    assert "shows one value at all places" in agreement_words(known)
    assert put_right(shown, acceptance(known.agreement.explained[0], known)) == []


@pytest.mark.parametrize("job", ["laser", "square"])
def test_lines_that_are_one_late_are_put_right(job: str) -> None:
    """The values that are accepted are those of the right record, but for the last one, which was never written."""
    late = sick_record(job, 4, "late")
    known = estimated(case_for(job), late)
    assert [each.mistake for each in known.agreement.explained] == ["shifted"]
    assert "belong to the place before or after" in agreement_words(known)
    mended = put_right(late, acceptance(known.agreement.explained[0], known))
    assert [each.value for each in mended] == [each.value for each in right_record(job, 4)[:-1]]


def test_values_in_mm_are_put_right() -> None:
    known = estimated(case_for("square"), small := sick_record("square", 4, "in mm"))
    assert known.agreement.contradicts
    mended = put_right(small, acceptance(known.agreement.explained[0], known))
    right = [each.value for each in right_record("square", 4)]
    assert [each.value for each in mended] == pytest.approx(right, rel=1e-9)


def test_a_noise_below_a_tenth_of_what_is_stated_is_a_contradiction() -> None:
    """The record is right, of a laser whose noise is stated thirty times too large."""
    text = JOBS["laser"].text.replace("approach", 'noise = "10 um"\napproach')
    stated = case_of(campaign_from_texts(f'machine = "m"\n[target]\nreadings = 40\n{text}', "c.toml", MILL, "m"))
    found = estimated(stated, right_record("laser", 2))
    assert found.agreement.withheld
    assert found.agreement.described is not None
    assert found.agreement.described.mistake == "noise"
    assert "of its stated noise. Check unit and display" in agreement_words(found)


@pytest.mark.long
@pytest.mark.parametrize("sick", SICK)
def test_most_sick_records_are_named(sick: str) -> None:
    found = [_named(job, seed, sick) for job in JOBS for seed in range(10)]
    assert np.mean([each in NAMES[sick] for each in found]) >= SURE[sick], found


@pytest.mark.long
def test_of_a_hundred_right_records_at_most_one_is_called_sick() -> None:
    found = [_named(job, seed) for job in JOBS for seed in range(20)]
    assert sum(each != "" for each in found) <= 1, found
