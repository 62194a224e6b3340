"""The lines of type B in the budget of uncertainty.

The posterior mean is linear in the readings, so one standard deviation of a cause, with the column b, moves it by G b.
With V the deviation of the tool over the volume the cause has the line |V G b|:

    m = G y,    G = P Hᵀ K⁻¹,    C = (1 − G H) P (1 − G H)ᵀ + G R Gᵀ + Σ (G b)(G b)ᵀ

The first two terms are the covariance of the same estimate with perfect instruments (Joseph's form, as in
`estimation.budget`), so the squares of these lines and of all others add up to the square of the whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from axiscal.estimate.problem import Problem
from axiscal.estimate.spaces import Given, turned
from axiscal.estimate.type_b import Contribution
from axiscal.numerics import Array


class Line(NamedTuple):
    """A line of the budget.  rms : m, what one standard deviation does to the tool over the volume"""

    cause: Contribution
    rms: float


def type_b_lines(problem: Problem, given: Given, causes: Sequence[Contribution], root: Array) -> list[Line]:
    """Return the line of each cause at one set of sizes.

    causes : of the readings that the problem was made of: their columns stand first in it
    root : V (r, n), root mean square deviation of the tool over the volume, of the first n answered unknowns
    """
    moved = root @ gain(problem, given, problem.rows[:, : len(causes)])[: root.shape[1]]
    return [Line(each, float(rms)) for each, rms in zip(causes, np.linalg.norm(moved, axis=0), strict=True)]


def gain(problem: Problem, given: Given, columns: Array) -> Array:
    """Return G times columns, (answered, q) m and rad: by what the mean moves if the numbers do.

    columns : (m, q) of the numbers, over the base noise
    """
    shown = turned(problem, problem.rows, given.theta, given.roots, problem.first)
    return problem.raw(shown.T @ given.precision(columns), given.theta, given.roots)
