"""A machine and the instruments on it, as one linear map of all unknowns: y = h + H x + v.

The unknowns x are the coefficients of the machine's errors, then what each instrument leaves open of itself. Detail
finer than a spline, its rest, is one value in each short cell of the travel. Readings in that cell share it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, partial
from itertools import accumulate, pairwise
from typing import Any, Literal, NamedTuple

import numpy as np

from axiscal_core.criterion import INDICES, Criterion, Goal, goal, joint, observability, volume
from axiscal_core.instrument import At, Instrument, refuse_what_is_not_analytic, sight
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal
from axiscal_core.places import Places, Readings
from axiscal_core.points import even_points
from axiscal_core.refusals import Array, InputError, each_once, finite, listed, one, one_of, whole
from axiscal_core.theta import SURE, Sizes, Sure
from axiscal_core.units import Of, quantities, si
from axiscal_core.usual import as_usual, sizes_of

Table = Mapping[str, Sequence[object]]
"""Readings as columns, see `Case.readings`; a DataFrame is one."""
CANDIDATES = 800
"""Even places: with twice as many J of eight drawn plans falls by up to a tenth, of six of them by less than 1 %."""


class Numbers(NamedTuple):
    """All numbers of readings, in the order of the places.

    rows : (n, size); shown : (n,) at the machine where they are linear; reach : (n, curves) of each curve's rest
    cell : (n, curves) in which of its cells; noise : (n,); place, setup : (n,) which; part : (n,) which of the reading
    type_b : (n, c) what one standard deviation of each cause does
    """

    rows: Array
    shown: Array
    reach: Array
    cell: np.ndarray
    noise: Array
    place: np.ndarray
    setup: np.ndarray
    part: np.ndarray
    type_b: Array

    def at(self, which: np.ndarray) -> Numbers:
        """Return some of them."""
        return Numbers(*(each[which] for each in self))


class Model:
    """What does not change while a machine is measured; arguments are those of `Case`."""

    def __init__(
        self, machine: Machine, instruments: Sequence[Instrument], *, usual: Literal["on", "off"] = "on",
        sure: Sure = "well", aligned: bool = True,
    ) -> None:  # fmt: skip
        one("Case", "machine", machine, Machine, "Machine(axes, errors)")
        if not machine.size:
            raise InputError("Case", "machine", "has no errors", "Name those that it may have: Machine(axes, errors)")
        self.usual = one_of("Case", "usual", usual, ("on", "off")) == "on"
        self.sure: Sure = sure
        one_of("Case", "sure", sure, [*SURE])
        self.aligned, self.stated = one("Case", "aligned", aligned, bool, "True or False"), machine
        self.machine = as_usual(machine) if self.usual else machine
        self.instruments = tuple(listed("Case", "instruments", instruments))
        self.setups = [self._mounted(each) for each in self.instruments]
        each_once("Case", "instruments", self.setups)

    def _mounted(self, instrument: Instrument) -> str:
        """Return the name of an instrument that can be mounted here."""
        one("Case", "instruments", instrument, Instrument, "Laser('laser', 'X'), or an object of your own class")
        known = ", ".join(self.machine.axis_names)
        for name in (*instrument.moves, *instrument.park):
            if name not in self.machine.axis_names:
                where, argument = type(instrument).__name__, "park" if name in instrument.park else "moves"
                raise InputError(where, argument, f"names an axis {name!r} that is not there", f"Axes are {known}")
        if not instrument.moves:
            raise InputError(type(instrument).__name__, "moves", "names no axis", f"Axes are {known}")
        if taken := {*self._columns} & {*instrument.names}:
            raise InputError(type(instrument).__name__, "names", f"hold {min(taken)!r}, a column", "Take another name")
        some = self.lattice_of(instrument, 1000)  # for an unknown may count at few places, as of a polygon's face
        frames, still = self.machine.frames(some.poses), np.zeros((len(some.poses), 3))
        at = At(some.poses, some.sides, frames.tcp, frames.tool, still, still)
        refuse_what_is_not_analytic(instrument, at)
        return instrument.name

    @cached_property
    def _columns(self) -> tuple[str, ...]:
        """The columns of a table of readings, beside their numbers."""
        axes = self.machine.axis_names
        return "instrument", *axes, *(f"{name}_side" for name in axes), "std", "time"

    @cached_property
    def own(self) -> list[slice]:
        """The columns of each instrument's unknowns, behind the coefficients of the machine."""
        ends = accumulate((len(each.own) for each in self.instruments), initial=self.machine.size)
        return [slice(*pair) for pair in pairwise(ends)]

    @cached_property
    def size(self) -> int:
        """The number of unknowns."""
        return int(self.own[-1].stop)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The name of every unknown: "EXX[3]", "laser.zero"."""
        each = ((part.name, part.columns) for part in self.machine.parts)
        errors = [f"{name}[{i}]" for name, columns in each for i in range(columns.stop - columns.start)]
        return (*errors, *(f"{each.name}.{unknown}" for each in self.instruments for unknown in each.own))

    @cached_property
    def causes(self) -> tuple[str, ...]:
        """The name of every cause of type B: "laser.warmer"."""
        return tuple(f"{each.name}.{cause}" for each in self.instruments for cause in each.considered)

    @cached_property
    def sizes(self) -> Sizes:
        """The sizes that readings may teach."""
        return sizes_of(self.machine, self.setups, self.sure, usual=self.usual)

    @cached_property
    def prior(self) -> Normal:
        """What is known before any reading."""
        covariance = np.zeros((self.size, self.size))
        covariance[: self.machine.size, : self.machine.size] = self.machine.covariance()
        tail = np.arange(self.machine.size, self.size)
        covariance[tail, tail] = [std**2 for each in self.instruments for std in each.own.values()]
        return Normal(np.zeros(self.size), covariance)

    @cached_property
    def volume(self) -> Goal:
        """The criterion "volume"."""
        return volume(self.machine, self.size, self.aligned)

    def goal(self, criterion: Criterion, function: str) -> Goal:
        """Return what a criterion says."""
        words: dict[str, Callable[[], Goal]] = {name: partial(self._observability, name) for name in INDICES}
        words |= {"volume": lambda: self.volume, "joint": lambda: joint(self.machine, self.size)}
        return goal(criterion, self.size, words, function)

    def _observability(self, index: str) -> Goal:
        n = self.numbers(self.lattice())
        seen = self.prior.read(n.rows, n.shown, n.noise**2).covariance
        return observability(index, self.prior.covariance, seen)

    def checked(self, places: Places | Readings, function: str, argument: str = "places") -> Places:
        """Return the places, on instruments and within the travel of this case."""
        given = places.places if isinstance(places, Readings) else places
        found = one(function, argument, given, Places, "Places(instrument, poses)")
        for name in found.instruments:
            one_of(function, argument, name, self.setups)
        self.machine.poses(found.given, function)
        if isinstance(places, Readings) and places.std is not None:
            of = [self.instruments[self.setups.index(name)].units for name in found.instruments]
            quantities(places.given_std, function, "std", (len(found),), of, posed=True)
        return found

    def numbers(self, places: Places | Readings, about: Array | None = None) -> Numbers:
        """Return all numbers of readings, linear at some unknowns.  about : (size,), zero where not given"""
        found = places.places if isinstance(places, Readings) else places
        setup = np.array([self.setups.index(name) for name in found.instruments], dtype=np.intp)
        first = np.cumsum([0, *(len(each.considered) for each in self.instruments)])
        parts = []
        for i, instrument in enumerate(self.instruments):
            mine = np.flatnonzero(setup == i)
            if not len(mine):
                continue
            at = (None, None) if about is None else (about[: self.machine.size], about[self.own[i]])
            shown = sight(instrument, self.machine, found.poses[mine], found.sides[mine], *at)
            m, k, _ = shown.errors.shape
            rows, causes = np.zeros((m, k, self.size)), np.zeros((m, k, len(self.causes)))
            rows[:, :, : self.machine.size], rows[:, :, self.own[i]] = shown.errors, shown.own
            causes[:, :, first[i] : first[i + 1]] = shown.type_b
            cells = np.broadcast_to(self.cells(found.poses[mine])[:, None], shown.reach.shape)
            noise = np.tile(instrument.sigma, (m, 1))
            if isinstance(places, Readings) and places.std is not None:
                noise = np.tile(places.std[mine, None], (1, k))
            noise = np.sqrt(noise**2 + shown.blind)
            each = [rows, shown.shown, shown.reach, cells, noise, np.tile(mine[:, None], (1, k)), np.full((m, k), i)]
            each += [np.tile(np.arange(k), (m, 1)), causes]
            parts.append([part.reshape(m * k, *part.shape[2:]) for part in each])
        joined = [np.concatenate(each) for each in zip(*parts, strict=True)]
        order = np.argsort(joined[5], kind="stable")
        return Numbers(*(each[order] for each in joined))

    @cached_property
    def none(self) -> Numbers:
        """The numbers of no reading."""
        return self.numbers(self.lattice_of(self.instruments[0], 2)).at(np.zeros(0, dtype=np.intp))

    def taken(self, after: Readings | Places | None, function: str) -> Numbers:
        """Return the numbers of readings that are there."""
        return self.none if after is None or not len(self.checked(after, function, "after")) else self.numbers(after)

    def shows(self, places: Places, x: Array) -> Normal:
        """Return what readings show of unknowns x (size,), nothing linearised, with noise and rests."""
        n = self.numbers(self.checked(places, "Case.shows"), finite("Case.shows", "x", x, (self.size,)))
        return Normal(n.shown, self.shared(n, n) + np.diag(n.noise**2))

    def values(self, readings: Readings, function: str) -> Array:
        """Return the values of readings, one for each number, (n,)."""
        one(function, "readings", readings, Readings, "Readings(places, values)")
        self.checked(readings, function, "readings")
        names = readings.places.instruments
        units = [(unit,) for name in names for unit in self.instruments[self.setups.index(name)].units]
        if len(units) != len(readings.values):
            what = f"hold {len(readings.values)} values of {len(units)} numbers"
            raise InputError(function, "readings", what, "Give all numbers, in the order of the places")
        return quantities(readings.given, function, "values", (None,), units)

    def cells(self, poses: Array) -> Array:
        """Return in which cell each term's rest is, (m, terms)."""
        cells = [term.cells(*term.at(poses)) for term in self.machine.terms]
        return np.array(cells, dtype=np.float64).reshape(len(cells), len(poses)).T

    def shared(self, first: Numbers, second: Numbers) -> Array:
        """Return the covariance of rests between numbers, (n, m): readings in one cell share its value."""
        total = np.zeros((len(first.rows), len(second.rows)))
        for i, term in enumerate(self.machine.terms):
            if term.rest:
                alike = first.cell[:, i, None] == second.cell[:, i]
                total += term.rest**2 * alike * np.outer(first.reach[:, i], second.reach[:, i])
        return total

    def taken_from(self, readings: Readings | Table, function: str, argument: str = "readings") -> Readings:
        """Return readings, those of a table as well."""
        if isinstance(readings, Readings):
            return readings
        if not isinstance(readings, Mapping) and not hasattr(readings, "columns"):
            raise InputError(function, argument, f"= {readings!r} are none", "Give Readings, or a DataFrame")
        return self.readings(readings)

    def readings(self, table: Table) -> Readings:
        """Return readings of a table, such as a DataFrame.

        table : columns "instrument", each axis, those of the instrument's numbers; with sides "X_side", "std", "time"
        """
        known = ", ".join(needed := ("instrument", *self.machine.axis_names))
        for name in needed:
            if name not in table:
                raise InputError("Case.readings", "table", f"has no column {name!r}", f"It needs {known}")
        every = [*dict.fromkeys((*self._columns, *(number for each in self.instruments for number in each.names)))]
        for name in table:
            one_of("Case.readings", "table", name, every)
        names = [str(name) for name in np.ravel(np.array(table["instrument"], dtype=object))]

        def given(name: str) -> list[Any]:
            found = np.ravel(np.array(table[name], dtype=object)).tolist()
            if len(found) != len(names):
                what = f"has {len(found)} values of {len(names)} readings"
                raise InputError("Case.readings", name, what, "Give one for each")
            return found

        def column(name: str, of: Of) -> Array:
            found = given(name) if name in table else [0.0] * len(names)
            return quantities(found, "Case.readings", name, (len(names),), [of], posed=True)

        poses, sides = (np.stack([column(a.name + e, a.of) for a in self.machine.axes], 1) for e in ("", "_side"))
        places = self.checked(Places(names, poses, sides), "Case.readings", "instrument")
        values = list[float]()
        for i, name in enumerate(names):
            instrument = self.instruments[self.setups.index(name)]
            for number, unit in zip(instrument.names, instrument.units, strict=True):
                if number not in table:
                    raise InputError("Case.readings", "table", f"has no column {number!r}", f"{name} shows it", i)
                values.append(si(given(number)[i], "Case.readings", number, (unit,), i))
        std, time = (given(what) if what in table else None for what in ("std", "time"))
        return Readings(places, values, std, time)

    def table(self, places: Places | Readings) -> dict[str, list[object]]:
        """Return places or readings as columns: `pandas.DataFrame(case.table(plan.places))`."""
        found = self.checked(places, "Case.table")
        columns: dict[str, list[object]] = {"instrument": [*found.instruments]}
        columns |= {name: found.poses[:, k].tolist() for k, name in enumerate(self.machine.axis_names)}
        columns |= {f"{name}_side": found.sides[:, k].tolist() for k, name in enumerate(self.machine.axis_names)}
        if isinstance(places, Readings):
            values = iter(self.values(places, "Case.table").tolist())
            for i, setup in enumerate(found.instruments):
                for number in self.instruments[self.setups.index(setup)].names:
                    columns.setdefault(number, [float("nan")] * len(found))[i] = next(values)
            for what, given in (("std", places.std), ("time", places.time)):
                columns |= {} if given is None else {what: given.tolist()}
        return columns

    def lattice(self, count: int = CANDIDATES) -> Places:
        """Return even places in the travel of what each instrument moves, from the sides it may be read from."""
        each = max(whole("Case.lattice", "count", count, 1) // len(self.instruments), 2)
        parts = [self.lattice_of(instrument, each) for instrument in self.instruments]
        return sum(parts[1:], parts[0])

    def lattice_of(self, instrument: Instrument, count: int) -> Places:
        """Return even places of one instrument."""
        axes, machine = [self.machine.axis_names.index(name) for name in instrument.moves], self.machine
        where = type(instrument).__name__
        parked = [si(instrument.park.get(a.name, sum(a.travel) / 2), where, "park", a.of) for a in machine.axes]
        poses, sides = np.tile(machine.poses([parked], where), (count, 1)), np.zeros((count, len(machine.axes)))
        ways = len(instrument.sides)
        even = even_points(count, len(axes))
        if len(axes) == 1:  # both ends are places as good as any, and each place is read from every side
            even = (np.arange(count)[:, None] // ways) / max((count - 1) // ways, 1)
        for j, k in enumerate(axes):
            low, high = machine.axes[k].travel
            poses[:, k] = low + even[:, j] * (high - low)
            sides[:, k] = np.resize(instrument.sides, count)
        return Places(instrument.name, poses, sides)
