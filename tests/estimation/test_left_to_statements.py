"""What single unknowns leave of a promise, on small matrices: against drawn machines and all subsets written out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import pytest
from axiscal.accuracy.damage import KAPPA
from axiscal.estimation.statements import LeftOpen, Resting, Single, Statement, resting

CONSTANT = 0.4e-12
"""m²: of what is left, what hardly varies."""
APART = ("tool_x", "tool_y", "growth")
FIXED = ("X0B", "Z0B", "centre_x")


@dataclass(frozen=True)
class Left:
    """What is left of single unknowns by their names, sizes of their fields in um beside 1 um of all else."""

    names: Sequence[str]
    sizes: Sequence[float]
    seen: float = 0.0
    beside: float = 1.0

    @property
    def open(self) -> LeftOpen:
        """The same as fields over eight numbers, each in a direction of its own where readings show none of them."""
        count, rng = len(self.names), np.random.default_rng(3)
        fields = np.linalg.qr(rng.standard_normal((8, 8)))[0][:, :count] * np.array(self.sizes) * 1e-6
        shares = np.array([3.0, 3.0, 2.0, 2.0, 2.0, 2.0, 1.0, 1.0]) / 16
        beside = (self.beside * 1e-6) ** 2 * np.diag(shares)
        return LeftOpen(fields, beside, self.seen * np.eye(count))

    def rested(self, promise: float, constant: float = CONSTANT) -> Resting | None:
        """Return what a promise, m, rests on."""
        left = self.open
        remaining = constant + float(np.trace(left.beside)) + float(np.sum(left.fields**2))
        singles = [Single(Statement(name, "", 1e-6), np.zeros(1)) for name in self.names]
        return resting(singles, left, remaining, promise)


def spoilt(left: LeftOpen, promise: float, constant: float = CONSTANT) -> float:
    """Return the share of 200,000 drawn machines that are far worse than promised for their single unknowns."""
    rng, count = np.random.default_rng(1), 200_000
    others = np.sqrt(np.diag(left.beside))[:, None] * rng.standard_normal((8, count))
    single = left.fields @ rng.standard_normal((left.fields.shape[1], count))
    truth, known = (np.sqrt(constant + np.sum(each**2, axis=0)) for each in (others + single, others))
    return float(np.mean(truth > KAPPA * promise) - np.mean(known > KAPPA * promise))


@pytest.mark.parametrize("sizes", [(1.5,), (0.9, 0.5), (0.8, 0.7, 0.6, 0.5)])
def test_share_and_least_promise_are_those_of_drawn_machines(sizes: tuple[float, ...]) -> None:
    left = Left(("X0B", "Z0B", "tool_x", "tool_y")[: len(sizes)], sizes)
    for times in (1.0, 1.2):
        promise = times * float(np.sqrt(CONSTANT + (1 + sum(np.square(sizes))) * 1e-12))
        found = left.rested(promise)
        assert found is not None
        assert found.hidden == pytest.approx(spoilt(left.open, promise), abs=0.004)
        assert spoilt(left.open, found.bearable) == pytest.approx(0.02, abs=0.004)
        effect = float(np.sum(np.square(sizes))) * 1e-12
        assert found.effect**2 == pytest.approx(effect, rel=1e-9)
        assert found.share == pytest.approx(effect / (CONSTANT + 1e-12 + effect), rel=1e-9)


def test_what_a_promise_can_bear_does_not_depend_on_the_promise() -> None:
    left = Left(("X0B", "tool_x"), (1.2, 0.3))
    bearable = {found.bearable for promise in (0.5e-6, 1e-6, 5e-6) if (found := left.rested(promise)) is not None}
    assert len(bearable) == 1
    found = left.rested(next(iter(bearable)))
    assert found is not None
    assert found.hidden == pytest.approx(0.02, abs=2e-4)


def test_a_single_unknown_alone_is_borne_where_a_normal_is_beyond_in_one_of_fifty() -> None:
    """Nothing else is left, so that the truth is |z| of its field: P(|z| > 2.326) = 0.02."""
    found = Left(("X0B",), (1.0,), beside=0.0).rested(1e-6, 0.0)
    assert found is not None
    assert found.bearable == pytest.approx(2.3263e-6 / KAPPA, rel=0.01)
    assert found.share == pytest.approx(1.0)


def test_small_statements_spoil_no_promise() -> None:
    found = Left(("X0B",), (0.05,)).rested(1e-6)
    assert found is not None
    assert found.bearable == 0.0
    assert found.hidden < 0.02
    assert Left(("X0B",), (0.0,)).rested(1e-6) is None


@pytest.mark.parametrize(
    "sizes", [(3.0, 1.0, 1.0), (1.0, 1.1, 1.05), (0.5, 0.1, 2.0), (1.0, 1.0, 1.0), (0.1, 0.2, 0.15)]
)
def test_named_are_the_fewest_that_make_half_of_it(sizes: tuple[float, ...]) -> None:
    found = Left(FIXED, sizes).rested(1e-6)
    assert found is not None
    squares = dict(zip(FIXED, np.square(sizes).tolist(), strict=True))
    half = 0.5 * sum(squares.values()) * (1 - 1e-9)
    enough = next(n for n in (1, 2, 3) if any(sum(squares[i] for i in some) >= half for some in combinations(FIXED, n)))
    named = [each.name for each in found.named]
    assert len(named) == enough
    assert sum(squares[name] for name in named) >= half
    assert [squares[name] for name in named] == sorted((squares[name] for name in named), reverse=True)


@pytest.mark.parametrize(
    ("names", "sizes", "shown_by"),
    [
        (("tool_x", "X0B", "Z0B"), (2.0, 0.5, 0.5), ["tool_x"]),
        (("tool_x", "X0B", "tool_y"), (1.0, 0.1, 1.1), ["tool_y"]),
        (("tool_x", "tool_y", "growth"), (1.0, 1.1, 1.2), ["growth", "tool_y"]),
        (("tool_x", "X0B", "growth"), (0.5, 2.0, 0.5), []),
        (("X0B", "Z0B", "centre_x"), (2.0, 0.5, 0.5), []),
    ],
    ids=["one does", "the larger does", "two do", "what can be measured is little", "none can be measured"],
)
def test_what_would_show_it_can_be_measured_apart_and_takes_more_than_half(
    names: tuple[str, ...], sizes: tuple[float, ...], shown_by: list[str]
) -> None:
    found = Left(names, sizes).rested(1e-6)
    assert found is not None
    assert [each.name for each in found.shown_by] == shown_by


def test_readings_that_know_an_unknown_with_others_make_its_exact_value_worth_more() -> None:
    """Of two unknowns of which readings know the sum, an exact value of one tells the other as well."""
    names, sizes = ("tool_x", "X0B"), (1.0, 1.0)
    apart = Left(names, sizes).open
    field = apart.fields[:, 0]
    tied = LeftOpen(np.column_stack([field, -field]), apart.beside, 0.5 * np.ones((2, 2)))
    singles = [Single(Statement(name, "", 1e-6), np.zeros(1)) for name in names]
    found = resting(singles, tied, 5e-12, 1e-6)
    assert found is not None
    assert [each.name for each in found.shown_by] == ["tool_x"]
    untied = resting(singles, apart, 5e-12, 1e-6)
    assert untied is not None
    assert untied.shown_by == ()
