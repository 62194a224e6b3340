"""Which of both rooms a problem is solved in."""

from __future__ import annotations

from axiscal.estimate.numbers import Numbers
from axiscal.estimate.problem import MOST_NUMBERS, Problem
from axiscal.estimate.spaces import Space
from axiscal.estimate.unknowns import Unknowns


def space_of(problem: Problem) -> Space:
    """Return the room in which a problem costs less."""
    return Numbers(problem) if len(problem.values) <= MOST_NUMBERS else Unknowns(problem)
