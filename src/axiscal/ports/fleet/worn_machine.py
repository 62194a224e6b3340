"""A machine that runs on with the tables of its last campaign: its deviations after a time.

The tool point is off by H (a' − m) + ℓ and the rests. Its errors after Δt are a' below. The tables could not
hold ℓ on the day of the campaign. The mean square over the volume is a closed form.

Deviations with the tables of a control, for the years after a campaign.

A table holds what its control can hold. After a time ℓ - (1 - ρ) k - f is left over the volume. Here k is the mean of
errors that age and f that of renewed ones, both less what never changes. The mean square needs the six products of
the three alone. All three are in the directions that count, less one shift of everything and what probing the part
takes off.

Errors that wear off between two campaigns, towards what was known before the first.

An error a keeps a share of what sets it off from the mean m̄ of its prior, N(m̄, C₀). The rest comes anew. With
K = diag(κ), κ = ρ of errors that age and 0 of renewed ones,

    a' = m̄ + K (a − m̄) + ε,    ε ~ N(0, (1 − ρ²) C₀) among what ages, N(0, C₀) among what is new

m̄ = 0 and C₀ is as stated, unless a type has taught both.

How much of what a campaign found is left after a time: learnt from machines that were measured again.

Each error keeps ρ(Δt) = ρ₁ y^Δt, Δt in years: set-ups and warm-ups at once leave ρ₁ < 1, a year leaves y. A second
campaign with the data equation z₂ is as probable as

    p(z₂ | ρ m₁, ρ² C₁ + (1 − ρ²) C₀)

with m₁, C₁ after the first one and m̄ = 0. The prior is ρ₁, y ~ Beta(9, 1); averages are over a grid, weighted by it
and the product over pairs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from axiscal.description.type_text import is_type_text, type_prior
from axiscal.errors.model import ErrorModel
from axiscal.estimation.data_equation import DataEquation, log_evidence
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.promise.problem import Inherited
from axiscal.estimation.type_prior import over
from axiscal.evaluation.datums import added_to_values
from axiscal.machine.description import Machine
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.tables.offer import spread_poses
from axiscal.tables.registry import offered_control
from axiscal.tables.surface import Control, left_by

YEAR = 365.25 * 86400.0
"""s."""
_GRID = np.arange(0.505, 1.0, 0.01)
"""Places for ρ₁ and for y: half a percent off is nothing."""
_KEPT = 9.0
"""Of the Beta(9, 1): nine tenths are kept as a rule, as where a campaign says nothing else."""

_SISTER = 0.5
"""A machine that is less probably one of its type ages as stated."""


class Wearing(NamedTuple):
    """mean : (n,) m̄; fresh : (n, n) C₀, what comes anew"""

    mean: Array
    fresh: Array

    @classmethod
    def as_stated(cls, errors: ErrorModel) -> Self:
        """Return that of a machine of no known type."""
        return cls(np.zeros(errors.size), errors.prior_covariance())

    @classmethod
    def from_estimation(cls, known: Estimation) -> Self:
        """Return that of a machine that was measured, by what its type has taught where it was measured by that."""
        errors, text = known.case.errors, known.stated.description.prior_text
        stranger = known.membership is not None and known.membership.sister < _SISTER
        if not is_type_text(text) or stranger:
            return cls.as_stated(errors)
        taught = over(type_prior(text), errors)
        return cls(taught.mean, taught.covariance)

    def covariance(self, found: Inherited, square: float, renewed: NDArray[np.bool_]) -> Array:
        """Return that of a' where ρ is certain, averaged over ρ.

        found : N(m, C); square : the mean of ρ²; renewed : (n,) bool
        """
        ages = (~renewed).astype(float)
        both = np.outer(ages, ages)
        new = (1 - square) * both + np.outer(renewed, renewed)
        return square * both * found.covariance + new * self.fresh

    def left(self, found: Inherited, rho: float) -> Inherited:
        """Return what there is of what a campaign knew, nothing renewed.  found : N(m, C)"""
        none = np.zeros(len(self.mean), dtype=bool)
        return Inherited(self.mean + rho * (found.mean - self.mean), self.covariance(found, rho**2, none))


def found_by(known: Estimation) -> Inherited:
    """Return what a campaign knows of the errors of its machine."""
    size, belief = known.case.errors.size, known.printed.belief
    factor = belief.factor[:size]
    return Inherited(belief.mean[:size], factor @ factor.T)


class Pair(NamedTuple):
    """Two campaigns of one machine: years between them, what the first knew, what the second one read, what wears."""

    years: float
    first: Inherited
    second: DataEquation
    wears: Wearing


class Aging(NamedTuple):
    """How probable each ρ₁ (first index) and y is, (g, g), sum 1; pairs : that it was learnt from"""

    weights: Array
    pairs: int

    def shares(self, years: float) -> Array:
        """Return ρ after a time in each cell of the grid, (g, g)."""
        return _GRID[:, None] * _GRID**years

    def kept(self, years: float) -> tuple[float, float]:
        """Return the means of ρ and of ρ² after a time."""
        rho = self.shares(years)
        return float(np.sum(self.weights * rho)), float(np.sum(self.weights * rho**2))

    @property
    def at_once(self) -> tuple[float, float]:
        """Mean and std of ρ₁."""
        return _moments(self.weights.sum(axis=1))

    @property
    def yearly(self) -> tuple[float, float]:
        """Mean and std of y."""
        return _moments(self.weights.sum(axis=0))


def _moments(weights: Array) -> tuple[float, float]:
    mean = float(weights @ _GRID)
    return mean, float(np.sqrt(weights @ (_GRID - mean) ** 2))


def aging(pairs: Sequence[Pair]) -> Aging:
    """Return what machines that were measured again say; without any, what is believed beforehand."""
    logs = (_KEPT - 1) * (np.log(_GRID)[:, None] + np.log(_GRID))
    for pair in pairs:
        rho = _GRID[:, None] * _GRID**pair.years
        # one evidence for each distinct share, to a thousandth: the grid's products lie denser than that
        shares = np.round(rho, 3)
        left = pair.wears.left
        found = {share: log_evidence(pair.second, left(pair.first, share)) for share in np.unique(shares).tolist()}
        logs = logs + np.vectorize(found.__getitem__)(shares)
    weights = np.exp(logs - logs.max())
    return Aging(weights / weights.sum(), len(pairs))


def worn(
    known: Estimation, aging: Aging, renewed: Sequence[str] = (), tables: str | None = None
) -> Callable[[float], float]:
    """Return what gives the RMS over the volume of a machine, m, a time in years after its last campaign.

    known : what that came to; aging : how machines change; renewed : axes of which nothing is as it was found
    tables : of which control; None where all that was found is taken away
    Raises TableError where no tables can be made for the control.
    """
    errors, yardstick = known.case.errors, known.case.yardstick
    found, wears, fresh = found_by(known), Wearing.from_estimation(known), np.zeros(errors.size, dtype=bool)
    for term in errors.terms:
        fresh[term.columns] = any(errors.machine.axes[axis].name in renewed for axis in term.axes)
    if tables is None:
        moving = found.mean - wears.mean
        fields = np.array([yardstick.root.matrix @ (moving * share) for share in (0.0, ~fresh, fresh)])
        products: Array = fields @ fields.T
    else:
        products = products_left(known, offered_control(known, tables), fresh, wears.mean)

    def rms(years: float) -> float:
        rho, square = aging.kept(years)
        once = np.array([1.0, rho - 1.0, -1.0])
        moved = once @ products @ once + (square - rho**2) * products[1, 1]
        drifted = np.sum(yardstick.root.weights * wears.covariance(found, square, fresh))
        return yardstick.rms_of(float(drifted + moved))

    return rms


def products_left(known: Estimation, control: Control, renewed: NDArray[np.bool_], stays: Array) -> Array:
    """Return the means over the volume of the products of ℓ, k and f, (3, 3), m².

    renewed : (n,) bool, of the unknowns of the errors; stays : (n,) the part of their mean that never changes
    """
    estimate = known.estimate()
    poses, approaches = spread_poses(estimate)
    rows, moving = estimate.model.rows(poses, approaches), estimate.mean - stays
    whole = left_by(estimate.machine, estimate.deviation, control, poses, approaches)
    fields = [whole, rows @ (moving * ~renewed), rows @ (moving * renewed)]
    centred = np.array([estimate.counting(poses, each) for each in fields])
    products: Array = np.einsum("apc,bpc->ab", centred, centred) / len(poses)
    return products


def without_tables(
    readings: Sequence[Reading], machine: Machine, setups: Sequence[Setup], control: Control
) -> list[Reading]:
    """Return readings less what a control adds to each of their numbers.  setups : of the campaign, by name"""
    named = {setup.name: setup for setup in setups}
    found = list[Reading]()
    for reading in readings:
        at = np.array([reading.pose]), np.array([reading.approach], dtype=float)
        (added,) = added_to_values(machine, named[reading.setup], *at, control)
        value, *others = (value - float(each) for value, each in zip(reading.values, added, strict=True))
        found.append(replace(reading, value=value, others=tuple(others)))
    return found
