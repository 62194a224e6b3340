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
from typing import Literal, NamedTuple, TypedDict, Unpack, cast

import numpy as np

from axiscal_core.errors import Curved
from axiscal_core.machine import Machine
from axiscal_core.refusals import Array, InputError, one_of, within
from axiscal_core.units import Quantity, si

Unknowns = Mapping[str, float]
"""Values of an instrument's own unknowns, by name."""
Approach = Literal["both", "+", "-"]
TOOL = ("tool_x", "tool_y", "tool_z")
"""By how much the tool in the spindle is another than the machine states, m."""
_H = 1e-30  # a complex step: its square is below rounding
_STEP = 1e-6  # of the real difference: errors are microns, and rounding of a metre is 1e-16
_ANALYTIC = 1e-4  # by so much of the largest slope both may differ: a second derivative times the step is less


class At(NamedTuple):
    """Places of readings, and the deviations of the machine there.

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
        off = sum(u[name] * self.tool[:, :, i] for i, name in enumerate(TOOL))
        return self.moved + off + cross(self.turned, np.asarray(off))


def length(v: Array) -> Array:
    """Return how long vectors are, (m,), analytically.  v : (m, 3)"""
    result: Array = np.sqrt(np.sum(v * v, axis=1))
    return result


def cross(a: Array, b: Array) -> Array:
    """Return a × b, (m, 3), of complex vectors as well.  a, b : (m, 3)"""
    result: Array = a[:, [1, 2, 0]] * b[:, [2, 0, 1]] - a[:, [2, 0, 1]] * b[:, [1, 2, 0]]
    return result


def angle(y: Array, x: Array) -> Array:
    """Return the angle of (x, y), (m,), analytically near the real numbers: what arctan2 is not."""
    away = np.arctan2(np.real(y), np.real(x))
    c, s = np.cos(away), np.sin(away)
    result: Array = away + np.arctan((y * c - x * s) / (x * c + y * s))
    return result


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
        self.name, where = name, type(self).__name__
        self.moves = tuple(re.findall(r"[A-Za-z]\d*", moves) if isinstance(moves, str) else moves)
        for field, value in mounting.items():
            setattr(self, one_of(where, "mounting", field, [*Mounting.__annotations__]), value)
        one_of(where, "approach", self.approach, ("both", "+", "-"))
        if len(self.names) != len(self.units):
            raise InputError(where, "units", f"are {len(self.units)} of {len(self.names)} names", "Give one for each")
        for unit in self.units:
            one_of(where, "units", unit, ("m", "rad"))
        shared = set(self.unknowns) & set(self.type_b)
        if shared:
            raise InputError(where, "type_b", f"names the unknown {min(shared)}", "Readings show it, or they do not")
        one = isinstance(self.noise, str) or np.ndim(self.noise) == 0
        many = [self.noise] * len(self.names) if one else [*np.asarray(self.noise, dtype=object)]
        if len(many) != len(self.names):
            raise InputError(
                where, "noise", f"has {len(many)} values of {len(self.names)} names", "Give one, or one for each"
            )
        self.sigma = np.array([within(where, "noise", si(each, where, "noise"), 0.0, open_end=True) for each in many])
        self.own = {k: within(where, k, si(std, where, k), 0.0) for k, std in self.unknowns.items()}
        self.considered = {k: within(where, k, si(std, where, k), 0.0) for k, std in self.type_b.items()}
        self.wander = within(where, "drift", si(self.drift, where, "drift"), 0.0)
        self.costs = within(where, "seconds", si(self.seconds, where, "seconds"), 0.0)
        self.begins = within(where, "setup_time", si(self.setup_time, where, "setup_time"), 0.0)

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
    looked = _Looked(instrument, machine, poses, sides, errors, unknowns)
    by_move = np.stack([looked.imaginary(moved=each) for each in np.eye(3)], axis=2)
    by_turn = np.stack([looked.imaginary(turned=each) for each in np.eye(3)], axis=2)
    nothing = np.zeros((*by_move.shape[:2], 0))
    own, type_b = (
        np.concatenate([nothing, *(looked.imaginary(name=name)[:, :, None] for name in names)], axis=2)
        for names in (instrument.own, instrument.considered)
    )
    # a reversal enters with one half of its value or the other, where nobody knows with either
    moved, turned = (
        each.transpose(1, 2, 0) for each in machine.levers(poses, np.where(sides == 0, 1, sides), looked.frames)
    )
    reach = by_move @ moved + by_turn @ turned
    blind = np.zeros(reach.shape[:2])
    for i, (_, term) in enumerate(machine.curves):
        moves = term.error.kind == "reversal" and machine.names[term.at] in instrument.moves
        if moves and (unknown := sides[:, term.at] == 0).any():
            blind[unknown] += (reach[unknown, :, i] * _spread(term, poses[unknown])[:, None]) ** 2
            reach[unknown, :, i] = 0.0
    return Sight(
        by_move @ looked.rows.displacement + by_turn @ looked.rows.rotation, own,
        type_b * np.array([*instrument.considered.values()]), reach, looked.shown(), blind,
    )  # fmt: skip


def _spread(term: Curved, poses: Array) -> Array:
    """Return the standard deviation of a curve and its rest before any reading, (m,)."""
    rows = term.spline.rows(poses[:, term.at])
    return np.asarray(np.sqrt(np.sum(rows @ term.covariance() * rows, axis=1) + term.rest**2))


class _Looked:
    """An instrument at poses, asked again and again with one thing changed."""

    def __init__(
        self, instrument: Instrument, machine: Machine, poses: Array, sides: Array, errors: Array | None,
        unknowns: Array | None,
    ) -> None:  # fmt: skip
        self.instrument, self.poses, self.sides = instrument, poses, sides
        self.frames = machine.frames(poses)
        self.rows = machine.rows(poses, sides, self.frames)
        still = np.zeros((len(poses), 3))
        self.moved = still if errors is None else self.rows.displacement @ errors
        self.turned = still if errors is None else self.rows.rotation @ errors
        values = np.zeros(len(instrument.own)) if unknowns is None else unknowns
        self.u = dict(zip(instrument.own, values.tolist(), strict=True)) | dict.fromkeys(instrument.considered, 0.0)

    def numbers(self, moved: Array | float, turned: Array | float, name: str, step: complex) -> Array:
        """Return what it shows where steps along some ways, and of one unknown, are taken, (m, k)."""
        u = self.u | ({name: self.u[name] + step} if name else {})
        stepped = [cast("Array", part + step * way) for part, way in ((self.moved, moved), (self.turned, turned))]
        at = At(self.poses, self.sides, self.frames.tcp, self.frames.tool, *stepped)
        where = f"{type(self.instrument).__name__}.sees"
        try:
            found = self.instrument.sees(at, u)
        except KeyError as missing:
            raise InputError(where, f"u[{missing}]", "is not there", "Name it in unknowns or type_b") from None
        if not isinstance(found, list | tuple) or len(found) != len(self.instrument.names):
            what, names = f"is {type(found).__name__}", ", ".join(self.instrument.names)
            raise InputError(where, "result", what, f"Return a list of one array for each of {names}")
        try:
            return np.stack([np.broadcast_to(each, len(self.poses)) for each in found], axis=1)
        except ValueError:
            shapes = ", ".join(str(np.shape(each)) for each in found)
            raise InputError(where, "result", f"has shapes {shapes}", f"Give ({len(self.poses)},) each") from None

    def shown(self) -> Array:
        """Return what it shows, (m, k)."""
        return np.real(self.numbers(0.0, 0.0, "", 0.0))

    def imaginary(self, moved: Array | float = 0.0, turned: Array | float = 0.0, name: str = "") -> Array:
        """Return the derivative, (m, k), along a way (3,) of the tool, about one, or by an unknown."""
        return np.imag(self.numbers(moved, turned, name, 1j * _H)) / _H

    def difference(self, moved: Array | float = 0.0, turned: Array | float = 0.0, name: str = "") -> Array:
        """Return the same by a real difference, to six digits or so."""
        up, down = (np.real(self.numbers(moved, turned, name, step)) for step in (_STEP, -_STEP))
        return (up - down) / (2 * _STEP)


def refuse_what_is_not_analytic(instrument: Instrument, machine: Machine, poses: Array, sides: Array) -> None:
    """Raise InputError where complex steps and a real difference give other rows.  poses, sides : (m, q)"""
    where, some = type(instrument).__name__, np.array([3e-6, -2e-6, 5e-6])
    looked = _Looked(instrument, machine, poses, sides, None, None)
    looked.moved, looked.turned = looked.moved + some, looked.turned - some  # abs has a slope beside zero only
    looked.u = {name: value + 3e-6 for name, value in looked.u.items()}
    if not np.isfinite(looked.shown()).all():
        pose = int(np.argwhere(~np.isfinite(looked.shown()))[0, 0])
        raise InputError(
            f"{where}.sees", "result", f"is no number at {poses[pose]}", "It has to be one at every pose", pose
        )
    ways, still = np.eye(3), np.zeros(3)
    changes = [(f"at.moved[:, {i}]", ways[i], still, "") for i in range(3)]
    changes += [(f"at.turned[:, {i}]", still, ways[i], "") for i in range(3)]
    changes += [(f"u[{name!r}]", still, still, name) for name in looked.u]
    for what, moved, turned, name in changes:
        exact, rough = looked.imaginary(moved, turned, name), looked.difference(moved, turned, name)
        off = np.abs(exact - rough)
        if off.max() > _ANALYTIC * max(1.0, float(np.abs(rough).max())):
            pose, k = np.argwhere(off == off.max())[0].tolist()
            both = f"a complex step gives {exact[pose, k]:g}, a difference {rough[pose, k]:g}"
            remedy = "Use ac.length, ac.cross, ac.angle; no abs, norm, arctan2"
            raise InputError(f"{where}.sees", "result", f"is not analytic in {what}: {both}", remedy, pose)
