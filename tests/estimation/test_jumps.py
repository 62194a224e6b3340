"""A zero that jumps is weighed as the dense density says, and named on machines that no model drew.."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from axiscal.campaign.agreement_words import agreement_words
from axiscal.estimation.estimate import estimated
from axiscal.estimation.promise import mistake
from axiscal.estimation.promise.change_point import jumped, suspects, ways_of
from axiscal.estimation.promise.posterior import sorted_out
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal_core.problem import Problem
from tests.generators.dense_posterior import Dense, log_density
from tests.generators.foreign_axis import DIAL, LASER, foreign_case, foreign_readings, named
from tests.generators.problems import asked, sized

JUMPS = 30.0, 1e3, 3e4


def _off(problem: Problem, since: int, by: float) -> Problem:
    """Return a problem whose first zero jumps by so many base noises of its set-up."""
    mine = problem.setup == 0
    noise = float(np.median(problem.noise[mine]))
    step = np.where(mine & (problem.reading >= since), by * noise, 0.0) / problem.noise
    return replace(problem, values=problem.values + step)


def _log_odds(problem: Problem, columns: Array, places: int, *, judged: bool = True) -> float:
    """Return the log odds of columns (k, m) beside none at the sizes as stated, 1 % over all places before.

    judged : with the causes of type B that judge readings
    """
    covariance, nought = Dense(problem).covariance(np.zeros(len(problem.sizes))), np.zeros(len(problem.values))
    causes = problem.type_b[:, problem.judging] * judged
    covariance = covariance + causes @ causes.T
    with_them = log_density(problem.values, nought, covariance + columns.T @ columns)
    return float(with_them - log_density(problem.values, nought, covariance) + np.log(0.01 / places))


@pytest.mark.parametrize("kind", ["axis", "two set-ups"])
def test_the_likeliest_jump_of_a_set_up_is_that_of_the_dense_density(kind: str) -> None:
    """Of sizes that are exact both weighings are one: in closed form, and by the evidence with the columns."""
    problem = _off(sized(asked(kind, 9 if kind == "axis" else 8, 5), ()), 4, 200.0)
    (found,) = (each for each in suspects(problem) if each.mistake.setups == (0,) and each.mistake.mistake == "jump")
    of = np.unique(problem.reading[problem.setup == 0])
    places = len(JUMPS) * len(of[2:-1])
    ways = ways_of(problem, problem.setup == 0) / problem.noise * float(np.median(problem.noise[problem.setup == 0]))
    each = {(s, r): _log_odds(problem, s * ways * (problem.reading >= r), places) for s in JUMPS for r in of[2:-1]}
    best = max(each, key=lambda key: each[key])
    assert found.mistake[2:4] == ((0,), best[1])
    assert found.prior == pytest.approx(np.log(0.01 / places))
    assert found.mistake.log_odds == pytest.approx(each[best], rel=1e-6)
    np.testing.assert_allclose(found.make().rows[:, : len(ways)].T, best[0] * ways * (problem.reading >= best[1]))
    known = jumped(problem)
    assert known is not None
    assert known.jumps == (found.mistake._replace(log_odds=known.log_odds),)
    alone = _log_odds(problem, found.make().rows[:, : len(ways)].T, places, judged=False)
    assert known.log_odds == pytest.approx(alone, rel=1e-6)


def test_the_likeliest_sign_of_a_stretch_is_that_of_the_dense_density() -> None:
    right = sized(asked("axis", 12, 5), ())
    off = replace(right, values=np.where(right.reading >= 7, -5, 5) * right.values)
    found = next(each for each in suspects(off) if each.mistake.mistake == "sign")
    wide, nought = Dense(off).judging(np.zeros(len(off.sizes))), np.zeros(len(off.values))
    turned = (np.where(off.reading >= since, -1, 1) * off.values for since in (*range(3, 10), 12))
    *gains, beside = (log_density(each, nought, wide) for each in turned)
    assert found.mistake.log_odds == pytest.approx(max(gains) - beside + found.prior, rel=1e-6)
    assert (found.mistake.reading, found.mistake.last) == (3 + int(np.argmax(gains)), -1) == (7, -1)


def test_of_many_places_the_likeliest_is_found_coarse_to_fine(monkeypatch: pytest.MonkeyPatch) -> None:
    """A few at once find the jump, the sign and the stretch between turns that all at once find."""
    right = sized(asked("axis", 60, 5), ())
    signed = replace(right, values=np.where(right.reading >= 37, -5, 5) * right.values)
    for wrong in (_off(right, 23, 200.0), signed):
        every = [each.mistake for each in suspects(wrong)]
        with monkeypatch.context() as few:
            few.setattr(mistake, "_AT_ONCE", 12)
            found = [each.mistake for each in suspects(wrong)]
        likely = max(every, key=lambda each: each.log_odds)
        assert likely.log_odds > 20
        (again,) = (each for each in found if each.mistake == likely.mistake)
        assert again._replace(log_odds=likely.log_odds) == likely
        assert again.log_odds == pytest.approx(likely.log_odds, rel=1e-9)


@pytest.mark.parametrize("since", [12, 13])
def test_a_ball_that_moves_is_a_jump_and_none_of_its_readings_is_bad(since: int) -> None:
    """Sixteen readings of a nest: the last ones stand 60 um off, as if some were bad; three of any time are bad."""
    problem = sized(asked("five axes", 16, 5), ())
    moved = np.array([50e-6, -30e-6, 20e-6])[np.arange(len(problem.values)) % 3] / problem.noise
    jumped = replace(problem, values=problem.values + np.where(problem.reading >= since, moved, 0.0))
    found = sorted_out(jumped)
    assert found.bad == {}
    assert found.posterior().agreement.explained[0][2:4] == ((0,), since)
    slips = replace(problem, values=problem.values + np.where(np.isin(problem.reading, [1, 5, 9]), 2 * moved, 0.0))
    assert set(sorted_out(slips).bad) == {1, 5, 9}


def _stepped(readings: Sequence[Reading], before: int, by: float) -> list[Reading]:
    return [replace(each, value=each.value + by * (i >= before)) for i, each in enumerate(readings)]


@pytest.mark.parametrize("setup", [DIAL, LASER], ids=["dial", "laser"])
@pytest.mark.parametrize(("count", "before"), [(28, 13), (15, 6), (9, 5)])
def test_a_zero_set_anew_by_140_um_is_named_where_it_was_and_never_agrees(setup: str, count: int, before: int) -> None:
    right = foreign_readings(setup, count, 1)
    assert named(estimated(foreign_case(setup), right)) == []
    known = estimated(foreign_case(setup), _stepped(right, before, 140e-6))
    assert named(known) == [("jump", before)]
    assert known.agreement.contradicts or count == 9  # of few readings odds of 20 to 1000 are a question
    assert f"before reading {before + 1}" in agreement_words(known)
    assert not known.left_out


def test_a_step_is_named_beside_a_bad_reading() -> None:
    readings = _stepped(foreign_readings(DIAL, 18, 1), 9, 140e-6)
    readings[3] = replace(readings[3], value=readings[3].value + 300e-6)
    assert named(estimated(foreign_case(DIAL), readings)) == [("jump", 9)]


def _out_and_back(setup: str, runs: int, step: float) -> list[Reading]:
    """Return readings out and back, a step less on every way back, m, as a display of 1 um shows them."""
    case, out = foreign_case(setup), np.linspace(0.05, 0.55, 9)
    park, name = case.description.setups[0].park[1:], case.description.setups[0].name
    places = [(float(x), 1 if run % 2 == 0 else -1) for run in range(runs) for x in out[:: 1 if run % 2 == 0 else -1]]
    values = [round(30e-6 * x - (step if side < 0 else 0.0), 6) for x, side in places]
    return [
        Reading(name, (x, *park), (side, 0), y, number=i + 1)
        for i, ((x, side), y) in enumerate(zip(places, values, strict=True))
    ]


@pytest.mark.parametrize(
    ("step", "asked_about"), [(3e-6, False), (7e-6, False), (20e-6, True), (60e-6, True), (200e-6, True)]
)
def test_a_step_where_the_axis_turned_is_named_unless_backlash_is_twenty_times_as_likely(
    step: float, asked_about: bool
) -> None:
    case, readings = foreign_case(LASER), _out_and_back(LASER, 2, step)
    known = estimated(case, readings)
    assert named(known) == [("jump", 9)] * asked_about
    assert all(each.backlash for each in known.agreement.explained)
    assert ("zero set anew, or backlash?" in agreement_words(known)) is (asked_about and step < 100e-6)
    sure = [replace(each, accepted=i == 9) for i, each in enumerate(readings)]
    told = estimated(case, sure)
    assert named(told) == []
    at = case.errors.by_name["EXX_reversal"].columns.start
    assert told.printed.belief.mean[at] == pytest.approx(-step, rel=0.05, abs=0.5e-6)
