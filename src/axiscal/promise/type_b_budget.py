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

from axiscal.numerics import Array
from axiscal.promise.problem import Problem
from axiscal.promise.spaces import Given, turned
from axiscal.promise.type_b_columns import Contribution


class TypeBLine(NamedTuple):
    """A line of the budget.  rms : m, what one standard deviation does to the tool over the volume"""

    cause: Contribution
    rms: float


def type_b_lines(problem: Problem, given: Given, causes: Sequence[Contribution], root: Array) -> list[TypeBLine]:
    """Return the line of each cause at one set of sizes.

    causes : of the readings that the problem was made of
    root : V (r, n), root mean square deviation of the tool over the volume, of the first n answered unknowns
    """
    columns = np.array([each.column for each in causes]).reshape(-1, len(problem.noise)).T
    moved = root @ gain(problem, given, columns / problem.noise[:, None])[: root.shape[1]]
    return [TypeBLine(each, float(rms)) for each, rms in zip(causes, np.linalg.norm(moved, axis=0), strict=True)]


def gain(problem: Problem, given: Given, columns: Array) -> Array:
    """Return G times columns, (answered, q) m and rad: by what the mean moves if the numbers do.

    columns : (m, q) of the numbers, over the base noise
    """
    shown = turned(problem, problem.rows, given.theta, given.roots, problem.first)
    return problem.raw(shown.T @ given.precision(columns), given.theta, given.roots)
