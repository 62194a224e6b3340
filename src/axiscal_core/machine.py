"""A machine: a chain of axes, what may be wrong with it, and the linear map H(t) from that to the tool.

    δp(t) = Σ_k s_k R_k(t) [ δ_k(t_k) + ε_k(t_k) × r_k(t) ] = H(t) A    (method of B&H eq. 1 and 28, with lever arms)

>>> axes = [Axis.linear("X", "x", (0, "600 mm")), Axis.linear("Y", "y", (0, "400 mm"))]
>>> machine = Machine(axes, [Error("EXX", "10 um"), Error("EYY", "8 um"), Error("C0Y", "30 urad")])
>>> machine.rows(np.array([[0.3, 0.1]])).displacement.shape
(1, 3, 15)

Each error acts on the tool through a lever: a vector field over poses times its own value. With displacements only and
no rotary axis the levers are constant and this is the paper's sum of stacked splines. What two axes do together acts
like a motion of the later one: δ_k(t_k) becomes δ_k(t_k) + I(t_j, t_k).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal_core.axes import Axis, Frames, Three, chain
from axiscal_core.dh import links
from axiscal_core.eigen import unique_root
from axiscal_core.errors import Basis, Error, Own
from axiscal_core.levers import Levers, levers_of
from axiscal_core.refusals import Array, InputError, each_once, finite, listed, one, one_of, sided
from axiscal_core.terms import Term, term_of
from axiscal_core.units import METRES, Poses, Quantity, quantities, si

_MADE = 'Axis.linear("X", "x", (0, "600 mm"))'
_CHECKED = 0.0, 0.3, 0.5, 1.0  # of the travels: where the rows of a basis of one's own are looked at first


class Nose(NamedTuple):
    """What is round the tool, m.

    radius : of the tool and what holds it, up to the spindle nose; stylus : diameter of the ball of a probe, or 0
    reach : how far a stylus stands free below; head : diameter and height of the nose with what carries it, or none
    """

    radius: float = 0.04
    stylus: float = 0.0
    reach: float = 0.05
    head: tuple[float, ...] = ()


class Rows(NamedTuple):
    """What coefficients of errors do to the tool: displacement, rotation : (m, 3, n), m and rad."""

    displacement: Array
    rotation: Array


class SameRows(NamedTuple):
    """Terms of the same axes with the same rows.

    first : one of them; terms : (g,) indices; columns : (g c,) in A, one by one
    """

    first: Term
    terms: NDArray[np.intp]
    columns: NDArray[np.intp] | slice


@dataclass(frozen=True, repr=False, init=False)
class Machine:
    """A machine.

    axes : from the workpiece to the tool; errors : of `Error`, or bases of one's own
    tool : the tool point where all axes stand at zero, m, or the length of a tool along -z
    held : (3, 3) the tool's turn there; name : as its owner calls it; nose : what is round the tool
    unit : in which its control counts lengths, "mm" or "in"
    """

    axes: tuple[Axis, ...]
    errors: tuple[Error | Basis, ...]
    tool: Three
    held: tuple[Three, ...] | None
    name: str
    nose: Nose
    unit: str
    own: tuple[Own, ...] = field(init=False, compare=False)

    def __init__(
        self, axes: Sequence[Axis], errors: Iterable[Error | Basis] = (),
        tool: Quantity | Sequence[Quantity] = 0.0, held: Array | Sequence[Three] | None = None, name: str = "",
        nose: Nose | None = None, unit: str = "mm",
    ) -> None:  # fmt: skip
        axes = tuple(one("Machine", "axes", axis, Axis, _MADE) for axis in listed("Machine", "axes", axes))
        each_once("Machine", "axes", [axis.name for axis in axes])
        if isinstance(tool, str | int | float):
            x, y, z = 0.0, 0.0, -si(tool, "Machine", "tool", METRES)
        elif isinstance(tool, tuple) and all(isinstance(each, float) and math.isfinite(each) for each in tool):
            x, y, z = tool  # as `replace` has it, which is asked often
        else:
            x, y, z = quantities(tool, "Machine", "tool", (3,), [METRES]).tolist()
        every = tuple(one("Machine", "errors", errors, Iterable, '[Error("EXX", "10 um")]'))
        told = {
            "axes": axes, "errors": every, "tool": (x, y, z), "held": None if held is None else _held(held),
            "name": name, "nose": nose or Nose(), "unit": unit,
        }  # fmt: skip
        for key, value in told.items():
            object.__setattr__(self, key, value)
        for error in every:
            if isinstance(error, Error):
                error.refuse_foreign(axes)
        object.__setattr__(self, "own", tuple(self._own(each) for each in every if not isinstance(each, Error)))
        each_once("Machine", "errors", [error.name for error in every])

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
        return Machine(axes, errors, point.tolist(), held)

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash((self.axes, self.errors, self.tool))

    @property
    def chain(self) -> str:
        """Its axes in the manner of ISO 10791-6, such as "w-X'-Y'-b-Z-t"."""
        before, after = ([axis for axis in self.axes if axis.workpiece_side is side] for side in (True, False))
        return "-".join(["w", *(f"{axis.name}'" for axis in before), "b", *(axis.name for axis in after), "t"])

    @cached_property
    def axis_names(self) -> list[str]:
        """The names of the axes."""
        return [axis.name for axis in self.axes]

    def index(self, name: str) -> int:
        """Return the place of an axis in a pose; raises InputError for an axis that the machine does not have."""
        return self.axis_names.index(one_of("Machine.index", "name", name, self.axis_names))

    def axis(self, name: str) -> Axis:
        """Return the axis of that name; raises as `index`."""
        return self.axes[self.index(name)]

    @property
    def tool_length(self) -> float:
        """The length of the tool, m."""
        return -self.tool[2]

    @property
    def zero(self) -> tuple[float, ...]:
        """The pose called machine zero: every axis at 0, or at the end of its travel nearest to it, m or rad."""
        return tuple(min(max(0.0, axis.travel[0]), axis.travel[1]) for axis in self.axes)

    @property
    def only(self) -> int | None:
        """The one linear axis of which displacements alone are described; None where more is, or an axis turns."""
        axes = {error.axis for error in self.stated}
        more = len(axes) != 1 or any(error.sides or error.angular for error in self.stated)
        return None if more or any(axis.rotary for axis in self.axes) else self.index(*axes)

    @cached_property
    def stated(self) -> tuple[Error, ...]:
        """The errors that are curves or planes, those of one axis first."""
        errors = [each for each in self.errors if isinstance(each, Error)]
        planes = [each for each in errors if each.sides]
        return tuple([each for each in errors if not each.sides] + planes)

    @cached_property
    def terms(self) -> tuple[Term, ...]:
        """Curves and planes, curves first: so what is counted by terms is counted by curves as well."""
        found, size = list[Term](), 0
        for error in self.stated:
            found.append(term_of(error, self.axes, size))
            size = found[-1].columns.stop
        return tuple(found)

    @cached_property
    def curves(self) -> tuple[Term, ...]:
        """The terms of one axis."""
        return tuple(term for term in self.terms if len(term.sides) == 1)

    @cached_property
    def planes(self) -> tuple[Term, ...]:
        """The terms of two axes together."""
        return tuple(term for term in self.terms if len(term.sides) > 1)

    @cached_property
    def parts(self) -> tuple[Term | Own, ...]:
        """Everything that has coefficients, in their order."""
        at, found = self.terms[-1].columns.stop if self.terms else 0, list[Own]()
        for each in self.own:
            found.append(each.behind(at))
            at = found[-1].columns.stop
        return *self.terms, *found

    @cached_property
    def size(self) -> int:
        """The number of coefficients."""
        return self.parts[-1].columns.stop if self.parts else 0

    @cached_property
    def by_name(self) -> dict[str, Term]:
        """The curves by name."""
        return {term.name: term for term in self.curves}

    def covariance(self) -> Array:
        """Return C of all coefficients before any reading, block diagonal over errors, (size, size)."""
        return self._blocks([part.covariance for part in self.parts])

    def root(self) -> Array:
        """Return F with C = F Fᵀ, error by error, (size, size)."""
        return self._blocks([unique_root(part.covariance) for part in self.parts])

    def _blocks(self, blocks: Sequence[Array]) -> Array:
        result = np.zeros((self.size, self.size))
        for part, block in zip(self.parts, blocks, strict=True):
            result[part.columns, part.columns] = block
        return result

    def knots_along(self, axis: int) -> list[Array]:
        """Return the knots along an axis of each term that depends on it."""
        return [side.spline.knots for term in self.terms for side in term.sides if side.axis == axis]

    @cached_property
    def rests(self) -> Array:
        """Standard deviation of the rest of each term, (terms,) m or rad; a reversal adds half of itself to a side."""
        return np.array([term.rest / (2 if term.kind == "reversal" else 1) for term in self.terms])

    @cached_property
    def reversing(self) -> frozenset[int]:
        """The axes that have a reversal: what is seen there depends on the side from which they come."""
        return frozenset(term.axis for term in self.curves if term.kind == "reversal")

    @property
    def tilts(self) -> list[int]:
        """The columns of tilted directions of travel, which deviate the more the farther an axis is from its zero."""
        tilted = (self.curves[number].columns for number in self._levers.tilted)
        return [column for columns in tilted for column in range(columns.start, columns.stop)]

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

    def come(self, poses: Poses, sides: Poses | None, function: str) -> tuple[Array, Array]:
        """Return poses, and sides from which axes come, nobody knows where nothing is said; refuses what is none."""
        at = self.poses(poses, function)
        return at, np.zeros(at.shape) if sides is None else sided(function, sides, at.shape)

    def frames(self, poses: Array) -> Frames:
        """Return the nominal chain.  poses : (m, q) m or rad, also outside the travel"""
        return chain(self.axes, poses, np.array(self.tool), None if self.held is None else np.array(self.held))

    def levers(self, poses: Array, angular: bool = False) -> Array:
        """Return the TCP deviation per unit of each term, (terms, m, 3), m or m/rad.

        poses : (m, q); angular : the rotation of the tool relative to the workpiece instead
        """
        if not angular and self._unmoved is not None:
            return np.broadcast_to(self._unmoved, (len(self.terms), len(poses), 3)).copy()
        nominal = self.frames(poses)
        return self._levers.rotation(nominal) if angular else self._levers.displacement(nominal, poses)

    @cached_property
    def _unmoved(self) -> Array | None:
        """The levers (terms, 1, 3) where they are the same at every pose: displacements without rotary axes, the
        paper's case.
        """
        if any(f.angular for f in self.terms) or any(axis.rotary for axis in self.axes):
            return None
        pose = np.zeros((1, len(self.axes)))
        return self._levers.displacement(self.frames(pose), pose)

    @cached_property
    def _levers(self) -> Levers:
        return levers_of(self.axes, self.terms)

    @property
    def ways(self) -> tuple[bool, bool, bool]:
        """Whether some error moves the tool along x, y and z; along each where errors or axes turn it."""
        x, y, z = (True,) * 3 if self._unmoved is None else np.any(self._unmoved, axis=(0, 1)).tolist()
        return x, y, z

    def rows(self, poses: Poses, sides: Poses | None = None) -> Rows:
        """Return H (B&H eq. 1, 28), what each coefficient does to the tool; refuses poses outside the travel.

        poses : (m, q) m or rad; sides : (m, q), from where each axis came: +1, -1, 0 where nobody knows
        """
        at, came = self.come(poses, sides, "Machine.rows")
        return Rows(self.rows_at(at, came), self.rows_at(at, came, angular=True))

    def rows_at(self, poses: Array, sides: Array, angular: bool = False) -> Array:
        """Return H of the displacement, (m, 3, size), also outside the travel.  angular : of the rotation instead"""
        levers = self.levers(poses, angular).transpose(2, 0, 1)
        rows = self.along(levers, poses, sides).swapaxes(0, 1)
        if self.own:
            frames = self.frames(poses)
            for own in self.parts[len(self.terms) :]:
                rows[:, :, own.columns] = self._moved(own, frames, poses)[angular]
        return rows

    def along(self, levers: Array, poses: Array, approaches: Array) -> Array:
        """Return the rows of scalar readings with the given levers, (..., m, size).

        levers : (..., terms, m), the effect of each term on the readings
        """
        signed = self.effects(levers, approaches).swapaxes(-1, -2)
        result = np.zeros((*signed.shape[:-1], self.size))
        for group in self.alike:
            values = group.first.rows(*group.first.at(poses))
            rows = signed[..., group.terms, None] * values[:, None, :]
            result[..., group.columns] = rows.reshape(*signed.shape[:-1], math.prod(rows.shape[-2:]))
        return result

    @cached_property
    def alike(self) -> tuple[SameRows, ...]:
        """The terms that share axes, knots and cells, so that their rows are computed once."""
        groups = dict[object, list[int]]()
        for i, term in enumerate(self.terms):
            groups.setdefault(tuple(side.key for side in term.sides), []).append(i)
        found = list[SameRows]()
        for members in groups.values():
            each = [self.terms[i].columns for i in members]
            columns = np.concatenate([np.arange(one.start, one.stop) for one in each])
            together = slice(columns[0], columns[-1] + 1) if np.all(np.diff(columns) == 1) else columns
            found.append(SameRows(self.terms[members[0]], np.array(members), together))
        return tuple(found)

    @cached_property
    def firsts(self) -> NDArray[np.intp]:
        """The first of the terms that are alike with each term, (terms,)."""
        found = np.arange(len(self.terms))
        for group in self.alike:
            found[group.terms] = group.terms[0]
        return found

    def effects(self, levers: Array, approaches: Array) -> Array:
        """Return what a unit of each term adds to scalar readings, reversals by their sign, (..., terms, m)."""
        effects, reversals = levers.copy(), self._reversals
        effects[..., reversals, :] *= 0.5 * approaches.T[self._levers.axis[reversals]]
        return effects

    @cached_property
    def _reversals(self) -> NDArray[np.intp]:
        return np.flatnonzero([term.kind == "reversal" for term in self.terms])

    def _moved(self, own: Term | Own, frames: Frames, poses: Array) -> tuple[Array, Array]:
        """Return what a basis of one's own does, (m, 3, n) each."""
        assert isinstance(own, Own), "bases of one's own stand behind curves and planes"
        rows = own.rows(poses)
        if own.frame == "tool":
            return frames.tool @ rows[:, :3], frames.tool @ rows[:, 3:]
        k = self.axis_names.index(own.frame)
        shift, turn = (self.axes[k].sign * frames.rotations[k] @ part for part in (rows[:, :3], rows[:, 3:]))
        return shift + np.cross(turn, (frames.tcp - frames.origins[k])[:, :, None], axis=1), turn

    def _own(self, error: Basis) -> Own:
        """Return a basis of one's own, looked at."""
        if missing := [each for each in ("name", "frame", "rows", "covariance") if not hasattr(error, each)]:
            raise InputError("Machine", "errors", f"hold {error!r} without {', '.join(missing)}", "See Basis")
        if isinstance(error, type):
            raise InputError("Machine", "errors", f"hold {error!r}, a class", "Give an object of it")
        frames = [*self.axis_names, "tool"]
        if error.frame not in frames:
            what = f"hold {error.name} of an unknown frame {error.frame!r}"
            raise InputError("Machine", "errors", what, f"Frames are {', '.join(frames)}")
        found, (low, high) = Own(error), np.array([axis.travel for axis in self.axes]).T
        found.rows(low + np.outer(_CHECKED, high - low))
        return found

    def __repr__(self) -> str:
        return f"<Machine {''.join(self.axis_names)}: {len(self.errors)} errors, {self.size} coefficients>"


def _held(held: object) -> tuple[Three, ...]:
    """Return how the tool is turned, (3, 3)."""
    found = finite("Machine", "held", held, (3, 3))
    if not np.allclose(found @ found.T, np.eye(3), atol=1e-9) or np.linalg.det(found) < 0:
        raise InputError("Machine", "held", "is no turn", "Give a matrix whose columns are a right-handed frame")
    return tuple((x, y, z) for x, y, z in found.tolist())
