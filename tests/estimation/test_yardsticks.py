"""A yardstick is found once for all cases that it is the same for, and is then what each would find for itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.numerics.remembered import Memo
from axiscal.present.demo.five_axis import description

_STATED = Case(description())
_POINT = 1e-6 * np.random.default_rng(3).standard_normal(_STATED.errors.size + len(_STATED.observation.unknowns))


def _elsewhere(case: Case) -> Case:
    """Return the case about another machine, with the ball bar where that has it."""
    return case.linear_about(_POINT)


def _bent(case: Case) -> Case:
    return case.linear_about(_POINT, bent=True)


def _rougher(case: Case) -> Case:
    return case.rescaled({("rest", "EXX"): 5.0, ("std", "EXX"): 2.0, ("noise", case.description.setups[0].name): 3.0})


def _from_both_sides(case: Case) -> Case:
    quiet = tuple(replace(setup, approach="+") for setup in case.description.setups)
    there = replace(case, description=replace(case.description, setups=quiet))
    assert there.yardstick.unseen.shape == case.yardstick.unseen.shape
    return replace(there, both=frozenset([quiet[0].name]))


@pytest.mark.long
@pytest.mark.parametrize("made", [_elsewhere, _bent, _rougher, _from_both_sides])
def test_it_is_what_a_case_by_itself_finds(made: Callable[[Case], Case]) -> None:
    case = made(_STATED)
    alone = replace(case, yardsticks=Memo(), volumes=Memo())
    one, other = case.yardstick, alone.yardstick
    np.testing.assert_array_equal(one.unseen, other.unseen)
    np.testing.assert_array_equal(one.root.matrix, other.root.matrix)
    assert one.measure(case.prior) == pytest.approx(other.measure(alone.prior), rel=1e-14)
    assert one.zeroed == other.zeroed
    assert one.moments.rest == pytest.approx(other.moments.rest, rel=1e-14)


@pytest.mark.long
def test_cases_that_differ_only_in_where_readings_are_linear_share_one() -> None:
    mill = Case(replace(_STATED.description, setups=_STATED.description.setups[:1]))
    assert mill.linear_about(_POINT).yardstick is mill.yardstick
    assert _bent(mill).yardstick is not mill.yardstick
    assert _elsewhere(_STATED).yardstick.moments is _STATED.yardstick.moments
    assert _rougher(_STATED).yardstick.moments.gram is _STATED.yardstick.moments.gram
