"""The reading that serves most: equation (37) of the paper in one line, for its spline of figure 4.

    >>> import axiscal_core as ac
    >>> machine = ac.Machine([ac.Axis.linear("X", "x", (0, 10))], [ac.Error("EXX", std=1.0)])
    >>> dial = ac.Laser("dial", "X", noise=0.1, unknowns={"zero": 0.0}, approach="+")
    >>> case = ac.Case(machine, [dial], usual="off", sure="exactly")
    >>> abs(case.next(criterion="joint").poses - 5).round(4)
    array([[0.873]])

One axis moves and a reading is one number: then N and D of its gain are polynomials between knots and edges of cells.
The paper's have degree six; an angle whose lever grows makes it eight. So the best place is exact (`roots`). Elsewhere
the best of many even places climb in smaller and smaller steps.
"""

from __future__ import annotations

import numpy as np

from axiscal_core.axes import Axis
from axiscal_core.criterion import Criterion, goal
from axiscal_core.instrument import Instrument
from axiscal_core.model import ASIDE, CELLS, Model
from axiscal_core.places import Places, Readings
from axiscal_core.refusals import Array
from axiscal_core.roots import largest
from axiscal_core.state import State
from axiscal_core.threads import one_thread

_DEGREE = 8
_STARTS, _LAST = 100, 8  # of the climb: with four times as many the best step of eight drawn cases is the same
_WIDTH, _LOOKS = 0.12, 9  # of the travel, to each side


@one_thread
def best_step(case: Model, after: Readings | Places | None, criterion: Criterion) -> Places:
    """Return the one reading that serves most."""
    wanted = goal(criterion, case.machine, case.volume, "Case.next")
    state = State(case, wanted, case.taken(after, "Case.next"))
    found = [best_of(state, i) for i in range(len(case.instruments))]
    return max(found, key=lambda pair: pair[1])[0]


def best_of(state: State, index: int) -> tuple[Places, float]:
    """Return the best reading of one instrument, and what it gains."""
    exact = _exact(state, index)
    return exact if exact is not None else _climbed_best(state, index)


def _exact(state: State, index: int) -> tuple[Places, float] | None:
    """Return the best reading by the roots of polynomials; None where it does not go along a line, or is no ratio."""
    instrument = state.case.instruments[index]
    if len(instrument.moves) != 1 or len(instrument.names) != 1 or state.goal.function is not None:
        return None
    found = list[tuple[Places, float]]()
    for side in instrument.sides:
        line = _Line(state, instrument, side)
        best = largest(line.forms, _breaks(state.case, line.k), _DEGREE)
        if best is None:
            return None
        found.append((line.placed(np.array([best[0]])), best[1]))
    return max(found, key=lambda pair: pair[1])


class _Line:
    """The places of an instrument along the one axis that it moves, from one side."""

    def __init__(self, state: State, instrument: Instrument, side: float) -> None:
        self.state, self.instrument, self.side = state, instrument, side
        self.k = state.case.machine.names.index(instrument.moves[0])
        self.parked = state.case.lattice_of(instrument, 1)

    def placed(self, t: Array) -> Places:
        """Return places at positions, (m,)."""
        poses, sides = np.tile(self.parked.poses, (len(t), 1)), np.tile(self.parked.sides, (len(t), 1))
        poses[:, self.k], sides[:, self.k] = t, self.side
        return Places(self.instrument.name, poses, sides)

    def forms(self, t: Array) -> tuple[Array, Array]:
        """Return N and D of the gain at positions, (m,) each."""
        block, reach = self.state.of_places(self.state.case.numbers(self.placed(t)), 1)
        return np.sum((reach[:, 0] @ self.state.goal.root.T) ** 2, axis=1), block[:, 0, 0]


def _breaks(case: Model, k: int) -> Array:
    """Return where N and D go from one polynomial to another along an axis, (b,) within its travel."""
    low, high = case.machine.axes[k].travel
    parts = [np.array([low, high])]
    for _, term in case.machine.curves:
        if term.at == k:
            first, last = term.spline.knots[[0, -1]]
            edges = np.linspace(first, last, CELLS * (len(term.spline.knots) - 1) + 1) - ASIDE
            turns = np.arange(np.ceil((high - first) / (last - first))) if term.error.period is not None else [0.0]
            parts += [term.spline.knots + turn * (last - first) for turn in turns] + ([edges] if term.rest else [])
    every = np.unique(np.concatenate(parts))
    inside = every[(every >= low) & (every <= high)]
    apart: Array = inside[np.append(True, np.diff(inside) > 1e-9 * (high - low))]
    return apart


def _climbed_best(state: State, index: int) -> tuple[Places, float]:
    lattice = state.case.lattice_of(state.case.instruments[index], 10 * _STARTS)
    high = np.argsort(-state.gains(lattice), kind="stable")[:_STARTS]
    places, gains = climbed(state, lattice.at(high), rounds=2)
    last = np.argsort(-gains, kind="stable")[:_LAST]
    places, gains = climbed(state, places.at(last), rounds=20, shrink=0.62)
    top = int(np.argmax(gains))
    return places.at([top]), float(gains[top])


def climbed(state: State, places: Places, rounds: int, shrink: float = 0.42) -> tuple[Places, Array]:
    """Return places moved uphill, and what they gain, (m,).  places : of one instrument

    Each round looks along every axis that moves. It goes to the best of each at once where that gains more than the
    best alone.
    """
    case = state.case
    instrument = case.instruments[case.setups.index(places.instruments[0])]
    axes = np.array([case.machine.names.index(name) for name in instrument.moves])
    each = np.arange(len(places))

    def gained(poses: Array) -> Array:
        repeats = len(poses) // len(places)
        return state.gains(Places(instrument.name, poses, np.repeat(places.sides, repeats, axis=0)))

    poses, gains, width = places.poses.copy(), gained(places.poses), _WIDTH
    for _ in range(rounds):
        looks = np.linspace(-width, width, _LOOKS)
        tried = np.tile(poses[:, None, None], (1, len(axes), _LOOKS, 1))
        for j, k in enumerate(axes.tolist()):
            tried[:, j, :, k] = _within(case.machine.axes[k], poses[:, k, None] + looks * case.machine.axes[k].length)
        found = gained(tried.reshape(-1, poses.shape[1])).reshape(tried.shape[:3])
        best = found.argmax(axis=2)
        alone = tried[each[:, None], np.arange(len(axes)), best]
        highest = found.max(axis=2)
        options = [(poses, gains), (alone[each, highest.argmax(axis=1)], highest.max(axis=1))]
        if len(axes) > 1:
            together = poses.copy()
            together[:, axes] = alone[:, np.arange(len(axes)), axes]
            options.append((together, gained(together)))
        chosen = np.argmax([gain for _, gain in options], axis=0)
        poses = np.array([pose for pose, _ in options])[chosen, each]
        gains = np.array([gain for _, gain in options])[chosen, each]
        width *= shrink
    return Places(instrument.name, poses, places.sides), gains


def _within(axis: Axis, t: Array) -> Array:
    """Return positions in the travel, around the turn of a cyclic axis."""
    low, high = axis.travel
    return np.asarray(low + np.mod(t - low, axis.length) if axis.cyclic else np.clip(t, low, high))
