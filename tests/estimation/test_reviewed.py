"""When all readings are weighed again: with each surprise while they are few, then as they grow by a tenth."""

from __future__ import annotations

from itertools import pairwise

from axiscal.estimation.reviewed import _due_before, _worth_a_look


def test_while_readings_are_few_every_surprise_counts() -> None:
    assert _worth_a_look(3, [0.1, 0.2, 2.5])
    assert not _worth_a_look(3, [0.1, 2.5, 0.2])
    assert _worth_a_look(200, [2.0])


def test_of_many_those_that_may_be_doubted_count_at_once_and_the_others_later() -> None:
    quiet = [0.5] * 1000
    assert _worth_a_look(211, [*quiet[:210], 3.6])
    assert not _worth_a_look(211, [*quiet[:210], 2.5])
    surprised = [*quiet[:205], 2.5, *quiet[206:]]
    looked = [count for count in range(201, 900) if _worth_a_look(count, surprised[:count])]
    assert looked == [220]


def test_the_looks_do_not_depend_on_where_one_begins_to_count() -> None:
    due = [count for count in range(1, 3000) if _due_before(count + 1) == count]
    assert due[:4] == [200, 220, 242, 266]
    assert all(1.09 < after / before < 1.12 for before, after in pairwise(due))
    assert len(due) < 35
