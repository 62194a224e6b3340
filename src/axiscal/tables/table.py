"""A deviation at chosen positions, as a controller's table holds it.

Piecewise linear functions on given points, and the one nearest to a curve in the least-squares sense.

A control that interpolates does not show the curve at the points but the line between them. Values taken from the
curve itself lie on one side of every bend; the least-squares values spread what is left evenly to both sides.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from axiscal.exceptions import TableError
from axiscal.machine.axis import ROTARY_LETTERS
from axiscal.machine.error_names import AXIS_NAME
from axiscal.numerics import Array
from axiscal.units import format_quantity
from axiscal_core.from_scipy import sparse_product, sparse_solution
from axiscal_core.splines import gauss

_CUBIC = np.linalg.pinv(np.vander(np.polynomial.legendre.leggauss(5)[0], 4, increasing=True))
"""Mathematics: from the values at five points of Gauss to the cubic's coefficients."""
_APART = 1e-9
"""Share of the way from one point to the next: rounding of a place on the first."""
_OUTSIDE = 1e-6
"""Weight of what lies outside, so that every hat has a value: small against 1, or it would pull at the inside."""


@dataclass(frozen=True, eq=False, slots=True)
class Hats:
    """Hat functions on `points`, with a quadrature that is exact for them times any spline on `knots`.

    nodes : (5 n,) and weights, five in every stretch between two breaks, weighing little outside `bounds`
    closed : the last point is the first one of the next turn
    """

    points: Array
    nodes: Array
    weights: Array
    closed: bool

    @classmethod
    def on(cls, points: Array, knots: Array, bounds: tuple[float, float], closed: bool = False) -> Hats:
        """Return the hats on points (n,) increasing; knots : where the curve has its breaks."""
        breaks = np.unique(np.concatenate([points, knots, bounds]))
        breaks = breaks[(breaks >= points[0]) & (breaks <= points[-1])]
        breaks = breaks[np.r_[True, np.diff(breaks) > 1e-12 * (points[-1] - points[0])]]
        nodes, weights = gauss(breaks, 5)
        middle = nodes[:, 2]
        inside = (middle > bounds[0]) & (middle < bounds[1])
        share = np.where(inside, 1.0, _OUTSIDE if inside.any() else 1.0)
        return cls(points, nodes.ravel(), (share[:, None] * weights).ravel(), closed)

    def best(self, curve: Array) -> Array:
        """Return the values at the points whose line is nearest to a curve, (points,) or (points, k).

        curve : (nodes,) or (nodes, k), k of them at once
        A hat meets its two neighbours only, so few entries of the normal equations are not nought; where the last
        point is the first one their hats are one.
        """
        index, share = between(self.points, self.nodes)
        count, nodes = len(self.points) - self.closed, np.arange(len(share))
        places, shares = np.stack([index, index + 1]) % count, np.stack([1 - share, share])
        weighted = self.weights * shares
        right = sparse_product(weighted.ravel(), places.ravel(), np.tile(nodes, 2), (count, len(nodes)))(curve)
        squares = weighted[:, None] * shares
        rows, columns = (np.broadcast_to(each, squares.shape).ravel() for each in (places[:, None], places))
        values = sparse_solution(squares.ravel(), rows, columns, right)
        return np.concatenate([values, values[:1]]) if self.closed else values

    def departure(self, curve: Array, values: Array) -> float:
        """Return the largest distance within the bounds between a piecewise cubic and the line through values.

        curve : (nodes,) the cubic at the nodes; values : (points,)
        On each stretch the difference is one cubic, known from its five nodes; it is largest at an end or where its
        slope, a quadratic, vanishes.
        """
        within = self.weights.reshape(-1, 5)[:, 2]
        least = 1e-3 if np.min(within) < 1e-3 * np.max(within) else 0.0  # outside the bounds they weigh a millionth
        apart = (curve - np.interp(self.nodes, self.points, values)).reshape(-1, 5)
        kept = apart[within >= 0.5 * np.max(within) * least]
        return float(np.max(np.abs(_extremes(kept @ _CUBIC.T))))

    def at(self, place: float, values: Array) -> Array:
        """Return what lines through values (points, …) are at a place."""
        index, share = between(self.points, np.array([place]))
        there: Array = (1 - share[0]) * values[index[0]] + share[0] * values[index[0] + 1]
        return there


def between(points: Array, places: Array) -> tuple[NDArray[np.intp], Array]:
    """Return between which point and the next one places lie, and the share of the way, (m,) each."""
    index = np.clip(np.searchsorted(points, places, side="right") - 1, 0, len(points) - 2)
    return index, (places - points[index]) / (points[index + 1] - points[index])


def _extremes(cubics: Array) -> Array:
    """Return the values of cubics on [-1, 1] where they can be largest, (n, 4).  cubics : (n, 4), rising powers."""
    a, b, c = cubics[:, 1], 2 * cubics[:, 2], 3 * cubics[:, 3]
    root = np.sqrt(np.maximum(b * b - 4 * a * c, 0.0))
    q = -(b + np.where(b < 0, -root, root)) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        turns = np.stack([q / c, a / q], axis=1)
    turns = np.where(np.isfinite(turns) & (np.abs(turns) <= 1), turns, 1.0)
    at = np.hstack([turns, -np.ones((len(cubics), 1)), np.ones((len(cubics), 1))])
    values: Array = np.einsum("nk,nmk->nm", cubics, at[:, :, None] ** np.arange(4))
    return values


@dataclass(frozen=True, slots=True, eq=False)
class CompensationTable:
    """The deviation of one axis, actual minus nominal along its own positive direction, tool relative to workpiece.

    axis : its name, as in the chain
    positions : (n,) m or rad, strictly increasing, of the axis itself or of `over`
    forward, reverse : (n,) m or rad, the deviation when the position was approached upwards or downwards
    std : (n,) m or rad, the standard deviation that the deviation is known to; zero where nobody says
    over : the linear axis over whose position the deviation goes; the axis itself unless said otherwise
    prior_only : (n,) where the readings said nothing: the deviation there is what was believed beforehand
    shape_std : RMS of the standard deviation of the deviation less its mean over the table, m or rad
    told : whether readings tell it from nought
    departure : largest distance between the table and the curve it was made of, over the volume, m or rad
    Raises TableError for anything that no controller could hold.
    """

    axis: str
    positions: Array
    forward: Array
    reverse: Array
    std: Array = field(default_factory=lambda: np.zeros(0))
    over: str = ""
    prior_only: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))
    departure: float = 0.0
    shape_std: float = 0.0
    told: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "over", self.over or self.axis)
        for axis in (self.axis, self.over):
            if not re.fullmatch(AXIS_NAME, axis):
                remedy = "axes are named like X, Y2 or C"
                raise TableError("{name!r} is not the name of an axis", remedy, name=axis[:20])
        if not np.size(self.std):
            object.__setattr__(self, "std", np.zeros(np.shape(self.positions)))
        for name in ("positions", "forward", "reverse", "std"):
            values = np.array(getattr(self, name), dtype=np.float64)
            values.setflags(write=False)
            object.__setattr__(self, name, values)
            fits = values.ndim == 1 and 0 < len(values) == len(self.positions) and np.all(np.isfinite(values))
            if not fits or (name == "positions" and np.any(np.diff(values) <= 0)):
                what = "{name} of {axis} are no row of numbers, as many as its positions, which increase"
                raise TableError(what, "leave out what is not known, and sort the rest", name=name, axis=self.axis)
        if self.prior_only.shape != self.positions.shape:
            object.__setattr__(self, "prior_only", np.zeros(len(self.positions), dtype=bool))

    def deviation(self, position: Array, direction: Array | int) -> Array:
        """Return the deviation at positions (m,): linear between, constant outside.

        direction : +1 or -1, from which they were approached, or (m,) of each; the mean of both where that is 0
        """
        share = 0.5 * (1.0 + np.sign(direction))
        forward, reverse = (np.interp(position, self.positions, side) for side in (self.forward, self.reverse))
        return share * forward + (1.0 - share) * reverse

    @property
    def rotary(self) -> bool:
        """Whether the axis turns."""
        return self.axis[0] in ROTARY_LETTERS

    @property
    def unit(self) -> str:
        """The unit in which positions are shown."""
        return "deg" if self.rotary and self.over == self.axis else "mm"

    def value_unit(self, linear: str = "mm") -> str:
        """Return the unit of deviations in files of a control that counts lengths in `linear`."""
        return "deg" if self.rotary else linear

    @property
    def fine_unit(self) -> str:
        """The unit in which deviations are shown."""
        return "arcsec" if self.rotary else "um"

    def refuse_more(self, most: int) -> None:
        """Raise TableError where a control does not hold so many points."""
        if (count := len(self.positions)) > most:
            what = "the table of {axis} over {over} has {count} points, the control holds {most}"
            remedy = "{most} points fit: over this travel one every {fits} or wider"
            fits = math.ceil(float(np.ptp(self.positions)) / (most - 1) * 1e6) / 1e6
            shown = format_quantity(fits, self.unit)
            raise TableError(what, remedy, axis=self.axis, over=self.over, count=count, most=most, fits=shown)

    def resampled(self, at: Array) -> CompensationTable:
        """Return the table on other points (n,): lines between its own."""
        forward, reverse = (self.deviation(at, side) for side in (1, -1))
        silent = np.interp(at, self.positions, self.prior_only.astype(float)) > 1 - _APART
        std = np.interp(at, self.positions, self.std)
        return replace(self, positions=at, forward=forward, reverse=reverse, std=std, prior_only=silent)

    def averaged(self) -> CompensationTable:
        """Return the table without reversal: the mean of both directions."""
        mean = (self.forward + self.reverse) / 2
        return replace(self, forward=mean, reverse=mean)

    @property
    def reversal(self) -> tuple[float, float]:
        """Smallest and largest size of the step between the two directions anywhere on the table, m or rad."""
        step = self.forward - self.reverse
        crosses = bool(np.any(step > 0) and np.any(step < 0))
        return 0.0 if crosses else float(np.min(np.abs(step))), float(np.max(np.abs(step)))

    def shown(self, value: float) -> str:
        """Return a deviation (m or rad) as text."""
        return format_quantity(value, self.fine_unit, 3)
