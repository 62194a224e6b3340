"""An instrument is one function: the numbers that it shows of a displaced and turned tool, and of unknowns of its own.

    >>> class Grid(Instrument):
    ...     names, units = ("dx", "dy"), ("m", "m")
    ...     noise = 0.1e-6
    ...     unknowns = {"zero_x": "1 mm", "zero_y": "1 mm", "turn": "1 mrad"}
    ...     def sees(self, at, u):
    ...         x, y, _ = (at.tcp + at.moved).T
    ...         return [at.moved[:, 0] + u["zero_x"] - u["turn"] * y, at.moved[:, 1] + u["zero_y"] + u["turn"] * x]
    >>> Grid("grid", "XY")
    <Grid grid: moves X, Y; shows dx, dy>

Rows come from it by complex steps, exact to rounding: f(x + ih)/h has the derivative as its imaginary part, and no
difference is taken. So `sees` may use every analytic function. `length`, `cross` and `angle` are; abs, norm and arctan2
are not, and a real difference finds them when the instrument is mounted in a case.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple, Protocol, TypedDict, Unpack, cast

import numpy as np

from axiscal_core import rigid
from axiscal_core.machine import Machine
from axiscal_core.refusals import Array, InputError, computed, each_once, listed, named, one, one_of, within
from axiscal_core.terms import Term
from axiscal_core.units import SECONDS, WANDER, Quantity, like, quantities, si

Unknowns = Mapping[str, float]
"""Values of an instrument's own unknowns, by name."""
Approach = Literal["both", "+", "-"]
TOOL = ("tool_x", "tool_y", "tool_z")
"""By how much the tool in the spindle is another than the machine states, m."""
_H = 2.0**-100  # a complex step: its square is below rounding, and a power of two rounds nothing itself
_STEP = 1e-6  # of the real difference: errors are microns, and rounding of a metre is 1e-16
_KINK = 0.1  # by so much of it slopes on both sides of a kink differ, and nowhere else those of microns
_ANALYTIC = 1e-4  # by so much of the largest slope both may differ: a second derivative times the step is less


class At(NamedTuple):
    """Places of readings, and the deviations of the machine there, in the frame of the workpiece, which a table turns.

    poses, sides : (m, q); tcp : (m, 3) nominal, m; tool : (m, 3, 3) nominal turn of the tool
    moved, turned : (m, 3) what errors do to the tool point and to the tool, m and rad
    """

    poses: Array
    sides: Array
    tcp: Array
    tool: Array
    moved: Array
    turned: Array

    def tip(self, u: Unknowns) -> Array:
        """Return by how much the tip of a tool has moved that is tool_x, tool_y, tool_z off, (m, 3)."""
        off: Array = self.tool @ np.array([u[name] for name in TOOL])
        return self.moved + rigid.turned(off, self.turned) if off.any() else self.moved


def length(v: Array) -> Array:
    """Return how long vectors are, (m,), analytically.  v : (m, 3)"""
    return np.asarray(np.sqrt(np.sum(np.square(v), axis=1)))


def angle(y: Array, x: Array) -> Array:
    """Return the angle of (x, y), (m,), analytically near the real numbers: what arctan2 is not."""
    away = np.arctan2(np.real(y), np.real(x))
    c, s = np.cos(away), np.sin(away)
    return np.asarray(away + np.arctan((y * c - x * s) / (x * c + y * s)))


class Mounting(TypedDict, total=False):
    """How an instrument is mounted, where its class says otherwise.

    noise : of each number, or of all; unknowns : their standard deviations before any reading
    park : where axes stand that do not move, by name; approach : from which sides it can be read
    drift : how fast its zero wanders, such as "6 um/h"; type_b : standard deviations of what no reading shows
    seconds : of a reading; setup_time : once
    """

    noise: Quantity | Sequence[Quantity]
    unknowns: Mapping[str, Quantity]
    park: Mapping[str, Quantity]
    approach: Approach
    drift: Quantity
    type_b: Mapping[str, Quantity]
    seconds: Quantity
    setup_time: Quantity


class Instrument:
    """One instrument, mounted one way.  Derive from it and write `sees`.

    names, units, noise : of the numbers of a reading; unknowns : of the set-up, each with its standard deviation
    name : of the set-up; moves : axes that move while it is read, "XY" or a list; mounting : see `Mounting`
    """

    names: Sequence[str] = ("value",)
    units: Sequence[str] = ("m",)
    noise: Quantity | Sequence[Quantity] = "1 um"
    unknowns: Mapping[str, Quantity] = {}
    park: Mapping[str, Quantity] = {}
    approach: Approach = "both"
    drift: Quantity = 0.0
    type_b: Mapping[str, Quantity] = {}
    seconds: Quantity = "10 s"
    setup_time: Quantity = "0 s"

    def __init__(self, name: str, moves: str | Sequence[str], **mounting: Unpack[Mounting]) -> None:
        where = type(self).__name__
        self.name = named(where, "name", name)
        axes = re.findall(r"[A-Za-z]\d*", moves) if isinstance(moves, str) else moves
        if not isinstance(axes, Sequence) or not all(isinstance(axis, str) for axis in axes):
            raise InputError(where, "moves", f"= {moves!r} names no axis", 'Give "XY", or a list')
        self.moves = tuple(axes)
        each_once(where, "moves", self.moves)
        for field, value in mounting.items():
            setattr(self, one_of(where, "mounting", field, [*Mounting.__annotations__]), value)
        one_of(where, "approach", self.approach, ("both", "+", "-"))
        each_once(where, "names", listed(where, "names", self.names))
        if len(self.names) != len(listed(where, "units", self.units)):
            raise InputError(where, "units", f"are {len(self.units)} of {len(self.names)} names", "Give one for each")
        for unit in self.units:
            one_of(where, "units", unit, ("m", "rad"))
        for argument in ("unknowns", "type_b", "park"):
            one(where, argument, getattr(self, argument), Mapping, '{"name": "1 mm"}')
        if moving := {*self.park} & {*self.moves}:
            raise InputError(where, "park", f"names {min(moving)}, which moves", "Take it out here, or out of moves")
        for known in (*self.names, *self.unknowns, *self.type_b):
            named(where, "names", known)
        if shared := {*self.unknowns} & {*self.type_b}:
            raise InputError(where, "type_b", f"names the unknown {min(shared)}", "Readings show it, or they do not")
        alone = isinstance(self.noise, str) or np.ndim(self.noise) == 0
        each, count = [self.noise] * len(self.names) if alone else self.noise, (len(self.names),)
        self.sigma = quantities(each, where, "noise", count, [(unit,) for unit in self.units])
        within(where, "noise", float(self.sigma.min()), 0.0, open_end=True)
        usual = {**type(self).unknowns, **type(self).type_b}
        self.own, self.considered = (
            {name: within(where, name, si(std, where, name, like(usual.get(name))), 0.0) for name, std in given.items()}
            for given in (self.unknowns, self.type_b)
        )
        self.wander = within(where, "drift", si(self.drift, where, "drift", WANDER), 0.0)
        self.costs = within(where, "seconds", si(self.seconds, where, "seconds", SECONDS), 0.0)
        self.begins = within(where, "setup_time", si(self.setup_time, where, "setup_time", SECONDS), 0.0)

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return the numbers of a reading, (m,) each, in m or rad.

        u : its own unknowns, and the causes of `type_b`
        """
        raise InputError(type(self).__name__, "sees", "is not written", "Write sees(self, at, u)")

    @property
    def sides(self) -> tuple[float, ...]:
        """From where a moving axis may come."""
        return {"both": (1.0, -1.0), "+": (1.0,), "-": (-1.0,)}[self.approach]

    def __repr__(self) -> str:
        moves, shows = ", ".join(self.moves), ", ".join(self.names)
        return f"<{type(self).__name__} {self.name}: moves {moves}; shows {shows}>"


class Seeing(Protocol):
    """What an instrument is to those who ask what it sees: names of its numbers, and the function."""

    @property
    def names(self) -> Sequence[str]:
        """Of each number of a reading."""

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return the numbers of a reading, (m,) each, in m or rad."""


class Slopes(NamedTuple):
    """Derivatives of what an instrument shows by what the tool is displaced and turned, (m, k, 3) each."""

    moved: Array
    turned: Array


def numbers(instrument: Seeing, at: At, u: Unknowns) -> Array:
    """Return what an instrument shows, (m, k); raises InputError where `sees` gives something else."""
    where = f"{type(instrument).__name__}.sees"
    try:
        found = computed(where, "result", instrument.sees, at, u)
    except InputError as fault:
        if not isinstance(missing := fault.__cause__, KeyError):
            raise
        raise InputError(where, f"u[{missing}]", "is not there", "Name it in unknowns or type_b") from None
    if not isinstance(found, list | tuple) or len(found) != len(instrument.names):
        what, names = f"is {type(found).__name__}", ", ".join(instrument.names)
        raise InputError(where, "result", what, f"Return a list of one array for each of {names}")
    if any(np.asarray(each).dtype.kind not in "iufc" for each in found):
        raise InputError(where, "result", "holds no numbers", f"Return an array of them for each of {instrument.names}")
    try:
        return np.stack([np.broadcast_to(each, len(at.poses)) for each in found], axis=1)
    except ValueError:
        shapes = ", ".join(str(np.shape(each)) for each in found)
        raise InputError(where, "result", f"has shapes {shapes}", f"Give ({len(at.poses)},) each") from None


def slopes(instrument: Seeing, at: At, u: Unknowns) -> Slopes:
    """Return the derivatives by complex steps, exact to rounding."""
    # six readings for each, of which one is displaced or turned along one way
    every = At(*(np.concatenate([part] * 6) for part in at))
    steps = 1j * _H * np.repeat(np.eye(6), len(at.poses), axis=0)
    stepped = every._replace(moved=every.moved + steps[:, :3], turned=every.turned + steps[:, 3:])
    each = np.imag(numbers(instrument, stepped, u)) / _H
    ways = each.reshape(6, len(at.poses), len(instrument.names)).transpose(1, 2, 0)
    return Slopes(ways[:, :, :3], ways[:, :, 3:])


def own_slopes(instrument: Seeing, at: At, u: Unknowns, names: Sequence[str]) -> Array:
    """Return the derivatives by some of its own unknowns, (m, k, names), likewise."""
    result = np.empty((len(at.poses), len(instrument.names), len(names)))
    for column, name in enumerate(names):
        result[:, :, column] = np.imag(numbers(instrument, at, {**u, name: cast("float", u[name] + 1j * _H)}))
    return result / _H


class Sight(NamedTuple):
    """Rows of readings of one instrument, linear at some machine.

    errors : (m, k, n) by coefficients; own : (m, k, u) by its unknowns; type_b : (m, k, c) by causes of standard
    deviation one; reach : (m, k, curves) by each curve's value; shown : (m, k) at the unknowns, nothing linearised
    blind : (m, k) variance of reversals of axes of which nobody knows from where they came
    """

    errors: Array
    own: Array
    type_b: Array
    reach: Array
    shown: Array
    blind: Array


def sight(
    instrument: Instrument, machine: Machine, poses: Array, sides: Array,
    errors: Array | None = None, unknowns: Array | None = None,
) -> Sight:  # fmt: skip
    """Return what readings show.

    poses, sides : (m, q); errors : (n,) of the machine at which it is linear; unknowns : (u,); zero where not given
    """
    frames = machine.frames(poses)
    straight, angular = (machine.rows_at(poses, sides, turning) for turning in (False, True))
    still = np.zeros((2, len(poses), 3))
    moved, turned = still if errors is None else (straight @ errors, angular @ errors)
    at = At(poses, sides, frames.tcp, frames.tool, moved, turned)
    values = np.zeros(len(instrument.own)) if unknowns is None else unknowns
    u = dict(zip(instrument.own, values.tolist(), strict=True)) | dict.fromkeys(instrument.considered, 0.0)
    found = slopes(instrument, at, u)
    own, type_b = (own_slopes(instrument, at, u, [*names]) for names in (instrument.own, instrument.considered))
    # a reversal enters with one half of its value or the other, where nobody knows with either
    known = np.where(sides == 0, 1.0, sides)
    levers = (machine.levers(poses, turning).transpose(2, 0, 1) for turning in (False, True))
    by_moved, by_turned = (machine.effects(each, known).transpose(2, 0, 1) for each in levers)
    reach = found.moved @ by_moved + found.turned @ by_turned
    blind = np.zeros(reach.shape[:2])
    for i, term in enumerate(machine.curves):
        moves = term.kind == "reversal" and machine.axis_names[term.axis] in instrument.moves
        if moves and (unknown := sides[:, term.axis] == 0).any():
            blind[unknown] += (reach[unknown, :, i] * _spread(term, poses[unknown])[:, None]) ** 2
            reach[unknown, :, i] = 0.0
    return Sight(
        found.moved @ straight + found.turned @ angular, own,
        type_b * np.array([*instrument.considered.values()]), reach, numbers(instrument, at, u), blind,
    )  # fmt: skip


def _spread(term: Term, poses: Array) -> Array:
    """Return the standard deviation of a curve and its rest before any reading, (m,)."""
    rows = term.spline.rows(poses[:, term.axis])
    return np.asarray(np.sqrt(np.sum(rows @ term.covariance * rows, axis=1) + term.rest**2))


def refuse_what_is_not_analytic(instrument: Instrument, at: At) -> None:
    """Raise InputError where complex steps and a real difference give other rows.  at : places to try"""
    where, some, poses = type(instrument).__name__, np.array([3e-6, -2e-6, 5e-6]), at.poses
    off = np.zeros((len(poses), 3)) + some  # abs has a slope beside zero only
    at, u = at._replace(moved=off, turned=-off), dict.fromkeys(instrument.own, 3e-6)
    u |= dict.fromkeys(instrument.considered, 3e-6)
    shown = numbers(instrument, at, u)
    if not np.isfinite(shown).all():
        pose = int(np.argwhere(~np.isfinite(shown))[0, 0])
        raise InputError(f"{where}.sees", "result", f"is no number at {poses[pose]}", "Repair the function", pose)
    exact, own = slopes(instrument, at, u), own_slopes(instrument, at, u, [*u])
    there = slopes(instrument, at._replace(moved=-off, turned=off), dict.fromkeys(u, -3e-6))
    for part, here, mirrored in zip(Slopes._fields, exact, there, strict=True):
        if np.abs(here - mirrored).max() > _KINK * max(1.0, float(np.abs(here).max())):
            raise InputError(f"{where}.sees", "result", f"has a kink in at.{part}", "No maximum, where, clip of errors")
    ways = [(part, each, i) for part, each in zip(Slopes._fields, exact, strict=True) for i in range(3)]
    changes = [(f"at.{part}[:, {i}]", each[:, :, i], part, np.eye(3)[i]) for part, each, i in ways]
    changes += [(f"u[{name!r}]", own[:, :, i], name, np.zeros(3)) for i, name in enumerate(u)]
    for what, slope, of, way in changes:
        rough = _difference(instrument, at, u, of, way)
        apart = np.abs(slope - rough)
        if apart.max() > _ANALYTIC * max(1.0, float(np.abs(rough).max())):
            pose, k = np.argwhere(apart == apart.max())[0].tolist()
            both = f"a complex step gives {slope[pose, k]:g}, a difference {rough[pose, k]:g}"
            remedy = "Use ac.length, ac.cross, ac.angle; no abs, norm, arctan2"
            raise InputError(f"{where}.sees", "result", f"is not analytic in {what}: {both}", remedy, pose)
    for i, name in enumerate(u):
        if not own[:, :, i].any():
            raise InputError(f"{where}.sees", f"u[{name!r}]", "changes nothing", "Use it, or take its name out")
    if not exact.moved.any() and not exact.turned.any():
        blind = "changes with neither at.moved nor at.turned"
        raise InputError(f"{where}.sees", "result", blind, "Return what errors of the machine do to it")


def _difference(instrument: Instrument, at: At, u: dict[str, float], of: str, way: Array) -> Array:
    """Return the derivative by a real difference, to six digits or so, (m, k).

    of : "moved" or "turned", along or about a way (3,), or an unknown
    """
    if of in u:
        up, down = (numbers(instrument, at, u | {of: u[of] + step}) for step in (_STEP, -_STEP))
    else:
        before = getattr(at, of)
        up, down = (numbers(instrument, at._replace(**{of: before + step * way}), u) for step in (_STEP, -_STEP))
    return np.asarray((up - down) / (2 * _STEP))
