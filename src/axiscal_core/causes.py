"""What readings suffer beside the machine's curves: columns for each cause, at its usual size.

rest      detail finer than a spline: half of its variance in cells of 2 % of the travel, half in cells of 6 %
drift     of a zero: a line and Brownian motion over the time of its set-up, 2 of its noise each
cycle     of a zero: Matérn-1/2 in time with six minutes, half of its noise
growth    of a linear axis: coordinate over travel times Matérn-3/2 in time, 2 noises
way       parts of a reversal of which exp(-d/l) is missing, d the way since the axis turned, l of 30, 100 and 350 mm
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from axiscal_core.columns import Scale
from axiscal_core.errors import CELLS, Curved
from axiscal_core.model import Model, Numbers
from axiscal_core.places import Places
from axiscal_core.refusals import Array
from axiscal_core.splines import matern
from axiscal_core.theta import Kind

DRIFT, CYCLE, GROWTH, WAY = 2.0, 0.5, 2.0, 0.06
"""Usual sizes: in noises, the last one of a reversal. Nine ISO 230-2 tests say the first, nobody the others."""
WIDE = 0.06  # of the travel, within which half of the variance of a rest is common
_FUNCTIONS = 20  # of Karhunen and Loève: they leave 0.5 % of the variance of Brownian motion
_MINUTES, _LONGEST, _MANY = 360.0, 4 * 3600.0, 300  # s, s, numbers: over more a cycle is not told from noise
_NODES, _MEMORY = 10, 0.4  # of growth: five in its length, what lies between two of them is straight to a tenth
WAYS = (0.03, 0.1, 0.35)  # m, over which a reversal comes: a hand's breadth, from a third of it to three
_HOUR = 3600.0  # s, over which the rate of a drift that is stated forgets itself
_NUGGET = 1e-9  # on correlations of readings at one time
Columns = Iterator[tuple[Kind, str, Array]]
"""Kind and owner of a size, and columns Z (n, q) of unknowns of variance one that exp θ multiplies."""


def time_of(clock: Array) -> float:
    """Return the time T over which readings were taken, s; 1 where all have one time.  clock : (r,) s"""
    return float(np.ptp(clock)) or 1.0


def drift_functions(clock: Array) -> Array:
    """Return a line and Brownian motion over T, of unknowns of variance one, (r, 21).  clock : (r,) s

    The latter has Karhunen-Loève functions √2 sin((k - ½)π t/T)/((k - ½)π), k = 1…20.
    """
    share, turns = (clock - clock.min()) / time_of(clock), (np.arange(_FUNCTIONS) + 0.5) * np.pi
    return np.column_stack([share, np.sqrt(2.0) * np.sin(np.outer(share, turns)) / turns])


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


def way_since_turn(at: Array, sides: Array, overrun: float) -> Array:
    """Return how far an axis has come since it turned, (r,) m.

    at, sides : (r,) m and from where it comes, in order; overrun : m, that it has come where the side changes
    """
    since, step = np.full(len(at), overrun), np.diff(at) * sides[1:]
    for number in np.flatnonzero((sides[1:] == sides[:-1]) & (step >= 0)).tolist():
        since[number + 1] = since[number] + step[number]
    return since


def columns_of(case: Model, places: Places, n: Numbers, clock: Array) -> Columns:
    """Yield the columns.  clock : (m,) s, of each place"""
    yield from _rests(case, n)
    if case.usual:
        for i in np.unique(n.setup).tolist():
            yield from _OfSetup(case, places, n, clock, i).columns()


def adding_to_curves(case: Model, places: Places, n: Numbers, clock: Array) -> Iterator[tuple[str, Scale, Array]]:
    """Yield scales of axes and parts of reversals: owner, what it adds, and which share of it readings have, (n,)."""
    setups = [_OfSetup(case, places, n, clock, i) for i in np.unique(n.setup).tolist()] if case.usual else []
    for at, term in case.machine.curves:
        part, absent = case.machine.columns[at], sum(each.absent(term) for each in setups)
        if term.ramp is not None:
            yield term.name, Scale("scale", part, term.ramp), np.ones(len(n.rows))
        if np.any(absent):
            each = Scale("way", part, np.full(term.spline.size, WAY * term.std))
            yield from ((term.name, each, share) for share in np.transpose(1 - absent))


def _rests(case: Model, n: Numbers) -> Columns:
    for i, (_, term) in enumerate(case.machine.curves):
        if term.rest:
            cells, which = np.unique(n.cell[:, i], return_inverse=True)
            wide = cells // max(1, round(WIDE * CELLS * (len(term.spline.knots) - 1)))
            alike = 0.5 * np.eye(len(cells)) + 0.5 * (wide[:, None] == wide) if case.usual else np.eye(len(cells))
            yield "rest", term.name, term.rest * n.reach[:, i, None] * np.linalg.cholesky(alike)[which]


class _OfSetup:
    """The readings of one instrument: mine, the numbers (r,) that are its own, with the time of each."""

    def __init__(self, case: Model, places: Places, n: Numbers, clock: Array, index: int) -> None:
        self.case, self.places, self.n = case, places, n
        self.instrument, self.name = case.instruments[index], case.setups[index]
        self.mine = np.flatnonzero(n.setup == index)
        self.clock = clock[n.place[self.mine]]
        self.sigma = self.instrument.sigma[n.part[self.mine]]

    def columns(self) -> Columns:
        """Yield what passes while it is read."""
        parts = self.n.part[self.mine]
        for part in np.unique(parts):  # each number has a zero of its own
            zero = parts == part
            yield "drift", self.name, self._wide(zero[:, None] * self._drift())
            alike = cycle_correlation(self.clock[zero], len(self.n.rows))
            if alike is not None:
                root = np.zeros((len(parts), len(alike)))
                root[zero] = CYCLE * self.sigma[zero, None] * np.linalg.cholesky(alike)
                yield "cycle", self.name, self._wide(root)
        for i, (_, term) in enumerate(self.case.machine.curves):
            if self._moves(term) and term.error.positioning:
                yield "growth", self.name, self._wide(self._growth(i, term))

    def _moves(self, term: Curved) -> bool:
        return term.linear and self.case.machine.names[term.at] in self.instrument.moves

    def _wide(self, columns: Array) -> Array:
        """Return columns of all numbers, (n, q).  columns : (r, q)"""
        result = np.zeros((len(self.n.rows), columns.shape[1]))
        result[self.mine] = columns
        return result

    def _drift(self) -> Array:
        x = time_of(self.clock) / _HOUR
        stated = self.instrument.wander * _HOUR * np.sqrt(x - 1 + np.exp(-x))
        return np.asarray(np.hypot(DRIFT * self.sigma, stated)[:, None] * drift_functions(self.clock))

    def _growth(self, i: int, term: Curved) -> Array:
        """Return the columns of an axis that grows.  i : its positioning error among the curves"""
        axis, at = self.case.machine.axes[term.at], self.places.poses[self.n.place[self.mine], term.at]
        along = self.sigma * self.n.reach[self.mine, i] * (at - np.mean(axis.travel)) / axis.length
        return np.asarray(GROWTH * along[:, None] * growth_functions(self.clock))

    def absent(self, term: Curved) -> Array:
        """Return which share of parts of a reversal is missing of all numbers, (n, ways); zero of any other error."""
        if term.error.kind != "reversal" or not self._moves(term) or len(self.instrument.sides) < 2:
            return np.zeros((len(self.n.rows), len(WAYS)))
        taken, first = np.unique(self.n.place[self.mine], return_index=True)
        order = taken[np.argsort(self.clock[first], kind="stable")]
        at, sides = self.places.poses[order, term.at], self.places.sides[order, term.at]
        missing = np.zeros((len(self.places), len(WAYS)))
        missing[order] = np.exp(-way_since_turn(at, sides, self.case.machine.axes[term.at].overrun)[:, None] / WAYS)
        return self._wide(missing[self.n.place[self.mine]])
