"""A machine: a chain of axes, and what may be wrong with it.

δp(t) = Σ_k s_k R_k(t) [ δ_k + ε_k × r_k(t) ] = H(t) A        (method of B&H eq. 1 and 28, with lever arms)

>>> axes = [Axis.linear("X", "x", (0, "600 mm")), Axis.linear("Y", "y", (0, "400 mm"))]
>>> machine = Machine(axes, [Error("EXX", "10 um"), Error("EYY", "8 um"), Error("C0Y", "30 urad")])
>>> machine.rows(np.array([[0.3, 0.1]])).displacement.shape
(1, 3, 15)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import accumulate, pairwise
from typing import NamedTuple

import numpy as np

from axiscal_core.axes import Axis, Frames, chain
from axiscal_core.dh import links
from axiscal_core.errors import Basis, Curved, Error, Own, Plane, as_usual, curved
from axiscal_core.refusals import Array, InputError, each_once, finite, listed, one, sided
from axiscal_core.units import METRES, Poses, Quantity, quantities, si

_CHECKED = 0.0, 0.3, 0.5, 1.0  # of the travels: where the rows of a basis of one's own are looked at first


def _held(held: object) -> Array:
    """Return how the tool is turned, (3, 3)."""
    found = finite("Machine", "held", held, (3, 3))
    if not np.allclose(found @ found.T, np.eye(3), atol=1e-9) or np.linalg.det(found) < 0:
        raise InputError("Machine", "held", "is no turn", "Give a matrix whose columns are a right-handed frame")
    return found


class Rows(NamedTuple):
    """What coefficients of errors do to the tool: displacement, rotation : (m, 3, n), m and rad."""

    displacement: Array
    rotation: Array


def come(
    machine: Machine, poses: Poses, sides: Poses | None, function: str, nominal: Frames | None = None
) -> tuple[Array, Array | None]:
    """Return poses and sides as arrays, refused where they make no sense; at known frames they are those."""
    if nominal is not None:
        return np.asarray(poses), None if sides is None else np.asarray(sides)
    at = machine.poses(poses, function)
    return at, None if sides is None else sided(function, sides, at.shape)


class Machine:
    """A machine.

    axes : from the workpiece to the tool; errors : of `Error`, or bases of one's own
    tool : its length, m, or the tool point where all axes stand at zero, (3,); held : (3, 3) the tool's turn there
    """

    def __init__(
        self, axes: Sequence[Axis], errors: Sequence[Error | Basis], tool: Quantity | Sequence[Quantity] = 0.0,
        held: Array | None = None,
    ) -> None:  # fmt: skip
        made = 'Axis.linear("X", "x", (0, "600 mm"))'
        self.axes = tuple(one("Machine", "axes", axis, Axis, made) for axis in listed("Machine", "axes", axes))
        self.errors = tuple(listed("Machine", "errors", errors))
        self.held = None if held is None else _held(held)
        long = isinstance(tool, str | int | float)
        point = [0.0, 0.0, -si(tool, "Machine", "tool", METRES)] if long else tool
        self.tool = quantities(point, "Machine", "tool", (3,), [METRES])
        self.names = [axis.name for axis in self.axes]
        each_once("Machine", "axes", self.names)
        found = (curved(e, self.axes) if isinstance(e, Error) else self._own(e) for e in self.errors)
        self.terms: list[Curved | Own] = [*found]
        each_once("Machine", "errors", [error.name for error in self.errors])
        self.curves = [(i, term) for i, term in enumerate(self.terms) if isinstance(term, Curved)]
        sizes = [term.covariance().shape[0] for term in self.terms]
        self.columns = [slice(*pair) for pair in pairwise(accumulate(sizes, initial=0))]
        self.size = sum(sizes)

    @classmethod
    def from_dh(
        cls, parameters: Sequence[Sequence[Quantity]], std: Mapping[str, Quantity],
        travel: Sequence[Quantity] = ("-150 deg", "150 deg"), tool: Sequence[Quantity] = (0.0, 0.0, 0.0),
    ) -> Machine:  # fmt: skip
        """Return a robot of rotary joints J1, J2, … by Denavit-Hartenberg parameters.

        parameters : a, alpha, d, theta of each link; std : of the errors of "a", "alpha", "d", "theta"
        tool : the tool point in the last frame, m
        """
        axes, errors, point, held = links(parameters, std, travel, tool)
        return cls(axes, errors, point.tolist(), held)

    def as_usual(self) -> Machine:
        """Return the machine with what curves usually have and nobody stated: lengths, rests, scales."""
        found = [as_usual(t.error, self.axes[t.at]) if isinstance(t, Curved) else t.basis for t in self.terms]
        return Machine(self.axes, found, self.tool.tolist(), self.held)

    def poses(self, values: object, function: str = "Machine.poses") -> Array:
        """Return poses as an array, (m, q); refuses those outside the travel."""
        of = [axis.of for axis in self.axes]
        poses = quantities(values, function, "poses", (None, len(of)), of, posed=True)
        for k, axis in enumerate(self.axes):
            low, high = axis.travel
            slack = 1e-9 * axis.length  # rounding of a place at the end
            for i in np.flatnonzero((poses[:, k] < low - slack) | (poses[:, k] > high + slack)).tolist():
                what = f"has {axis.name} = {poses[i, k]:g}, outside the travel"
                raise InputError(function, "poses", what, f"{axis.name} goes from {low:g} to {high:g}", i)
        return poses

    def frames(self, poses: Poses) -> Frames:
        """Return the nominal chain.  poses : (m, q)"""
        return chain(self.axes, self.poses(poses, "Machine.frames"), self.tool, self.held)

    def rows(self, poses: Poses, sides: Poses | None = None, nominal: Frames | None = None) -> Rows:
        """Return H, what each coefficient does to the tool: displacement and rotation, (m, 3, n) each.

        poses : (m, q); sides : (m, q), from where each axis came: +1, -1, 0 where nobody knows
        nominal : the frames at these, where somebody has looked at both
        """
        poses, sides = come(self, poses, sides, "Machine.rows", nominal)
        frames, shape = nominal or self.frames(poses), (len(poses), 3, self.size)
        result = Rows(np.zeros(shape), np.zeros(shape))
        alike = dict[tuple[int, int, bytes], Array]()  # most errors of an axis have the same knots
        for term, columns in zip(self.terms, self.columns, strict=True):
            if isinstance(term, Curved):
                key = term.at, term.spline.size, term.spline.knots.tobytes()
                if key not in alike:
                    alike[key] = term.spline.rows(poses[:, term.at])
                parts = [each[:, :, None] * alike[key][:, None] for each in self._lever(term, frames, poses, sides)]
            else:
                parts = [*self._moved(term, frames, poses)]
            for out, part in zip(result, parts, strict=True):
                out[:, :, columns] = part
        return result

    def levers(self, poses: Poses, sides: Poses | None = None, nominal: Frames | None = None) -> tuple[Array, Array]:
        """Return what a unit of each curve's value does to displacement and rotation of the tool, (curves, m, 3)."""
        poses, sides = come(self, poses, sides, "Machine.levers", nominal)
        frames = nominal or self.frames(poses)
        moved, turned = np.zeros((2, len(self.curves), len(poses), 3))
        for i, (_, term) in enumerate(self.curves):
            moved[i], turned[i] = self._lever(term, frames, poses, sides)
        return moved, turned

    def covariance(self) -> Array:
        """Return C of all coefficients before any reading, (n, n)."""
        result = np.zeros((self.size, self.size))
        for term, columns in zip(self.terms, self.columns, strict=True):
            result[columns, columns] = term.covariance()
        return result

    def _lever(self, term: Curved, frames: Frames, poses: Array, sides: Array | None) -> tuple[Array, Array]:
        """Return what a unit of the value does, (m, 3) each."""
        k, axis = term.at, self.axes[term.at]
        along = frames.rotations[k][:, :, term.error.component % 3]
        if term.error.kind == "reversal":  # it is the difference of both sides, so half of it from each
            along = along * (0.0 if sides is None else sides[:, [k]] / 2)
        still, sign = np.zeros_like(along), -1.0 if axis.workpiece_side else 1.0
        if term.error.kind == "location" and not axis.rotary:
            # the direction of travel is tilted: the carriage goes where it goes, and turns nothing
            return np.cross(along, frames.rotations[k] @ axis.direction) * poses[:, k, None], still
        if term.error.component < 3:
            return sign * along, still
        return sign * np.cross(along, frames.tcp - frames.origins[k]), sign * along

    def _moved(self, term: Own, frames: Frames, poses: Array) -> tuple[Array, Array]:
        """Return what a basis of one's own does, (m, 3, n) each."""
        rows = term.rows(poses)
        if term.frame == "tool":
            return frames.tool @ rows[:, :3], frames.tool @ rows[:, 3:]
        k = self.names.index(term.frame)
        sign = -1.0 if self.axes[k].workpiece_side else 1.0
        shift, turn = sign * frames.rotations[k] @ rows[:, :3], sign * frames.rotations[k] @ rows[:, 3:]
        return shift + np.cross(turn, (frames.tcp - frames.origins[k])[:, :, None], axis=1), turn

    def _own(self, error: Basis) -> Own:
        missing = [each for each in ("name", "frame", "rows", "covariance") if not hasattr(error, each)]
        if missing:
            raise InputError("Machine", "errors", f"hold {error!r} without {', '.join(missing)}", "See Basis")
        if isinstance(error, type):
            raise InputError("Machine", "errors", f"hold {error!r}, a class", "Give an object of it")
        if isinstance(error, Plane):
            error.on(self.axes)
        if error.frame not in [*self.names, "tool"]:
            what, known = f"hold {error.name} of an unknown frame {error.frame!r}", ", ".join([*self.names, "tool"])
            raise InputError("Machine", "errors", what, f"Frames are {known}")
        found = Own(error)
        low, high = np.array([axis.travel for axis in self.axes]).T
        found.rows(low + np.outer(_CHECKED, high - low))
        return found

    def __repr__(self) -> str:
        return f"<Machine {''.join(self.names)}: {len(self.errors)} errors, {self.size} coefficients>"
