"""How linear the machine is that the readings show: a bound for the tool point, and the index of the worst reading."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.errors.linear_bound import linear_along, linear_to
from axiscal.errors.model import ErrorModel, Term
from axiscal.errors.volume import Box
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.located import GAUSSIAN, indices
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread

_SPREAD, _POSITIONS = 2.0, 25
"""Bands of 95 %, looked at so many times along each axis: a curve bends little between two of them."""
_SURE = 0.1
"""Share of the index above which the posterior is no Gaussian: where a bound is below it, nothing is drawn."""


class Linearity(NamedTuple):
    """bound : m, no machine within the 95 % bands differs by more from its first order at the tool, along the
        directions that count

    largest : the largest ν of a reading, or a bound on it; reading : its number
    """

    bound: float
    largest: float
    reading: int | None

    @property
    def gaussian(self) -> bool:
        """Whether the belief is the posterior to the digits printed."""
        return self.largest <= GAUSSIAN


@one_thread()
def linearity(estimation: Estimation) -> Linearity:
    """Return how linear machine and readings are."""
    case, known = estimation.case, estimation.stages.absorbed
    box, errors, belief = case.description.target.volume, case.errors, known.knowledge.belief
    bound = linear_along(errors, _sizes(errors, belief.mean, belief.factor, box), box, case.description.target.counted)
    finest = min((setup.noise for setup in case.description.setups), default=np.inf)
    left = _beyond(errors, belief.mean, belief.factor, box) / finest
    if left < _SURE * GAUSSIAN and not case.bends:
        return Linearity(bound, left, None)
    found = indices(known, estimation.readings)
    if not len(found):
        return Linearity(bound, 0.0, None)
    worst = int(np.argmax(found))
    return Linearity(bound, float(found[worst]), estimation.readings[worst].numbered(worst))


def _beyond(errors: ErrorModel, mean: Array, factor: Array, box: Box) -> float:
    """Return what the exact chain does more, m, than the rows of the nominal machine say of a step off the mean.

    B is the bound as a function of sizes, m those of the mean and d those of what is left open. The step makes B(m + d)
    − B(m), squares of d and products of m with d. Every term of B is a product of sizes, so it grows as fast as the
    chain can.
    """
    centre = _sizes(errors, mean, np.zeros_like(factor), box, rests=False)
    spread = _sizes(errors, np.zeros(errors.size), factor, box)
    return linear_to(errors, centre + spread, box) - linear_to(errors, centre, box)


def _sizes(errors: ErrorModel, mean: Array, factor: Array, box: Box, rests: bool = True) -> Array:
    """Return what no term exceeds within its band of 95 % over the volume, (terms,), m or rad."""
    return np.array([_size(term, mean, factor, box, term.rest if rests else 0.0) for term in errors.terms])


def _size(term: Term, mean: Array, factor: Array, box: Box, rest: float) -> float:
    sides = [np.linspace(*box[axis], _POSITIONS) for axis in term.axes]
    at = sides[0] if len(sides) == 1 else np.stack([side.ravel() for side in np.meshgrid(*sides)], axis=1)
    rows = term.rows(at)
    std = np.sqrt(np.sum((rows @ factor[term.columns]) ** 2, axis=1) + rest**2)
    return float(np.max(np.abs(rows @ mean[term.columns]) + _SPREAD * std))
