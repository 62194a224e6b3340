"""When all readings are weighed again: with each surprise while they are few, then as they grow by a tenth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from axiscal.estimation.reviewed import _due_before, _worth_a_look, reviewed

from axiscal.estimation.absorbed import Absorbed, absorbed
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.estimation.learnt import weighed
from axiscal.inference.outliers import Doubt
from axiscal.measurement.reading import Reading
from tests.generators.laser_axis import CASE, machine, read

FIRST = {31: 4e-5, 118: -3e-5}
LATER = {207: 2e-5, 231: 2e-5, 246: -5e-5}
"""By how much which readings are wrong, m."""


def _wrong(readings: Sequence[Reading], slips: Mapping[int, float]) -> tuple[Reading, ...]:
    return tuple(replace(each, value=each.value + slips.get(i, 0.0)) for i, each in enumerate(readings))


def _as_if_alone(case: Case, readings: Sequence[Reading]) -> Absorbed:
    """Return what is known where all are weighed again after each reading that surprises: the naive way."""
    known, implausible = Absorbed.nothing(case), dict[int, Doubt]()
    for count in range(1, len(readings) + 1):
        known = absorbed(known, readings[:count], implausible)
        if known.innovations[-1].chi_square < 4.0:
            continue
        found = weighed(known.case, readings[:count], implausible)
        if found.fates != known.verdict.fates:
            known = absorbed(Absorbed.nothing(known.case, found), readings[:count], implausible)
    return known


def test_while_readings_are_few_every_surprise_counts() -> None:
    assert _worth_a_look(3, 2.5)
    assert not _worth_a_look(3, 0.2)
    assert _worth_a_look(200, 2.0)


def test_of_many_those_that_may_be_doubted_count_at_once() -> None:
    assert _worth_a_look(211, 3.6)
    assert not _worth_a_look(211, 2.5)


def test_all_are_weighed_again_each_time_they_have_grown_by_a_tenth() -> None:
    due = [count for count in range(1, 3000) if _due_before(count + 1) == count]
    assert due[:4] == [200, 220, 242, 266]
    assert all(1.09 < after / before < 1.12 for before, after in pairwise(due))
    assert len(due) < 35


@pytest.mark.parametrize("slips", [{}, FIRST, LATER, FIRST | LATER])
def test_the_verdicts_are_those_of_a_look_after_every_surprise(slips: Mapping[int, float]) -> None:
    readings = _wrong(read(machine(3), 250), slips)
    known, naive = reviewed(Absorbed.nothing(CASE), readings, {}), _as_if_alone(CASE, readings)
    assert known.verdict.fates == naive.verdict.fates
    assert {index for index, _ in known.verdict.fates} >= {*slips}
    std = np.sqrt(np.diagonal(naive.knowledge.belief.covariance))
    assert float(np.max(np.abs(known.knowledge.belief.mean - naive.knowledge.belief.mean) / std)) < 0.5


@pytest.mark.long
def test_readings_that_came_together_say_what_they_say_one_by_one() -> None:
    readings = _wrong(read(machine(3), 250), FIRST | LATER)
    together = estimated(CASE, readings)
    grown = estimated(CASE, readings[:190])
    for count in range(191, len(readings) + 1):
        grown = estimated(CASE, readings[:count], grown)
    one, other = (each.stages.absorbed for each in (together, grown))
    assert one.verdict.fates == other.verdict.fates
    np.testing.assert_allclose(one.verdict.weights, other.verdict.weights, rtol=1e-9)
    std = np.sqrt(np.diagonal(other.knowledge.belief.covariance))
    np.testing.assert_allclose(one.knowledge.belief.mean / std, other.knowledge.belief.mean / std, rtol=0, atol=1e-7)


def test_what_was_known_before_the_last_look_at_all_is_not_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = list[int]()

    def counted(of: Case, those: Sequence[Reading], implausible: Mapping[int, Doubt]) -> object:
        asked.append(len(those))
        return weighed(of, those, implausible)

    monkeypatch.setattr("axiscal.estimation.reviewed.weighed", counted)
    reviewed(Absorbed.nothing(CASE), read(machine(3), 250), {})
    assert asked[0] == 242
    assert len(asked) <= 2
