"""Plans for rows: J sums their variances over what each is to be known to, and a plan ends where all are reached."""

from __future__ import annotations

import numpy as np

from axiscal.estimation.accuracy.criterion import Gram, Root
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.case import Case
from axiscal.estimation.functionals.asked import AskedRow, asked_rows
from axiscal.estimation.functionals.known import known_row
from axiscal.numerics import Array

_VOLUME = 0.5
"""Of U before the first reading: a volume without a limit weighs as a row without one."""


def rows_root(case: Case) -> Root:
    """Return V of J = Σ v / g², v the mean variance of a row and g its standard deviation where it is as wanted."""
    parts = [np.zeros((0, case.errors.size))]
    for asked in asked_rows(case.description, (), whole=True):
        row = known_row(asked, case, case.prior, read=False)
        goal = row.goal if asked.map is not None else min(row.goal, _VOLUME * row.before)
        if goal > 0:
            parts.append(_own(asked, case) * BAND / goal)
    stacked = np.concatenate(parts)
    return Gram(stacked.T @ stacked).root


def _own(asked: AskedRow, case: Case) -> Array:
    """Return V of the mean variance of a row, (k, size)."""
    if asked.map is None:
        return case.yardstick.root.matrix
    scaled: Array = asked.map.rows(case.errors) / np.sqrt(len(asked.map.weights) / asked.map.dimensions)
    return scaled
