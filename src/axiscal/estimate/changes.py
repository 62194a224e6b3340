"""Which curves have changed since the campaign whose result is the prior of this one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from axiscal.error_model.model import ErrorFunction
from axiscal.estimate.calibration import Calibration
from axiscal.estimate.case import Case
from axiscal.estimate.inheritance import last_calibration
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import chi_square_tail

_CHANCE = 6e-5
"""Probability of four standard deviations."""


@dataclass(frozen=True, slots=True)
class Change:
    """An error that has changed: by how much where it has most, beside its mean (m or rad).

    chance : probability of such a difference if it had not changed
    """

    name: str
    position: float
    size: float
    chance: float
    angular: bool
    rotary: bool


def changes(calibration: Calibration) -> Iterator[Change]:
    """Yield the errors whose readings then and now, each evaluated alone, do not agree.

    Both share the stated prior, so that their difference is less uncertain than the sum taken here: a change is missed
    rather than made up.
    """
    text = calibration.problem.description.prior_text
    if not text:
        return
    before, now = last_calibration(text), _alone(calibration)
    for function in now.problem.errors.functions:
        if function.name in before.problem.errors.names:
            change = _change(before, now, function)
            if change.chance < _CHANCE:
                yield change


def _alone(calibration: Calibration) -> Calibration:
    """Return what today's readings say without the last campaign."""
    alone = Calibration(Case(replace(calibration.problem.description, prior_text="")))
    for reading in calibration.readings:
        alone.absorb(reading)
    return alone.concluded()


def _change(before: Calibration, now: Calibration, function: ErrorFunction) -> Change:
    """Compare all control values together: what no reading tells, such as the constant, is wide and does not count."""
    axis = now.problem.errors.machine.axes[function.axis]
    knots = function.basis.control_positions
    (old, old_covariance), (new, new_covariance) = (
        _curve(each, each.problem.errors.names[function.name], knots) for each in (before, now)
    )
    difference = new - old
    chi_square = float(difference @ np.linalg.lstsq(old_covariance + new_covariance, difference)[0])
    beside = difference - difference.mean() if len(difference) > 1 else difference
    worst = int(np.argmax(np.abs(beside)))
    chance = chi_square_tail(len(difference), chi_square)
    return Change(function.name, float(knots[worst]), float(beside[worst]), chance, function.angular, axis.rotary)


def _curve(calibration: Calibration, function: ErrorFunction, positions: Array) -> tuple[Array, Array]:
    """Return mean (k,) and covariance (k, k) of an error at positions, its rest included."""
    rows = function.basis.rows(positions)
    factor = rows @ calibration.belief.factor[function.columns]
    covariance: Array = factor @ factor.T + function.rest**2 * np.eye(len(rows))
    return rows @ calibration.belief.mean[function.columns], covariance
