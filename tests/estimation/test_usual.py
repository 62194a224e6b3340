"""Which sizes vary, and the rough part that each curve has."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.description import sizes as model
from axiscal.description.sizes import DRIFT, LENGTH, NOISE, REST, REVERSAL, ROUGH, SURE
from axiscal.description.usual import Learnable, sizes_of, usual_machine
from axiscal.machine.entry import Sure
from tests.generators.problems import case_of, plain_case, sizes_for


def test_a_curve_has_a_rough_part_besides_its_rest() -> None:
    """Usual where nobody states a rest, else beside the stated one."""
    described = plain_case("plate").description
    machine = described.machine
    for before, after in zip(machine.errors, usual_machine(machine, described.setups).errors, strict=True):
        white = REST.size * before.std if before.rest is None else before.rest
        assert after.rest == pytest.approx(np.hypot(white, ROUGH.size * before.std))


def test_what_is_constant_stays_smooth() -> None:
    described = plain_case("five axes").description
    machine = described.machine
    pairs = list(zip(machine.errors, usual_machine(machine, described.setups).errors, strict=True))
    assert any(before.constant for before, _ in pairs)
    assert all(before == after for before, after in pairs if before.constant)


@pytest.mark.parametrize("kind", ["axis", "plate", "five axes", "two set-ups"])
def test_every_size_has_an_owner_and_no_two_the_same(kind: str) -> None:
    sizes = sizes_for(case_of(kind))
    owned = [(size.kind, owner) for size in sizes.of for owner in size.owners]
    assert len(owned) == len(set(owned)) > 0
    assert all(size.owners for size in sizes.of)
    assert all(size.spread > 0 for size in sizes.of)


def test_errors_that_are_alike_share_a_factor() -> None:
    """Positions of linear axes one, their angles another."""
    sizes = sizes_for(case_of("five axes"))
    assert sizes.index("std", "EXX") == sizes.index("std", "EYY") >= 0
    assert sizes.index("std", "EXX") != sizes.index("std", "EAX")
    assert sizes.index("std", "EXX") != sizes.index("std", "ECC")
    assert sizes.index("length", "EXX") == sizes.index("length", "EAX") >= 0


def test_each_setup_has_its_noise() -> None:
    sizes = sizes_for(case_of("two set-ups"))
    assert sizes.index("noise", "probe") != sizes.index("noise", "nest")
    assert sizes.index("drift", "probe") == sizes.index("drift", "nest") >= 0
    assert sizes.spreads[sizes.index("noise", "nest")] == pytest.approx(NOISE.spread)
    assert sizes.spreads[sizes.index("drift", "nest")] == pytest.approx(DRIFT.spread)


@pytest.mark.parametrize(("sure", "spread"), [("roughly", np.log(3.0)), ("well", np.log(1.5))])
def test_how_sure_somebody_is_is_the_spread(sure: Sure, spread: float) -> None:
    sizes = sizes_for(case_of("axis"), sure)
    assert sizes.spreads[sizes.index("std", "EXX")] == pytest.approx(spread)
    assert sizes.spreads[sizes.index("length", "EXX")] == pytest.approx(min(spread, LENGTH.spread))
    assert sizes.spreads[sizes.index("reversal", "EXX_reversal")] == pytest.approx(min(spread, REVERSAL.spread))
    assert np.log(SURE[sure]) == pytest.approx(spread)


def test_what_is_exact_and_not_usual_leaves_no_size() -> None:
    assert len(sizes_for(case_of("five axes"), "exactly", usual=False)) == 0


def test_one_error_may_be_known_and_another_not() -> None:
    described = case_of("plate").description
    errors = [replace(each, sure="exactly") if each.name == "EZX" else each for each in described.machine.errors]
    may = Learnable("roughly", usual=False, inherited=False)
    sizes = sizes_of(replace(described.machine, errors=tuple(errors)), described.setups, may)
    assert sizes.index("std", "EZX") == sizes.index("length", "EZX") == -1
    assert sizes.index("std", "EZY") >= 0


def test_an_inherited_prior_keeps_its_sizes() -> None:
    """Only rests, what passes, and noises vary then."""
    sizes = sizes_for(case_of("five axes"), inherited=True)
    assert {size.kind for size in sizes.of} == {"rest", "drift", "cycle", "growth", "way", "noise"}


def test_the_table_says_where_its_figures_come_from() -> None:
    causes = [each for each in vars(model).values() if isinstance(each, model.Cause)]
    assert len(causes) == len({cause.name for cause in causes}) == 13
    assert all(cause.source and cause.kernel and cause.size > 0 and cause.factor >= 1 for cause in causes)
