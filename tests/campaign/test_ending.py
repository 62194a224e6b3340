"""Whether an accuracy counts as reached where readings leave a gap between them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.campaign.ending import ONLY_STATED, out_of_reach, reaches, standing, unshown
from axiscal.description.target import Target
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.ruled import ruled, ruling_of
from axiscal.estimation.statements import Resting, Statement
from axiscal.measurement.reading import Reading
from axiscal.report.verdict import verdict_words
from axiscal.simulation import Simulator
from benchmarks.trust.benches import case_of, visits
from tests.generators.laser_axis import CASE, closed, machine, read


@pytest.fixture(scope="module")
def gapped() -> Estimation:
    """Return what is known from readings of which none was taken in a fifth of the travel."""
    taken = [each for each in read(machine(5), 28) if not 0.4 < each.pose[0] < 0.62]
    return ruled(concluded(CASE, closed(taken)))


def asked(rms: float, unchecked: bool = False) -> Target:
    """Return a target of so many m."""
    return replace(CASE.description.target, rms=rms, unchecked=unchecked)


def test_a_promise_that_a_gap_may_spoil_unseen_is_no_target_reached(gapped: Estimation) -> None:
    ruling = ruling_of(gapped)
    damage = max(each.damage for each in ruling.defence.departures if each.counted)
    size = (damage + ruling.defence.u_def) / 2
    between = asked(size)
    assert ruling.verdict == "unchecked"
    assert gapped.accuracy.rms < damage < size < ruling.defence.u_def
    found = standing(between, gapped)
    assert (found.reached, found.promised, found.vouched) == (None, "rms", ruling.defence.u_def)
    assert reaches(between, gapped) is False
    assert size < unshown(between, gapped) * gapped.accuracy.rms


def test_an_unchecked_promise_reaches_a_target_by_what_readings_vouch_for_or_where_that_is_allowed(
    gapped: Estimation,
) -> None:
    ruling = ruling_of(gapped)
    above, allowed = asked(1.01 * ruling.defence.u_def), asked(1.01 * gapped.accuracy.rms, unchecked=True)
    assert reaches(above, gapped) is True
    assert reaches(allowed, gapped) is True
    assert "A target counts as reached by what they can vouch for alone." in verdict_words(ruling, above)
    assert 'unchecked = "allow" is stated' in verdict_words(ruling, allowed)
    assert verdict_words(ruling, replace(above, rms=None)).endswith("could hardly have done so.")


def test_where_a_promise_rests_on_statements_alone_the_verdict_says_that(gapped: Estimation) -> None:
    """No more than 45 % of the variance: that is not most of it, and one machine in fifty is far worse."""
    ruling, plain = ruling_of(gapped), replace(CASE.description.target, rms=None)
    promise = ruling.defence.promise
    rests_on = Resting((Statement("EXX_reversal", "", 3e-6),), 0.45, 0.67 * promise, 0.055, 1.01 * promise)
    alone = replace(ruling, defence=replace(ruling.defence, departures=(), rests_on=rests_on).promising(promise))
    assert verdict_words(alone, plain).endswith("too much of what is promised rests on statements alone.")
    both = replace(ruling, defence=replace(ruling.defence, rests_on=rests_on))
    assert verdict_words(both, plain).endswith("could hardly have done so.")


@pytest.mark.parametrize(("raised", "told"), [(1.0, ""), (1.004, ""), (1.006, "1 %"), (1.18, "18 %")])
def test_a_promise_that_was_made_larger_is_said_with_how_much_where_that_can_be_printed(
    gapped: Estimation, raised: float, told: str
) -> None:
    ruling = replace(ruling_of(gapped), verdict="holds", raised=raised)
    words = verdict_words(ruling, CASE.description.target)
    assert words.startswith("Verdict: holds. The readings could have contradicted the model, and did not.")
    assert words.endswith(f"by uncertainties {told} larger than those of the model." if told else "did not.")


def test_whether_it_is_reached_is_the_same_before_and_after_the_verdict(gapped: Estimation) -> None:
    before = replace(gapped, ruling=None)
    for share in (0.6, 0.99, 1.01):
        target = asked(share * ruling_of(gapped).defence.u_def)
        assert standing(target, before) == standing(target, gapped)


@pytest.mark.long
def test_what_rests_on_statements_alone_ends_where_more_readings_would_not_mend_it() -> None:
    """A tool that nobody measured: 4 um are promised, 5.3 counted, and the last ten readings took 4 % off that."""
    case, rng = case_of("five axes", "stated", (("TOOL", "100 um"),)), np.random.default_rng(0)
    drawn, setup = Simulator(case.description.machine, case.description.setups).drawn(3), case.description.setups[0]
    taken = []
    for index, visit in enumerate(visits("five axes", "stated", "random", 60, 20_269_000)[:44]):
        first, *others = map(float, drawn.read_all(setup, *visit, rng))
        taken.append(Reading("it", *visit, first, others=tuple(others), time=60.0 * index))
    before, known = concluded(case, taken[:34]), concluded(case, taken)
    path = [before.accuracy] * 10 + [known.accuracy]

    def ended(rms: float, count: int | None = None) -> str | None:
        return out_of_reach(replace(case.description.target, rms=rms, readings=count), known, path)

    assert known.accuracy.seen < 4.2e-6
    assert ended(4.2e-6) == ONLY_STATED
    assert ended(5.0e-6) is None, "fifty more may reach it"
    assert ended(6.0e-6) is None, "it is reached"
    assert ended(3.0e-6) is None, "it is not even promised"
    assert ended(4.2e-6, 60) is None, "so many are wanted"
