"""What readings suffer beside the machine's curves: columns for each cause, at its usual size.

rest      detail finer than a spline: half of its variance in cells of 2 % of the travel, half in cells of 6 %
drift     of a zero: a line and Brownian motion over the time of its set-up, 2 of its noise each
cycle     of a zero: Matérn-1/2 in time with six minutes, half of its noise
growth    of a linear axis: coordinate over travel times Matérn-3/2 in time, 2 noises
way       parts of a reversal of which exp(-d/l) is missing, d the way since the axis turned, l of 30, 100 and 350 mm
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from axiscal_core import usual
from axiscal_core.columns import Scale
from axiscal_core.eigen import of_rank
from axiscal_core.model import Model, Numbers
from axiscal_core.places import Places
from axiscal_core.refusals import Array
from axiscal_core.splines import matern
from axiscal_core.terms import Term
from axiscal_core.theta import Kind

DRIFT, CYCLE, GROWTH, WAY = (cause.size for cause in (usual.DRIFT, usual.CYCLE, usual.GROWTH, usual.WAY))
"""Usual sizes: in noises, the last one of a reversal."""
WIDE = 0.06  # of the travel, within which half of the variance of a rest is common
_FUNCTIONS = 20  # of Karhunen and Loève: they leave 0.5 % of the variance of Brownian motion
_MINUTES, _LONGEST, _MANY = 360.0, 4 * 3600.0, 300  # s, s, numbers: over more a cycle is not told from noise
_NODES, _MEMORY = 10, 0.4  # of growth: five in its length, what lies between two of them is straight to a tenth
WAYS = (0.03, 0.1, 0.35)  # m, over which a reversal comes: a hand's breadth, from a third of it to three
MEMORY = 3600.0  # s, over which the rate of a drift that is stated forgets itself
_NUGGET = 1e-9  # on correlations of readings at one time
Columns = Iterator[tuple[Kind, str, Array]]
"""Kind and owner of a size, and columns Z (n, q) of unknowns of variance one that exp θ multiplies."""


def time_of(clock: Array) -> float:
    """Return the time T over which readings were taken, s; 1 where all have one time.  clock : (r,) s"""
    return float(np.ptp(clock)) or 1.0


def drift(clock: Array, sigma: ArrayLike, wander: float) -> Array:
    """Return how far a zero has drifted, of unknowns of variance one, (r, 21): as usual, with what is stated.

    A line, and Brownian motion by Karhunen-Loève functions √2 sin((k - ½)π t/T)/((k - ½)π), k = 1…20.
    clock : (r,) s; sigma : or (r,) m or rad; wander : m/s or rad/s
    """
    share, turns = (clock - clock.min()) / time_of(clock), (np.arange(_FUNCTIONS) + 0.5) * np.pi
    functions = np.column_stack([share, np.sqrt(2.0) * np.sin(np.outer(share, turns)) / turns])
    stated = np.sqrt(wandered(wander, time_of(clock)) / 2)
    return np.asarray(np.hypot(np.multiply(DRIFT, sigma), stated).reshape(-1, 1) * functions)


def wandered(rate: float, seconds: ArrayLike) -> Array:
    """Return the variances of a zero so long after its first reading, 2 r²T² (x − 1 + exp(−x)), m² or rad².

    It moves at a rate of standard deviation r that forgets itself over T, x = t/T (integrated Ornstein-Uhlenbeck).
    """
    after = np.abs(seconds) / MEMORY
    return np.asarray(2 * (rate * MEMORY) ** 2 * (after + np.expm1(-after)))


def growth_functions(clock: Array) -> Array:
    """Return Matérn-3/2 in time with 0.4 T, linear between ten nodes, of unknowns of variance one, (r, 10)."""
    nodes, share = np.linspace(0.0, 1.0, _NODES), (clock - clock.min()) / time_of(clock)
    alike = matern(np.abs(nodes[:, None] - nodes) / _MEMORY, 1.5) + _NUGGET * np.eye(_NODES)
    hats = np.column_stack([np.interp(share, nodes, each) for each in np.eye(_NODES)])
    return np.asarray(hats @ np.linalg.cholesky(alike))


def cycle_correlation(clock: Array, numbers: int) -> Array | None:
    """Return Matérn-1/2 in time with six minutes, (r, r); None where nobody can tell it.  numbers : of all readings"""
    if time_of(clock) > _LONGEST or numbers > _MANY:
        return None
    return np.asarray(np.exp(-np.abs(clock[:, None] - clock) / _MINUTES) + _NUGGET * np.eye(len(clock)))


def absent(at: Array, sides: Array, order: np.ndarray, overrun: float) -> Array:
    """Return which share of each part of a reversal is missing, and its standard deviation, (2, r, ways).

    It is exp(-d/l), d the way since the axis turned: where it was before if it comes from the other side, an overrun
    off if it has to go past its place. Until it first turns nobody knows: up to that of an overrun is missing.
    at, sides : (r,) m and from where it comes; order : (r,) in which they are taken; overrun : m
    """
    at, sides = at[order], sides[order]
    gone = np.diff(at, prepend=at[:1]) * sides
    turns = (np.diff(sides, prepend=np.nan) != 0) | (gone < 0)
    last = np.maximum.accumulate(np.where(turns, np.arange(len(at)), 0))
    since = np.maximum(gone, overrun)[last] + np.abs(at - at[last])
    most, before = np.exp(-since[:, None] / WAYS), (last == 0)[:, None]
    shares: Array = np.where(before, [most / 2, most / np.sqrt(12)], [most, 0 * most])
    return shares[:, np.argsort(order)]


@dataclass(frozen=True, eq=False)
class OfOneSetup:
    """The readings of one instrument, whose numbers are `mine` (r,) of all.

    name : of it; count : of all numbers; part : (r,) which of its reading each is
    clock : (r,) s; sigma : (r,) m or rad; wander : of each zero as stated, m/s or rad/s
    """

    name: str
    count: int
    mine: np.ndarray
    part: np.ndarray
    clock: Array
    sigma: Array
    wander: float

    @property
    def zeros(self) -> list[np.ndarray]:
        """The numbers with one zero each, among its own."""
        return [np.flatnonzero(self.part == part) for part in np.unique(self.part)]

    def passing(self, growing: Iterable[Array], lacking: Iterable[tuple[str, Array]]) -> Columns:
        """Yield what passes while it is read.

        growing : (r,) what it shows of each axis that grows by one
        lacking : reversals, and what they lack of each part that nobody knows, (r, ways) standard deviations
        """
        for zero in self.zeros:
            clock, sigma = self.clock[zero], self.sigma[zero]
            yield "drift", self.name, self.wide(zero, of_rank(drift(clock, sigma, self.wander)))
            if (alike := cycle_correlation(clock, self.count)) is not None:
                yield "cycle", self.name, self.wide(zero, CYCLE * sigma[:, None] * np.linalg.cholesky(alike))
        for along in growing:
            grown = (GROWTH * self.sigma * along)[:, None] * growth_functions(self.clock)
            yield "growth", self.name, self.wide(np.arange(len(self.mine)), of_rank(grown))
        for name, lack in lacking:
            some = np.flatnonzero(np.any(lack, axis=1))
            yield "way", name, self.wide(some, of_rank(lack[some]))

    def wide(self, some: np.ndarray, columns: Array) -> Array:
        """Return columns of all numbers, (count, q), noughts but for some of its own.  columns : (some, q)"""
        result = np.zeros((self.count, columns.shape[1]))
        result[self.mine[some]] = columns
        return result


def columns_of(case: Model, places: Places, n: Numbers, clock: Array) -> Columns:
    """Yield the columns.  clock : (m,) s, of each place"""
    yield from _rests(case, n)
    for i in np.unique(n.setup).tolist() if case.usual else ():
        of, mine = case.instruments[i], np.flatnonzero(n.setup == i)
        place, part = n.place[mine], n.part[mine]
        read = OfOneSetup(case.setups[i], len(n.rows), mine, part, clock[place], of.sigma[part], of.wander)
        growing = (
            n.reach[mine, k] * (places.poses[place, term.axis] - np.mean(axis.travel)) / axis.length
            for k, term in enumerate(case.machine.curves)
            if _moves(case, i, term) and term.name == (axis := case.machine.axes[term.axis]).positioning_error
        )
        turning = _turning(case, places, clock, i, np.unique(place))
        lacking = ((t.name, WAY * t.std * n.reach[mine, k, None] * some[1, place]) for k, t, some in turning)
        yield from read.passing(growing, lacking)


def adding_to_curves(case: Model, places: Places, n: Numbers, clock: Array) -> Iterator[tuple[str, Scale, Array]]:
    """Yield scales of axes and parts of reversals: owner, what it adds, and which share of it readings have, (n,)."""
    missing = np.zeros((len(case.machine.curves), len(places), len(WAYS)))
    for i in np.unique(n.setup).tolist() if case.usual else ():
        for k, _, some in _turning(case, places, clock, i, np.unique(n.place[n.setup == i])):
            missing[k] += some[0]
    for term, lost in zip(case.machine.curves, missing, strict=True):
        part = term.columns
        if term.ramp is not None:
            yield term.name, Scale("scale", part, term.ramp), np.ones(len(n.rows))
        if np.any(lost):
            each = Scale("way", part, np.full(term.spline.size, WAY * term.std))
            yield from ((term.name, each, share) for share in np.transpose(1 - lost[n.place]))


def _turning(
    case: Model, places: Places, clock: Array, index: int, mine: np.ndarray
) -> Iterator[tuple[int, Term, Array]]:
    """Yield reversals that an instrument reads from both sides, and what is `absent` at its places, (2, m, ways)."""
    order, found = np.argsort(clock[mine], kind="stable"), np.zeros((2, len(places), len(WAYS)))
    for k, term in enumerate(case.machine.curves):
        if term.kind == "reversal" and len(case.instruments[index].sides) > 1 and _moves(case, index, term):
            at, sides = places.poses[mine, term.axis], places.sides[mine, term.axis]
            found[:, mine] = absent(at, sides, order, case.machine.axes[term.axis].overrun)
            yield k, term, found.copy()


def _moves(case: Model, index: int, term: Term) -> bool:
    """Return whether an instrument is read while the linear axis of a curve moves."""
    return term.linear and case.machine.axis_names[term.axis] in case.instruments[index].moves


def _rests(case: Model, n: Numbers) -> Columns:
    for i, term in enumerate(case.machine.terms):
        if term.rest:
            cells, which = np.unique(n.cell[:, i].astype(np.intp), return_inverse=True)
            root = cell_root(term, cells) if case.usual else np.eye(len(cells))
            yield "rest", term.name, term.rest * n.reach[:, i, None] * root[which]


def cell_root(term: Term, cells: NDArray[np.intp]) -> Array:
    """Return F with F Fᵀ the correlation of the rests of an error's cells, (q, q).

    Half of the variance is each cell's own, half is common to the cells of 6 % of the travel; of a plane all its own.
    """
    if len(term.sides) > 1:
        return np.eye(len(cells))
    block = cells // max(1, round(WIDE * term.cell_count))
    return np.asarray(np.linalg.cholesky(0.5 * (np.eye(len(cells)) + (block[:, None] == block))))
