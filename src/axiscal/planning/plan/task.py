"""A planning task, the time that the plan may take, and how long its search may go on.

The search ends by the work that it has done: a clock would make another plan on a slower or a loaded machine.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.description.target import Target
from axiscal.estimation.accuracy.yardstick import Yardstick
from axiscal.measurement.candidates import spread
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.measurement.setup import Setup
from axiscal.measurement.travel import reading_seconds, short_way
from axiscal.numerics import Array
from axiscal.numerics.remembered import remembered
from axiscal_core.criterion import Goal as Criterion
from axiscal_core.machine import Machine
from axiscal_core.model import Numbers
from axiscal_core.normal import Normal
from axiscal_core.state import State

PATIENCE = 1e11
"""Operations that climbing off the lattice may take unless said otherwise: half a minute."""
_TYPICAL = 24
_COARSE, _EACH = 500, 100
"""Candidates among which sets of set-ups and numbers of readings are compared, of all and of each set-up: of time."""


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Task:
    """The belief to improve and the readings that are allowed.

    belief : over the unknowns of the observation, then rests of cells
    root : V (w, n) of the criterion; lattice : the candidates
    here : one place, of the set-up that is mounted and where the machine stands; None before the first
    beside : places of readings that will be taken, whatever is planned
    patience : operations that climbing off the lattice may take; 0 for figures alone, within a second
    cells : the rest and the cell of each of those in the belief
    """

    observation: Observation
    belief: Normal
    root: Array
    yardstick: Yardstick
    lattice: Places
    here: Places | None = None
    beside: Places | None = None
    patience: float = PATIENCE
    cells: Sequence[tuple[int, int]] = ()

    @property
    def coarse(self) -> Task:
        """The task with some hundred candidates."""
        most = max(_COARSE, _EACH * len(np.unique(self.lattice.setups)))
        kept = np.arange(0, len(self.lattice), max(1, len(self.lattice) // most))
        return replace(self, lattice=self.lattice.within(kept))

    def among(self, setups: Collection[int]) -> Task:
        """Return the task of some set-ups, without unknowns that only others have: neither read here nor weighed."""
        beside = [] if self.beside is None else self.beside.setups.tolist()
        whole, root, more = self.observation, self.root, list[int]()
        if root.shape[1] > whole.errors.size:
            weighed = np.asarray(root.any(axis=0))
            more = [setup for setup in range(len(whole.setups)) if weighed[whole.unknowns_of(setup)].any()]
        observation, kept = whole.among({*setups, *beside, *more})
        root = root if root.shape[1] <= whole.errors.size else root[:, kept[kept < root.shape[1]]]
        lattice = self.lattice.within(np.isin(self.lattice.setups, list(setups)))
        belief = self.belief.among(np.append(kept, np.arange(whole.size, self.belief.size)))
        return replace(self, observation=observation, belief=belief, lattice=lattice, root=root)

    @property
    @remembered
    def state(self) -> State:
        """What is known before the first reading of the plan, with those beside it."""
        return self.begun(Criterion(self.root))

    def begun(self, goal: Criterion) -> State:
        """Return the same by any criterion."""
        state = State(self.belief.factor, goal, self.observation.rests, cells=self.cells)
        return state if self.beside is None else state.after(self.numbers(self.beside))

    def numbers(self, places: Places) -> Numbers:
        """Return what readings at places would tell."""
        return self.observation.numbers(places)

    def after(self, places: Places) -> State:
        """Return what is known after readings."""
        return self.state.after(self.numbers(places))

    def whitened(self, places: Places) -> tuple[Array, NDArray[np.intp]]:
        """Return R^-½ H F (m, r) of all numbers of readings, rests as noise, and whose each is (m,), in order."""
        numbers = self.numbers(places)
        return self.state.whitened(numbers), numbers.place


@dataclass(frozen=True, slots=True)
class Limits:
    """A plan ends at the first that is reached.

    rms, worst : m; budget : s; expanded : U of the volume, m; rows : whether wanted rows with a limit are to be reached
    A search heeds readings and budget; a `Goal` says whether it has reached the others.
    """

    readings: int | None = None
    rms: float | None = None
    worst: float | None = None
    budget: float | None = None
    expanded: float | None = None
    rows: bool = False

    @classmethod
    def of(cls, target: Target) -> Limits:
        """Return all limits of a target."""
        return cls(target.readings, target.rms, target.worst, target.budget, target.expanded, rows=bool(target.lines))

    def times(self, factor: float) -> Limits:
        """Return the same with accuracies of the volume that are so many times as large."""
        rms, worst, whole = (None if x is None else factor * x for x in (self.rms, self.worst, self.expanded))
        return replace(self, rms=rms, worst=worst, expanded=whole)

    @property
    def of_volume(self) -> bool:
        """Whether they ask for an accuracy of the volume."""
        return not self.rms is self.worst is self.expanded is None

    @property
    def accurate(self) -> bool:
        """Whether the limits have a target accuracy."""
        return self.rows or self.of_volume

    @property
    def timed(self) -> bool:
        """Whether seconds count: for a budget, and for the least time to an accuracy."""
        return self.budget is not None or self.accurate


class Goal(NamedTuple):
    """Whether readings to come reach an accuracy.

    reached : at the sizes as they are; surely : were these as much larger as they may yet turn out to be
    """

    reached: Callable[[Places], bool]
    surely: Callable[[Places], bool]


class Clock(NamedTuple):
    """Seconds to mount set-ups, and for one reading with the usual way to it.  mounted : which is; None for none"""

    observation: Observation
    mounted: int | None

    def mounting(self, setups: Iterable[int]) -> Array:
        """Return the seconds to mount each of some set-ups, (m,)."""
        described = self.observation.setups
        return np.array([0.0 if setup == self.mounted else described[setup].setup_time for setup in setups])

    def reading(self, setups: Iterable[int]) -> Array:
        """Return the seconds of a reading of each of some set-ups, (m,)."""
        of, described = self.observation.errors, self.observation.setups
        return np.array([_reading_with_way(of, _moved(of, described[setup])) for setup in setups])


def _moved(machine: Machine, setup: Setup) -> Setup:
    """Return what of a set-up its ways follow from: of those that move alike they are found once."""
    free = setup.contact == "free" and setup.chart is None
    park = tuple(sum(axis.travel) / 2 for axis in machine.axes) if free else setup.park
    return replace(setup, name="", unknowns=(), park=park)


@remembered
def _reading_with_way(of: Machine, setup: Setup) -> float:
    """Return the seconds of a reading of a set-up; the way is that between a few evenly spread readings."""
    sample = spread(of, (setup,), _TYPICAL)
    _, ways = short_way(of, setup, sample.poses, np.zeros_like(sample.poses))
    return reading_seconds(setup) + float(ways.mean())


def clock(task: Task) -> Clock:
    """Return what set-ups and readings of a task take."""
    return Clock(task.observation, None if task.here is None else int(task.here.setups[0]))


_LOOKS = 400
"""Places at which a climb looks, roughly: stencils around five places, then lines."""
_CALLS = 2e7
"""Operations that a climb's calls into numpy are worth, however few unknowns there are."""


class Patience:
    """How much work is left, in floating point operations.  left : of them"""

    def __init__(self, work: float) -> None:
        self.left = work

    @property
    def spent(self) -> bool:
        """Whether there is none left."""
        return self.left <= 0

    def take(self, work: float) -> None:
        """Take off what has been done."""
        self.left -= work


def work_of_climb(size: int, seen: int) -> float:
    """Return the operations that one climb takes, roughly: rows (size,) times [F, C Vᵀ] of `seen` columns."""
    return _CALLS + 2.0 * _LOOKS * size * seen
