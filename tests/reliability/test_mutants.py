"""What `make mutants` leaves alone, runs and says."""

from __future__ import annotations

import ast

import pytest
from scipy.stats import binomtest

from tests.reliability.mutants import PACKAGE, score, silent, steps_of


@pytest.mark.parametrize(("killed", "tried"), [(0, 10), (57, 60), (60, 60)])
def test_the_interval_of_a_score_is_wilsons(killed: int, tried: int) -> None:
    interval = binomtest(killed, tried).proportion_ci(method="wilson")
    assert score(killed, tried) == pytest.approx((killed / tried, interval.low, interval.high), abs=1e-6)


def test_types_and_decorators_are_left_alone_and_nothing_else() -> None:
    source = "@kept(1)\ndef f(a: int | None = 2) -> int | str:\n    b: list[3] = a | 4\n    return b"
    left = sorted(silent(ast.parse(source)))
    lines = source.splitlines()
    assert [lines[begin[0] - 1][begin[1] : end[1]] for begin, end in left] == [
        "kept(1)",
        "int | None",
        "int | str",
        "list[3]",
    ]


def test_tests_that_name_a_module_come_before_the_rest_of_its_room() -> None:
    named, rest = steps_of(PACKAGE / "numerics" / "waves.py")
    assert "tests/numerics/test_waves.py" in named
    assert "tests/numerics/test_cubic.py" in rest
    assert not set(named) & set(rest)
