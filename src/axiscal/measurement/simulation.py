"""Virtual machines with a hidden truth: drawn from the prior, or given as curves that the model need not contain.

Readings come from the full non-linear kinematics, so what is estimated is never simulated by the formula that
estimates it.

A file of curves has the columns `error,position_mm,value_um`; `position_deg` for rotary axes, `value_urad` for angles.
One file may hold both kinds: then exactly one position column and one value column are filled in each line.  A location
error is one line, its position empty.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import count, pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from axiscal.exceptions import DescriptionError, ReadingError
from axiscal.machine.error_names import error_named
from axiscal.machine.kinematics import Deviation, actual_deviation, composed
from axiscal.measurement.observation import owned
from axiscal.measurement.readers.columns import ANGLES, LENGTHS, TEXT
from axiscal.measurement.readers.csv_table import Row, table_of
from axiscal.measurement.readers.text_file import read_text
from axiscal.measurement.reading import Place, Reading
from axiscal.measurement.setup import Setup
from axiscal.measurement.travel import SHORTEST, belongs, feet_of
from axiscal.numerics import Array
from axiscal_core.causes import MEMORY
from axiscal_core.eigen import unique_root
from axiscal_core.errors import Error
from axiscal_core.machine import Machine
from axiscal_core.refusals import one, whole
from axiscal_core.terms import Term

_LAYOUT = {"error": TEXT, "position": LENGTHS + ANGLES, "value": LENGTHS + ANGLES}


class TruthCurve(NamedTuple):
    """One error: positions (n,) m or rad, increasing; values (n,) m or rad.  A constant has one position, 0."""

    positions: Array
    values: Array


def read_truth(path: str | Path) -> dict[str, TruthCurve]:
    """Read the curves of a file by canonical error name, in the order of the file; raises ReadingError."""
    table = table_of(read_text(path)).allow(_LAYOUT)
    table.one_of("error", "error")
    for stem, example in (("position", "position_mm"), ("value", "value_um")):
        if not table.all_of(stem):
            table.one_of(stem, example)
    curves: dict[str, list[tuple[float, float]]] = {}
    for row in table.rows:
        try:
            name = error_named(row.of("error").text)
        except DescriptionError as fault:
            raise row.fail(fault.what, fault.remedy) from None
        points = curves.setdefault(name.name, [])
        points.append(_point(row, name, points))
    return {name: TruthCurve(*np.array(points).T) for name, points in curves.items()}


def _point(row: Row, name: Error, before: list[tuple[float, float]]) -> tuple[float, float]:
    """Return where a line says an error's value, and that; 0 of a constant.  before : the error's points above"""
    position, value = row.of("position"), row.of("value")
    if not value.text or (not position.text and (name.kind == "motion" or before)):
        remedy = "write both; only a constant, given in one line, goes without a position"
        raise row.fail("{name} has no position or no value here", remedy, name=name.name)
    cells = [(value, name.angular)] + [(position, name.axis[0] in "ABC")] * bool(position.text)
    for cell, angular in cells:
        if cell.column.dimension != ("angle" if angular else "length"):
            remedy = "the {stem} of {name} is a length: mm or um"
            remedy = "the {stem} of {name} is an angle: deg, urad or arcsec" if angular else remedy
            named = {"column": cell.column.name, "name": name.name, "stem": cell.column.stem}
            raise cell.fail("'{column}' does not fit {name}", remedy, **named)
    at = position.quantity() if position.text else 0.0
    if before and at <= before[-1][0]:
        what = "position {text} of {name} does not lie beyond the one before it"
        remedy = "sort the positions of each error and give each once"
        raise position.fail(what, remedy, text=position.text, name=name.name)
    return at, value.quantity()


Curve = Callable[..., Array]
"""Positions of the error's axis, or of both of its axes, (m,) each -> values (m,), m or rad."""

Wander = Callable[[float], Sequence[float] | Array]
"""Seconds since the campaign began -> how far the zeros (the only one, or one for each number) have moved, m or rad."""


_DRAWN = 3
"""Drifts drawn for a set-up at least, so that one of one number is the same machine as one of three."""
_MINUTE, _DAY = 60.0, 1440
"""s, and minutes of a day: the grid of a drifting zero, which bends over an hour."""


@dataclass(frozen=True, eq=False, slots=True)
class VirtualMachine:
    """A machine whose errors are known to the simulation only.

    model : names the errors it has; curves : one for each; offsets : per set-up name the values of its own unknowns
    drifts : per set-up name how far its zeros have moved after so many seconds
    """

    model: Machine
    curves: tuple[Curve, ...]
    offsets: Mapping[str, Mapping[str, float]]
    drifts: Mapping[str, Wander] = field(default_factory=dict)

    def values(self, poses: Array) -> Array:
        """Return the value of every error at poses (m, q): (terms, m)."""
        pairs = zip(self.model.terms, self.curves, strict=True)
        return np.array([curve(*f.at(poses)) for f, curve in pairs]).reshape(len(self.curves), len(poses))

    def deviation(self, poses: Array, approaches: Array) -> Array:
        """Return the TCP deviation in the workpiece frame, m.  poses, approaches : (m, q); returns (m, 3)."""
        return self.does(poses, approaches).displacement

    def does(self, poses: Array, approaches: Array) -> Deviation:
        """Return how the tool deviates in the workpiece frame.  poses, approaches : (m, q)"""
        return actual_deviation(self.model, poses, composed(self.model, self.values(poses), approaches))

    def read_all(
        self,
        setup: Setup,
        pose: tuple[float, ...],
        approach: tuple[int, ...],
        rng: np.random.Generator,
        seconds: float = 0.0,
    ) -> tuple[float, ...]:
        """Return what the set-up's display would show: the truth, its own unknowns, nothing linearised, drift, noise.

        seconds : since the campaign began
        """
        poses, come = np.array([pose]), np.array([approach], dtype=float)
        at = setup.places(poses, come, deviation=self._done(setup, poses, come))
        shown = setup.shown(at, self.offsets.get(setup.name, {}))[0] + setup.scatter * rng.standard_normal(
            len(setup.names)
        )
        if setup.name in self.drifts:
            shown = shown + np.array(self.drifts[setup.name](seconds))[: len(shown)]
        step, values = setup.resolution, (shown / setup.scales).tolist()
        return tuple(round(value / step) * step if step else value for value in values)

    def measured(
        self,
        setups: Sequence[Setup],
        places: Sequence[Place],
        ends: Iterable[float],
        chance: Iterable[np.random.Generator],
    ) -> tuple[Reading, ...]:
        """Return what is read at places, one after another.

        ends : seconds since the campaign began, for each place; chance : draws the noise of each reading
        """
        mounted, found = {setup.name: setup for setup in setups}, list[Reading]()
        for place, seconds, rng in zip(places, ends, chance, strict=False):
            value, *more = self.read_all(mounted[place.setup], place.pose, place.approach, rng, seconds)
            where = place.setup, place.pose, place.approach
            found.append(Reading(*where, value, others=tuple(more), time=seconds, check=place.check))
        return tuple(found)

    def _done(self, setup: Setup, poses: Array, approaches: Array) -> Deviation:
        """Return what the tool does at places: at the second end of a length against the first.

        Between feet of a level the way differs by its own shape alone, per length between them.
        """
        does, inside = self.does, poses
        if setup.base is not None:
            (axis,), half = setup.moves, max(setup.base, SHORTEST) / 2
            low, high = self.model.axes[axis].travel
            does, inside = partial(self._way, axis), poses.copy()
            inside[:, axis] = np.clip(poses[:, axis], low + half, high - half)
        done = np.zeros((2, len(poses), 3))
        for at, weight in feet_of(setup, inside):
            done += weight * np.array(does(at, approaches))
        return Deviation(*done)

    def _way(self, axis: int, poses: Array, approaches: Array) -> Deviation:
        """Return what the shape of one axis' way alone does to the tool."""
        own = np.array([belongs(term, axis) for term in self.model.terms])
        return actual_deviation(self.model, poses, composed(self.model, self.values(poses) * own[:, None], approaches))


def by_number(seed: int, first: int = 1) -> Iterator[np.random.Generator]:
    """Yield what draws the noise of each reading: by its number alone, so that a run that is resumed is the same."""
    return (np.random.default_rng((seed, number)) for number in count(first))


@dataclass(frozen=True, slots=True)
class Simulator:
    """Makes virtual machines for a machine and its set-ups."""

    machine: Machine
    setups: tuple[Setup, ...]

    def __post_init__(self) -> None:
        one("Simulator", "machine", self.machine, Machine, 'load_machine("dmu60")')
        for setup in one("Simulator", "setups", self.setups, Sequence, "set-ups of a campaign"):
            one("Simulator", "setups", setup, Setup, "set-ups of a campaign")

    def drawn(self, seed: int) -> VirtualMachine:
        """Return a machine whose errors, rests included, are drawn from the prior."""
        model, rng = self.machine, np.random.default_rng((whole("Simulator.drawn", "seed", seed, 0), 1))
        drawn = ((f, unique_root(f.covariance) @ rng.standard_normal(len(f.covariance))) for f in model.terms)
        return VirtualMachine(model, tuple(_rough(f, control, rng) for f, control in drawn), *self._mounted(seed))

    def with_curves(self, curves: Mapping[str, TruthCurve], seed: int, path: Path | None = None) -> VirtualMachine:
        """Return a machine with the given curves, linear between their points; errors that have none are zero.

        path : the file that they are from.  Raises ReadingError for a curve of another machine.
        """
        names, where = {axis.name for axis in self.machine.axes}, "Simulator.with_curves"
        whole(where, "seed", seed, 0)
        for name in one(where, "curves", curves, Mapping, '{"EXX": TruthCurve(…)}'):
            axis = error_named(name).axis
            if axis not in names:
                what = '"{name}" is an error of axis {axis}, which "{machine}" does not have'
                remedy, known = "Take the curve out; the axes are {known}", ", ".join(sorted(names))
                raise ReadingError(what, remedy, path, name=name, axis=axis, machine=self.machine.name, known=known)
        errors = tuple(Error(name, 1.0, period=1.0 if name.endswith("_pitch") else None) for name in curves)
        model = replace(self.machine, errors=errors)
        return VirtualMachine(model, tuple(map(_through, curves.values())), *self._mounted(seed))

    def _mounted(self, seed: int) -> tuple[Mapping[str, Mapping[str, float]], Mapping[str, Wander]]:
        """Return the unknowns of the set-ups and the drifts of their zeros."""
        rng, (unknowns, columns) = np.random.default_rng((seed, 2)), owned(self.setups)
        values = np.array([unknown.std * rng.standard_normal() for unknown in unknowns])
        pairs = zip(self.setups, columns, strict=True)
        offsets = {s.name: dict(zip((u.name for u in s.unknowns), values[of].tolist(), strict=True)) for s, of in pairs}
        rng = np.random.default_rng((seed, 3))
        drifting = {s.name: (s.drift, max(len(s.names), _DRAWN)) for s in self.setups if s.drift > 0}
        return offsets, {name: _wandering(*of, rng) for name, of in drifting.items()}


def _wandering(rate: float, count: int, rng: np.random.Generator) -> Wander:
    """Return a drift drawn minute by minute over a day, and standing still thereafter: its rate is an
    autoregressive process.
    """
    kept = np.exp(-_MINUTE / MEMORY)
    paces = rng.standard_normal((_DAY + 1, count))
    for before, now in pairwise(paces):
        now *= np.sqrt(1 - kept**2)
        now += kept * before
    places = np.vstack([np.zeros(count), np.cumsum(rate * _MINUTE * (paces[:-1] + paces[1:]) / 2, axis=0)])
    minutes = _MINUTE * np.arange(_DAY + 1)

    def moved(seconds: float) -> Array:
        return np.array([np.interp(seconds, minutes, places[:, k]) for k in range(count)])

    return moved


def _through(curve: TruthCurve) -> Curve:
    return lambda at: np.asarray(np.interp(at, curve.positions, curve.values), dtype=float)


def _rough(function: Term, control: Array, rng: np.random.Generator) -> Curve:
    """Return the curve of control values with a rest drawn for each cell.  control : (k,)"""
    cells = function.rest * rng.standard_normal(function.cell_count)

    def curve(*at: Array) -> Array:
        return function.rows(*at) @ control + cells[function.cells(*at)]

    return curve
