"""An instrument that is sick is weighed as the dense density says and named; of right records hardly one is."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import simpson

from axiscal.campaign.agreement_words import acceptance, agreement_words
from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.estimate import estimated
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.promise.sick import flickering
from axiscal.record.accepted import put_right
from tests.generators.sick_records import JOBS, MILL, SICK, case_for, right_record, sick_record

NAMES = {
    "flicker": {"still"},
    "zeros": {"still", "stuck"},
    "late": {"shifted"},
    "early": {"shifted"},
    "stuck": {"stuck"},
    "repeated": {"stuck"},
    "in mm": {"unit", "still"},
}
"""What each may be called; a stuck display has zeros, too."""
SURE = {"flicker": 0.4, "zeros": 1.0, "late": 0.7, "early": 0.7, "stuck": 0.8, "repeated": 0.8, "in mm": 1.0}
"""Share named, at least: what is sick hides behind digits of two noises, and on a machine that is straight."""


def _named(job: str, seed: int, sick: str = "") -> str:
    """Return the likeliest mistake that is named of a record, "" for none."""
    readings = sick_record(job, seed, sick) if sick else right_record(job, seed)
    found = estimated(case_for(job), readings).agreement
    return found.described.mistake if found.described else next((each.mistake for each in found.explained), "")


def test_a_value_that_flickers_is_as_probable_as_the_integral_over_where_it_stands() -> None:
    """Anywhere is a thousand noises, and each of five flickers as probable as the others."""
    values, logs = np.array([3.0, 3.2, 2.9, 3.0, 3.1]), list[float]()
    for size in (1e-3, 1e-2, 0.1, 0.25, 0.6):
        mean, square = values.mean(), np.sum((values - values.mean()) ** 2)
        # about the mean, where the integrand is 1 but for where it may stand
        at = np.linspace(mean - 9 * size, mean + 9 * size, 2001)
        whole = simpson(np.exp(-2.5 * ((at - mean) / size) ** 2 - at**2 / 2e6), x=at)
        logs.append(np.log(whole / (1e3 * np.sqrt(2 * np.pi))) - square / (2 * size**2) - 5 * np.log(size))
    wanted = np.logaddexp.reduce(logs) - np.log(5)
    assert flickering(values, np.ones((1, 5))) == pytest.approx(wanted, rel=1e-6)


@pytest.mark.parametrize("job", JOBS)
def test_zeros_are_named(job: str) -> None:
    assert _named(job, 3, "zeros") in NAMES["zeros"]


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
def test_of_five_hundred_right_records_at_most_five_are_called_sick() -> None:
    found = [_named(job, seed) for job in JOBS for seed in range(100)]
    assert sum(each != "" for each in found) <= 5, found
