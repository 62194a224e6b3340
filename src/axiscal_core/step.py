"""The reading that serves most: equation (37) of the paper in one line, for its spline of figure 4.

    >>> import axiscal_core as ac
    >>> machine = ac.Machine([ac.Axis.linear("X", "x", (0, 10))], [ac.Error("EXX", std=1.0)])
    >>> dial = ac.Laser("dial", "X", noise=0.1, unknowns={"zero": 0.0}, approach="+")
    >>> case = ac.Case(machine, [dial], usual="off", sure="exactly")
    >>> abs(case.next(criterion="joint").poses - 5).round(4)
    array([[0.873]])

The peaks of a lattice are starts, from every side that shows. Newton's steps and looks lead them uphill, and fewer and
fewer go on. The highest is then moved along one axis after another, exactly: where a reading is one number, N and D of
its gain are polynomials between knots and edges of cells (`roots`). The paper's have degree six; an angle whose lever
grows makes it eight, and an axis that turns adds sines.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal_core.climb import Climb
from axiscal_core.criterion import Criterion, Goal
from axiscal_core.gains import own_numbers
from axiscal_core.instrument import Instrument
from axiscal_core.model import Model
from axiscal_core.places import Places, Readings
from axiscal_core.points import distinct_between
from axiscal_core.refusals import Array
from axiscal_core.roots import Forms, largest, node_count
from axiscal_core.state import State
from axiscal_core.terms import ASIDE, CELLS
from axiscal_core.threads import one_thread

_POINTS, _FINEST, _EVEN = 20_000, 16, 1000  # of the lattice; parts of a stretch between knots; where neither fits
_LOOKS, _STRETCHES = np.array([1, 3, 5]) / 6, 8  # shares of each stretch between knots; as many stretches at least
_ROUNDS = 60  # rounds end where none rises
_SETTLED = 1e-9  # of the gain: less is no rise
_BLOCK = 4096  # places at once: of memory, not of the result


class _Sieve(NamedTuple):
    """Limits to go on: the most readings, their least share of the best gain, and the number of Newton's steps."""

    most: int
    share: float
    steps: int


_SIEVES = (_Sieve(240, 0.5, 1), _Sieve(120, 0.7, 2), _Sieve(40, 0.8, 40), _Sieve(4, 0.9999, 0))
"""How hard to look, so that no narrow ridge is missed: those that pass the last sieve are climbed to the top."""


@one_thread()
def best_step(case: Model, after: Readings | Places | None, criterion: Criterion) -> Places:
    """Return the one reading that serves most (B&H eq. 37)."""
    state = begun(case, case.goal(criterion, "Case.next")).after(case.taken(after, "Case.next"))
    found = [_best_of(Ground(case, state, instrument)) for instrument in case.instruments]
    return max(found, key=lambda pair: pair[1])[0]


def begun(case: Model, goal: Goal) -> State:
    """Return what is known before any reading."""
    return State(case.prior.factor, goal, np.array([term.rest for term in case.machine.terms]), len(case.causes))


@dataclass(frozen=True, eq=False)
class Ground:
    """The axes that an instrument moves, as coordinates of a climb."""

    case: Model
    state: State
    instrument: Instrument

    @cached_property
    def axes(self) -> list[int]:
        """Their indices."""
        return [self.case.machine.axis_names.index(name) for name in self.instrument.moves]

    @cached_property
    def ends(self) -> Array:
        """From where to where each goes, (size, 2)."""
        return np.array([self.case.machine.axes[k].travel for k in self.axes])

    @cached_property
    def spans(self) -> Array:
        """The travel of every axis of the machine, (q,)."""
        return np.array([axis.length for axis in self.case.machine.axes])

    @cached_property
    def continuous(self) -> list[int]:
        """All coordinates."""
        return [*range(len(self.axes))]

    @cached_property
    def sided(self) -> NDArray[np.intp]:
        """The axes with a reversal, where they may come from either side."""
        turning = self.case.machine.reversing
        both = len(self.instrument.sides) > 1
        return np.flatnonzero([both and k in turning for k in self.axes])

    @cached_property
    def _parked(self) -> Array:
        return self.case.lattice_of(self.instrument, 1).poses

    def as_poses(self, places: Array, sides: Array) -> tuple[Array, Array]:
        """Return poses and sides, (m, q) each."""
        poses = np.tile(self._parked, (len(places), 1))
        come = np.zeros_like(poses)
        poses[:, self.axes], come[:, self.axes] = places, sides
        return poses, come

    def looks(self, number: int) -> Array:
        """Return a few values in each stretch between knots, (p,): where there are none, of an eighth of the travel."""
        low, high = self.ends[number].tolist()
        knots = np.union1d(_knots(self.case, self.axes[number]), np.linspace(low, high, _STRETCHES + 1))
        return np.ravel(knots[:-1, None] + np.diff(knots)[:, None] * _LOOKS)

    def gained(self, places: Array, sides: Array) -> Array:
        """Return what readings gain, (m,)."""
        return gains_of(self.case, self.state, self.placed(places, sides))

    def placed(self, places: Array, sides: Array) -> Places:
        """Return the places."""
        return Places(self.instrument.name, *self.as_poses(places, sides))

    def starts(self) -> Climb:
        """Return the points of a lattice, from every side that shows, that no neighbour beats."""
        points, shape = self._lattice()
        places, sides = list[Array](), list[Array]()
        for signs in itertools.product((1.0, -1.0), repeat=len(self.sided)):
            side = np.full(len(self.axes), self.instrument.sides[0])
            side[self.sided] = signs
            come = np.tile(side, (len(points), 1))
            top = _peaks(self.gained(points, come).reshape(shape)) if shape else np.arange(len(points))
            places.append(points[top])
            sides.append(come[top])
        return Climb.begun(self, self.gained, np.concatenate(places), np.concatenate(sides))

    def _lattice(self) -> tuple[Array, tuple[int, ...]]:
        """Return points, (m, size), and the shape of their lattice: stretches between knots in as many parts as fit.

        Where not even the knots alone fit, the points are spread evenly, and the shape is ().
        """
        for parts in range(_FINEST, 0, -1):
            along = [_parted(_knots(self.case, k), parts) for k in self.axes]
            shape = tuple(len(each) for each in along)
            if math.prod(shape) <= _POINTS:
                return np.stack([each.ravel() for each in np.meshgrid(*along, indexing="ij")], axis=1), shape
        return self.case.lattice_of(self.instrument, _EVEN).poses[:, self.axes], ()

    def exactly(self, place: Array, side: Array, gain: float) -> tuple[Array, float]:
        """Return a place moved along one axis after another to the best on its line, and what it gains."""
        for number in self.continuous if len(self.instrument.names) == 1 else []:
            breaks = _breaks(self.case, self.axes[number])
            turning = self.case.machine.axes[self.axes[number]].rotary
            nodes = node_count(6, 2 * float(np.diff(breaks).max())) if turning else node_count(8)
            found = largest(self._along(number, place, side), breaks, nodes, gain)
            if found is not None and found[1] > gain:
                place, gain = place.copy(), found[1]
                place[number] = found[0]
        return place, gain

    def _along(self, number: int, place: Array, side: Array) -> Forms:
        """Return N and D of the gain where one coordinate of a place has other values."""

        def forms(values: Array) -> tuple[Array, Array]:
            tried = np.tile(place, (len(values), 1))
            tried[:, number] = values
            n = self.case.numbers(self.placed(tried, np.tile(side, (len(values), 1))))
            block, g = self.state.of_places(n, 1)
            return np.sum(g[:, 0] ** 2, axis=1), block[:, 0, 0]

        return forms


def gains_of(case: Model, state: State, places: Places) -> Array:
    """Return by how much J falls with each place alone, (m,).  places : of one instrument"""
    parts = [case.numbers(places.at(np.arange(i, min(i + _BLOCK, len(places))))) for i in range(0, len(places), _BLOCK)]
    return np.concatenate([state.gains(n, own_numbers(n.place, int(n.place[-1]) + 1)) for n in parts])


def climbed(case: Model, state: State, place: Places) -> tuple[Places, float]:
    """Return a place moved uphill, and what it gains.  place : one"""
    ground = Ground(case, state, case.instruments[case.setups.index(place.instruments[0])])
    climb = Climb.begun(ground, ground.gained, place.poses[:, ground.axes], place.sides[:, ground.axes])
    climb.uphill()
    return ground.placed(climb.places, climb.sides), float(climb.gains[0])


def _best_of(ground: Ground) -> tuple[Places, float]:
    """Return the best reading of one instrument, and what it gains."""
    climb = ground.starts()
    for sieve in _SIEVES:
        climb = climb.best(sieve.most, sieve.share, float(climb.gains.max()))
        climb.newton(sieve.steps)
        climb = climb.distinct()
    climb.uphill()
    climb = climb.best(1, 0.0, 1.0)
    for _ in range(_ROUNDS if ground.state.goal.function is None else 0):
        before = climb.gains[0]
        climb.places[0], climb.gains[0] = ground.exactly(climb.places[0], climb.sides[0], float(before))
        if climb.gains[0] <= before * (1 + _SETTLED):
            break
        climb.uphill()
    return ground.placed(climb.places, climb.sides), float(climb.gains[0])


def _peaks(gains: Array) -> NDArray[np.intp]:
    """Return the points, in rows, that gain no less than those beside them.  gains : on a lattice"""
    beaten = np.zeros(gains.shape, dtype=bool)
    for axis in range(gains.ndim):
        along, covered = np.moveaxis(gains, axis, 0), np.moveaxis(beaten, axis, 0)
        covered[:-1] |= along[1:] > along[:-1]
        covered[1:] |= along[:-1] > along[1:]
    return np.flatnonzero(~beaten)


def _knots(case: Model, k: int) -> Array:
    """Return the knots of all curves along an axis, (b,) within its travel."""
    low, high = case.machine.axes[k].travel
    return distinct_between(np.concatenate([[low, high], *case.machine.knots_along(k)]), low, high)


def _parted(knots: Array, parts: int) -> Array:
    """Return knots with each stretch between two of them in so many parts, (p,)."""
    shares = np.arange(parts) / parts
    return np.append(np.ravel(knots[:-1, None] + np.diff(knots)[:, None] * shares), knots[-1])


def _breaks(case: Model, k: int) -> Array:
    """Return the same with the edges of the cells of rests."""
    parts = [_knots(case, k)]
    for side in (side for term in case.machine.terms if term.rest for side in term.sides if side.axis == k):
        first, last = side.spline.knots[[0, -1]]
        parts.append(np.linspace(first, last, CELLS * (len(side.spline.knots) - 1) + 1) - ASIDE)
    return distinct_between(np.concatenate(parts), *case.machine.axes[k].travel)
