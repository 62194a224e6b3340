"""What has changed on a machine since its last campaign, error by error."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.inheritance import last_estimation
from axiscal.numerics import Array
from axiscal_core.from_scipy import chi_square_tail
from axiscal_core.terms import Term

_CHANCE = 6e-5
"""Probability of four standard deviations."""


@dataclass(frozen=True, slots=True)
class Change:
    """An error that has changed: where it has most, and by how much, its mean apart (m or rad).

    chance : probability of such a difference if it had not changed
    """

    name: str
    position: float
    size: float
    chance: float
    angular: bool
    rotary: bool


def changes(estimation: Estimation) -> Iterator[Change]:
    """Yield the errors whose readings then and now, each evaluated alone, do not agree.

    Both share the stated prior, so that their difference is less uncertain than the sum taken here: a change is missed
    rather than made up.
    """
    text = estimation.case.description.prior_text
    if not text:
        return
    before = last_estimation(text)
    now = concluded(Case(replace(estimation.case.description, prior_text="")), estimation.readings)
    for function in now.case.errors.curves:
        if function.name in before.case.errors.by_name:
            change = _change(before, now, function)
            if change.chance < _CHANCE:
                yield change


def _change(before: Estimation, now: Estimation, function: Term) -> Change:
    """Compare all control values together: an unobservable part, such as the constant, is wide and does not count."""
    axis = now.case.errors.axes[function.axis]
    knots = function.spline.control_positions
    (old, old_covariance), (new, new_covariance) = (
        _curve(each, each.case.errors.by_name[function.name], knots) for each in (before, now)
    )
    difference = new - old
    chi_square = float(difference @ np.linalg.lstsq(old_covariance + new_covariance, difference)[0])
    beside = difference - difference.mean() if len(difference) > 1 else difference
    worst = int(np.argmax(np.abs(beside)))
    chance = chi_square_tail(len(difference), chi_square)
    return Change(function.name, float(knots[worst]), float(beside[worst]), chance, function.angular, axis.rotary)


def _curve(known: Estimation, function: Term, positions: Array) -> tuple[Array, Array]:
    """Return mean (k,) and covariance (k, k) of an error at positions, its rest included."""
    rows = function.spline.rows(positions)
    factor = rows @ known.printed.belief.factor[function.columns]
    covariance: Array = factor @ factor.T + function.rest**2 * np.eye(len(rows))
    return rows @ known.printed.belief.mean[function.columns], covariance
