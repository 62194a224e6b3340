"""The mathematics that a campaign's description stands for: the error model, the set-ups, and the yardstick."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import accumulate

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.description.target import POSES
from axiscal.description.usual import rescaled_machine
from axiscal.errors.gauge import MANY_READINGS, unseen_factor
from axiscal.errors.volume import Alignment, Volume, even_poses
from axiscal.estimation.accuracy.yardstick import Yardstick
from axiscal.estimation.intervals import as_shown
from axiscal.estimation.promise.causes import contributions
from axiscal.measurement.candidates import corners, spread
from axiscal.measurement.instruments.distance import TURNS
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Place, Places, Reading
from axiscal.measurement.reading_rows import seen
from axiscal.measurement.setup import Setup
from axiscal.measurement.travel import reading_seconds, way_seconds
from axiscal.numerics import Array
from axiscal.numerics.remembered import Memo
from axiscal_core.criterion import Goal
from axiscal_core.eigen import root_of
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal
from axiscal_core.state import State
from axiscal_core.theta import Kind, Sizes
from axiscal_core.threads import one_thread
from axiscal_core.usual import sizes_of

_FEWEST, _MOST, _PER_UNKNOWN = 200, 1500, 4
_EACH = 20
"""Places of each set-up at least: of 200 alike four each left 3.8 um between them, and these 0.1 um."""
_STAYS = 1e-8
_MOSTLY = 0.5
_QUICK = 32
"""Poses that stand for the volume in ratios of variances: twice as many change U by 0.1 %."""
_YARDSTICKS = 4
"""The case as stated, as learnt, with bands and with what explains the readings; 1,000 unknowns take 50 MB each."""
Columns = tuple[int, int, int]
NO_GOAL = Goal(np.zeros((0, 0)))
"""Where only the belief is asked for."""


@dataclass(frozen=True, eq=False, slots=True)
class Knowledge:
    """What is known while a machine is read: the map to readings and the belief over its unknowns.

    belief : over the columns of the observation, then rests; cells : the rest and the cell of each of these
    A reading opens the rest of each cell that it meets: reading there again does not average the rest away.
    """

    observation: Observation
    belief: Normal
    cells: Sequence[tuple[int, int]] = ()

    def state(self, goal: Goal) -> State:
        """Return the same as a planner has it."""
        return State(self.belief.factor, goal, self.observation.rests, cells=self.cells)

    @one_thread()
    def read(self, readings: Sequence[Reading]) -> Knowledge:
        """Return what is known after readings."""
        numbers, values = seen(self.observation, readings)
        opened, before = self.state(NO_GOAL).opened(numbers), self.belief
        mean = np.pad(before.mean, (0, len(opened.root) - before.size))
        belief = Normal.of_factor(mean, opened.root, before.degrees)
        cells = [(rest, cell) for rest, cell in opened.cells.tolist()]
        return Knowledge(self.observation, belief.read(opened.wide(numbers), values, numbers.noise**2), cells)


@dataclass(frozen=True, eq=False)
class Case:
    """What does not change while measuring: the error model, the set-ups, and the yardstick of the volume.

    inherited : the prior of the errors where an earlier campaign left one
    both : set-ups that were read from both sides, or from sides that nobody stated, whatever their description allows
    about : (k,) errors and unknowns about which readings are linearised; None for the nominal machine
    yardsticks, volumes : found so far, of all cases that are made from this one: after every few readings there is one
    sized_from : the case before its sizes were learnt, whose yardstick it has but for the rests; None for itself
    """

    description: CampaignDescription
    inherited: Normal | None = None
    both: frozenset[str] = frozenset()
    about: Array | None = None
    yardsticks: Memo = field(default_factory=partial(Memo, _YARDSTICKS), repr=False)
    volumes: Memo = field(default_factory=partial(Memo, _YARDSTICKS), repr=False)
    sized_from: Case | None = field(default=None, repr=False)

    @cached_property
    def sizes(self) -> Sizes:
        """The sizes that readings may teach."""
        described = self.description
        return sizes_of(
            described.machine,
            [each.name for each in described.setups],
            described.sure,
            usual=described.usual,
            inherited=self.inherited is not None,
            wandering=[each.name for each in described.setups if each.drift > 0],
        )

    def seconds_along(self, before: Place | None, places: Sequence[Place]) -> Array:
        """Return the time of each reading after the one before it, (m,) s: all ways of a set-up at once."""
        ways: dict[str, list[tuple[int, Place, Place]]] = {}
        seconds = np.zeros(len(places))
        for index, (last, place) in enumerate(zip((before, *places), places, strict=False)):
            if last is None or last.setup != place.setup:
                setup = self.description.setup(place.setup)
                seconds[index] = setup.setup_time + reading_seconds(setup)
            else:
                ways.setdefault(place.setup, []).append((index, last, place))
        for name, mine in ways.items():
            numbers, here, there = zip(*mine, strict=True)
            start, stop = (np.array([each.pose for each in ends]) for ends in (here, there))
            sides = np.array([each.approach or np.zeros(stop.shape[1]) for each in there], dtype=float)
            setup = self.description.setup(name)
            ways_there = way_seconds(self.description.machine, setup, start, stop, sides)
            seconds[list(numbers)] = ways_there + reading_seconds(setup)
        return seconds

    def rescaled(self, sizes: Mapping[tuple[Kind, str], float]) -> Case:
        """Return the case with priors and noise at other sizes.  sizes : factors by kind and owner"""
        machine = rescaled_machine(self.description.machine, sizes)
        setups = list[Setup]()
        for setup in self.description.setups:
            times = sizes.get(("noise", setup.name), 1.0)  # one step of a coarse display, read again, tells of no noise
            setups.append(replace(setup, noise=setup.noise * (max(times, 1.0) if setup.coarse else times)))
        described = replace(self.description, machine=machine, setups=tuple(setups))
        return replace(self, description=described, both=frozenset(), sized_from=self.sized_from or self)

    def _found_at(self, places: Iterable[tuple[float, ...] | None]) -> Case:
        """Return the case with its set-ups found where they are said to stand, None of one that is not."""
        pairs = zip(self.description.setups, places, strict=True)
        setups = tuple(replace(setup, found=place) for setup, place in pairs)
        return replace(self, description=replace(self.description, setups=setups))

    @property
    def bends(self) -> bool:
        """Whether only readings can tell where a set-up stands or how it is turned: they are not linear in that."""
        pairs = [(setup, {unknown.name for unknown in setup.unknowns}) for setup in self.description.setups]
        return any(_located_by(setup, names) is not None or names & {*TURNS} for setup, names in pairs)

    def located(self, mean: Array) -> Case | None:
        """Return the case about the stations of distances and the turns of trackers as found; None if these stay."""
        found = [self._found(index, mean) for index in range(len(self.description.setups))]
        stays = found == [setup.found for setup in self.description.setups]
        return None if stays else replace(self._found_at(found), both=frozenset())

    def turned(self, names: Sequence[str]) -> Case:
        """Return the case of a machine of which some axes, by name, count the other way."""
        before = self.description.machine
        axes = tuple(axis.turned if axis.name in names else axis for axis in before.axes)
        machine = replace(before, axes=axes)
        setups = tuple(replace(setup, machine=machine) for setup in self.description.setups)
        return replace(self, description=replace(self.description, machine=machine, setups=setups))

    def shown_by(self, readings: Sequence[Reading]) -> Case:
        """Return the case with the steps of displays that readings show; itself where all are stated."""
        stated = self.description.setups
        setups = as_shown(stated, readings) if len(readings) > 2 else stated  # two are any step apart
        return self if setups == stated else replace(self, description=replace(self.description, setups=setups))

    def linear_as(self, other: Case) -> Case:
        """Return the case with readings linearised where another case of the same set-ups has them."""
        return replace(self._found_at(setup.found for setup in other.description.setups), about=other.about)

    def linear_about(self, mean: Array) -> Case:
        """Return the case with readings linearised about a mean.  mean : (size,) of all unknowns, cells last"""
        point = mean[: self.observation.size].copy()
        return replace(self.located(mean) or self, about=point, both=frozenset())

    def station_columns(self, index: int) -> tuple[Columns, ...]:
        """Return the columns of where each of a set-up's stations is found, x, y, z; none where they are not to be."""
        setup, columns = self.description.setups[index], self.observation.unknowns_of(index).tolist()
        own = dict(zip((unknown.name for unknown in setup.unknowns), columns, strict=True))
        names = _located_by(setup, set(own))
        if names is None or not setup.standing or names == TURNS or not set(names) <= set(own):
            return ()
        each = iter(names)
        return tuple((own[x], own[y], own[z]) for x, y, z in zip(each, each, each, strict=True))

    def _found(self, index: int, mean: Array) -> tuple[float, ...] | None:
        setup = self.description.setups[index]
        columns = dict(zip((u.name for u in setup.unknowns), mean[self.observation.unknowns_of(index)], strict=True))
        names = _located_by(setup, set(columns))
        if names is None:
            return setup.found
        found = tuple(float(columns.get(name, 0.0)) for name in names)
        before = setup.found or (0.0,) * len(found)
        moved = max(abs(new - old) for new, old in zip(found, before, strict=True))
        return setup.found if moved < _STAYS else found

    @property
    def errors(self) -> Machine:
        """The error model of the machine."""
        return self.description.machine

    @cached_property
    def observation(self) -> Observation:
        """The map from all unknowns to readings, before any cell is visited."""
        return Observation(self.errors, self.description.setups, self.about)

    @cached_property
    def prior(self) -> Normal:
        """The belief before the first reading."""
        covariance, errors = self.observation.prior_covariance(), self.errors.size
        mean = np.zeros(len(covariance))
        if self.inherited is not None:
            mean[:errors], covariance[:errors, :errors] = self.inherited.mean, self.inherited.covariance
        return Normal.of_factor(mean, root_of(covariance))

    @property
    def knowledge(self) -> Knowledge:
        """What is known before the first reading."""
        return Knowledge(self.observation, self.prior)

    @cached_property
    def lattice(self) -> Places:
        """Candidates spread over everything that is allowed."""
        if self.sized_from is not None:
            return self.sized_from.lattice
        count = int(np.clip(_PER_UNKNOWN * self.observation.size, _FEWEST, _MOST))
        setups = self.description.setups
        return spread(self.description.machine, setups, max(count, _EACH * len(setups)))

    @cached_property
    def yardstick(self) -> Yardstick:
        """The figures over the target's volume; a constant shift that is mostly unseen is not counted."""
        if self.sized_from is not None:
            return replace(replace(self.sized_from, both=self.both).yardstick, errors=self.errors)
        described = self.description
        grounds = self.errors, described.target, described.setups, described.usual, self.both, self.inherited
        return self.yardsticks.answer(grounds, self._found_yardstick)

    def _found_yardstick(self) -> Yardstick:
        machine = self.errors
        grounds = (
            replace(machine, errors=tuple(replace(each, rest=0.0) for each in machine.stated)),
            self.description.target,
        )
        volume = self.volumes.answer(grounds, self._found_volume)
        factor, left = self.prior.factor, self._left
        unseen = left[:, : factor.shape[1]]
        # Tilts count about the middle of the volume: where the machine's zero lies is no matter.
        mean = volume.moments.mean.copy()
        mean[:, self.errors.tilts] = 0.0
        before, after = (np.sum((mean @ f) ** 2, axis=1) for f in (factor[: self.errors.size], unseen))
        x, y, z = (bool(hidden) for hidden in after > _MOSTLY * before)
        return Yardstick(volume, self.errors, unseen, left, (x, y, z))

    @cached_property
    def yardstick_as_sized(self) -> Yardstick:
        """The same with what endless readings leave of errors, and nothing sees, as large as they are here."""
        found, left = self.yardstick, self.yardstick.left if self.sized_from is None else self._left
        return replace(found, unseen=left[:, : found.unseen.shape[1]], left=left)

    def _found_volume(self) -> Volume:
        """Return the target's volume.

        Along one axis there is nothing that the part could lie askew to: a rigid motion never counts.
        """
        target, machine = self.description.target, self.description.machine
        part = target.part
        sample = even_poses(target.volume, POSES) if part is None else part.poses(machine)
        aligned = target.aligned or len(machine.axes) == 1
        alignment = Alignment(self.errors, sample, target.counted) if aligned else None
        ends = corners(target.volume) if alignment is None and part is None else None
        return Volume(self.errors, sample, target.counted, alignment, ends)

    @cached_property
    def about_volume(self) -> Array:
        """G (size, size): zᵀG z is in proportion to the mean square of the deviation by errors z, less its mean."""
        low, high = np.array(self.description.target.volume).T
        poses = np.random.default_rng(0).uniform(low, high, (_QUICK, len(low)))
        rows = self.errors.rows_at(poses, np.ones_like(poses))[:, list(self.description.target.counted)]
        off: Array = (rows - rows.mean(axis=0)).reshape(-1, self.errors.size)
        return off.T @ off

    def index(self, setup: str) -> int:
        """Return the index of a set-up by name; raises DescriptionError."""
        return self.description.setups.index(self.description.setup(setup))

    def came_as_allowed(self, reading: Reading) -> bool:
        """Whether the moving axes with a reversal to show came from sides that the set-up allows."""
        setup = self.description.setup(reading.setup)
        sides = (1, -1) if setup.name in self.both else setup.sides
        sided, reversing = setup.sided, self.errors.reversing
        return all(reading.approach[k] in sides for k in sided if k in reversing)

    @cached_property
    def _allowed(self) -> Places:
        """Places spread over all that is allowed."""
        setups = tuple(replace(s, approach="both") if s.name in self.both else s for s in self.description.setups)
        return spread(self.description.machine, setups, len(self.lattice)) if self.both else self.lattice

    def allowed_rows(self) -> tuple[Array, Array]:
        """Return the rows of readings there, each over its noise, (m, size), and that noise, (m,)."""
        numbers = self.observation.numbers(self._allowed)
        noise = np.sqrt(self.observation.variances(numbers))
        return numbers.rows / noise[:, None], noise

    @property
    def _left(self) -> Array:
        """F (errors, r) with F Fᵀ what endless readings leave of errors; its last columns are what type B does to them.

        With F of the unseen alone the gain of many readings is F Fᵀ Hᵀ R⁻¹.
        """
        causes = contributions(self.observation, self._allowed, usual=self.description.usual)
        rows, noise = self.allowed_rows()
        unseen = unseen_factor(self.prior.factor, rows)
        shown = [rows.T @ (each.effects / noise) * (MANY_READINGS / len(rows)) for each in causes]
        moved = [unseen @ (unseen.T @ each) for each in shown]
        return np.column_stack([unseen, *moved])[: self.errors.size]


def _located_by(setup: Setup, unknowns: set[str]) -> tuple[str, ...] | None:
    """Return the unknowns that say where a set-up's station is found, or how it is turned; None where it is linear.

    The centre of a bar is where its ball is found; what touches a ball is linear in where that stands.
    """
    if setup.artefact is None:
        names = setup.located
        return names if set(names) & unknowns else None
    if setup.length is None or setup.artefact.calibrated is not None:
        return None
    ball = setup.artefact.balls[setup.balls[0]].name
    return tuple(f"{ball}_{axis}" for axis in "xyz")


@dataclass(frozen=True, slots=True)
class Timed:
    """Readings with their times.

    readings : with the time of the plan where no clock was read
    ends : (m,) seconds of machine time after each: mounting, travel, settling, reading
    """

    readings: tuple[Reading, ...] = ()
    ends: tuple[float, ...] = ()

    @property
    def seconds(self) -> float:
        """The seconds of machine time that all of them take."""
        return self.ends[-1] if self.ends else 0.0


def timed(case: Case, readings: Sequence[Reading]) -> Timed:
    """Return readings with their times."""
    ends = tuple(accumulate(case.seconds_along(None, readings).tolist()))
    pairs = zip(readings, ends, strict=True)
    return Timed(tuple(r if r.time is not None else replace(r, time=now) for r, now in pairs), ends)


def elapsed(case: Case, before: Timed, places: Sequence[Place]) -> float:
    """Return the seconds that have gone when places are read after readings, in this order."""
    here = before.readings[-1].place if before.readings else None
    return sum(case.seconds_along(here, places).tolist(), before.seconds)
