"""How the machine may deviate: every error function, and the linear map H(t) from all their control values to the TCP.

    δp(t) = Σ_k s_k R_k(t) [ δ_k(t_k) + ε_k(t_k) × r_k(t) ] = H(t) A        (method of B&H eq. 1 and B&H eq. 28, with
    lever arms)

Each function acts on the TCP through a lever: a vector field over poses times the function's own value. With
displacements only and no rotary axis the levers are constant and this is the paper's sum of stacked splines. What two
axes do together acts like a motion of the later one: δ_k(t_k) becomes δ_k(t_k) + I(t_j, t_k).
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.term import Term, term_of
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import SmallMotions, frames
from axiscal.numerics import Array
from axiscal_core import refusals
from axiscal_core.axes import Frames
from axiscal_core.eigen import unique_root
from axiscal_core.rigid import cross


class SameRows(NamedTuple):
    """Terms of the same axes with the same rows.

    first : one of them; terms : (g,) indices; columns : (g c,) in A, one by one
    """

    first: Term
    terms: NDArray[np.intp]
    columns: NDArray[np.intp] | slice


class _Moving(NamedTuple):
    """How every term moves the tool point.

    axis, along : (terms,) whose frame, and which direction of it; tilted, turning : indices of those that tilt the
    direction of travel, and that turn the frame; sign : (terms,)
    """

    axis: NDArray[np.intp]
    along: NDArray[np.intp]
    tilted: NDArray[np.intp]
    turning: NDArray[np.intp]
    sign: Array


class ErrorModel:
    """The errors of one machine and their joint linear map.

    machine : with the errors it states; functions : of one axis each; planes : of two axes together
    terms : all of them, functions first, so that what is counted by terms is counted by functions as well
    """

    def __init__(self, machine: Machine) -> None:
        if not isinstance(machine, Machine):
            raise refusals.InputError("ErrorModel", "machine", f"= {machine!r} is none", 'Give load_machine("dmu60")')
        self.machine = machine
        terms, self.size = list[Term](), 0
        for entry in (*machine.errors, *machine.planes):
            terms.append(term_of(entry, machine, self.size))
            self.size = terms[-1].columns.stop
        self.terms, curves = tuple(terms), len(machine.errors)
        self.functions, self.planes = self.terms[:curves], self.terms[curves:]

    def prior_covariance(self) -> Array:
        """Return the prior covariance of A, block diagonal over terms, (size, size)."""
        result = np.zeros((self.size, self.size))
        for function in self.terms:
            result[function.columns, function.columns] = function.covariance
        return result

    def prior_root(self) -> Array:
        """Return F with the prior covariance of A = F Fᵀ, term by term, (size, size)."""
        result = np.zeros((self.size, self.size))
        for function in self.terms:
            result[function.columns, function.columns] = unique_root(function.covariance)
        return result

    @cached_property
    def names(self) -> dict[str, Term]:
        """The functions by name."""
        return {function.name: function for function in self.functions}

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
        return frozenset(function.axis for function in self.functions if function.kind == "reversal")

    @property
    def tilts(self) -> list[int]:
        """The columns of tilted directions of travel, which deviate the more the farther an axis is from its zero."""
        tilted = (self.functions[number].columns for number in self._moving.tilted)
        return [column for columns in tilted for column in range(columns.start, columns.stop)]

    def levers(self, poses: Array, angular: bool = False) -> Array:
        """Return the TCP deviation per unit of each term, (terms, m, 3), m or m/rad.

        poses : (m, q); angular : the rotation of the tool relative to the workpiece instead
        """
        if not angular and self._unmoved is not None:
            return np.broadcast_to(self._unmoved, (len(self.terms), len(poses), 3)).copy()
        nominal = frames(self.machine, poses)
        return self._turned(nominal) if angular else self._levers(nominal, poses)

    @cached_property
    def _unmoved(self) -> Array | None:
        """The levers (terms, 1, 3) where they are the same at every pose: displacements without rotary axes, the
        paper's case.
        """
        if any(f.angular for f in self.terms) or any(axis.rotary for axis in self.machine.axes):
            return None
        pose = np.zeros((1, len(self.machine.axes)))
        return self._levers(frames(self.machine, pose), pose)

    @property
    def ways(self) -> tuple[bool, bool, bool]:
        """Whether some error moves the tool along x, y and z; along each where errors or axes turn it."""
        x, y, z = (True,) * 3 if self._unmoved is None else np.any(self._unmoved, axis=(0, 1)).tolist()
        return x, y, z

    def _levers(self, nominal: Frames, poses: Array) -> Array:
        """Return the levers at the frames of poses, (terms, m, 3).

        Along a direction of its axis frame, about it with the arm from there, or by the direction of travel tilted.
        """
        how, of = self._moving, self._moving.axis
        levers: Array = nominal.rotations[of, :, :, how.along]
        about, tilted = levers[how.tilted], of[how.tilted]
        travels = [nominal.rotations[axis] @ np.array(self.machine.axes[axis].direction) for axis in tilted]
        levers[how.tilted] = cross(about, np.array(travels).reshape(about.shape)) * poses.T[tilted][:, :, None]
        levers[how.turning] = cross(levers[how.turning], (nominal.tcp - nominal.origins)[of[how.turning]])
        levers *= how.sign[:, None, None]
        return levers

    @cached_property
    def _moving(self) -> _Moving:
        axes = [self.machine.axes[term.axis] for term in self.terms]
        tilted = [t.kind == "location" and not axis.rotary for t, axis in zip(self.terms, axes, strict=True)]
        pairs = zip(self.terms, tilted, strict=True)
        return _Moving(
            np.array([term.axis for term in self.terms], dtype=np.intp),
            np.array([term.component % 3 for term in self.terms], dtype=np.intp),
            np.flatnonzero(tilted),
            np.flatnonzero([term.angular and not aside for term, aside in pairs]),
            np.array([1.0 if aside else axis.sign for axis, aside in zip(axes, tilted, strict=True)]),
        )

    def _turned(self, nominal: Frames) -> Array:
        how, result = self._moving, np.zeros((len(self.terms), *nominal.tcp.shape))
        turned = nominal.rotations[how.axis[how.turning], :, :, how.along[how.turning]]
        result[how.turning] = how.sign[how.turning, None, None] * turned
        return result

    def rows(self, poses: Array, approaches: Array, angular: bool = False) -> Array:
        """Return H(t) (B&H eq. 1, 28), (m, 3, size).

        poses : (m, q) m or rad; approaches : (m, q) of +1, −1, 0; angular : of the tool's orientation instead
        """
        return self.along(self.levers(poses, angular).transpose(2, 0, 1), poses, approaches).swapaxes(0, 1)

    def along(self, levers: Array, poses: Array, approaches: Array) -> Array:
        """Return the rows of scalar readings with the given levers, (..., m, size).

        levers : (..., terms, m), the effect of each term on the readings
        """
        signed = self.effects(levers, approaches).swapaxes(-1, -2)
        result = np.empty((*signed.shape[:-1], self.size))
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
        effects[..., reversals, :] *= 0.5 * approaches.T[self._moving.axis[reversals]]
        return effects

    @cached_property
    def _reversals(self) -> NDArray[np.intp]:
        return np.flatnonzero([term.kind == "reversal" for term in self.terms])

    def small_motions(self, coefficients: Array, poses: Array, approaches: Array) -> SmallMotions:
        """Return what each axis frame does beside its nominal motion.  coefficients : (size,)."""
        values = [f.rows(*f.at(poses)) @ coefficients[f.columns] for f in self.terms]
        return self.compose(np.array(values).reshape(len(self.terms), len(poses)), approaches)

    def compose(self, values: Array, approaches: Array) -> SmallMotions:
        """Return the small motions of the axis frames from the value of every term.  values : (terms, m)."""
        shape = (len(self.machine.axes), values.shape[1], 3)
        parts = SmallMotions(np.zeros(shape), np.zeros(shape), np.zeros(shape))
        signed = self.effects(values, approaches)
        for i, function in enumerate(self.terms):
            getattr(parts, self.part_of(function))[function.axis, :, function.component % 3] += signed[i]
        return parts

    def part_of(self, term: Term) -> str:
        """Return which of the small motions of its axis a term is."""
        tilts = term.kind == "location" and not self.machine.axes[term.axis].rotary
        return "tilt" if tilts else "rotation" if term.angular else "displacement"
