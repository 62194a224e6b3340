"""By how much a unit of each error displaces and turns the tool: levers, of which rows are made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal_core.axes import Axis, Frames
from axiscal_core.refusals import Array
from axiscal_core.rigid import cross
from axiscal_core.terms import Term


@dataclass(frozen=True, eq=False, slots=True)
class Levers:
    """How every term moves the tool.

    axis, along : (terms,) whose frame, and which direction of it; tilted, turning : indices of those that tilt the
    direction of travel, and that turn the frame; sign : (terms,)
    """

    axes: tuple[Axis, ...]
    axis: NDArray[np.intp]
    along: NDArray[np.intp]
    tilted: NDArray[np.intp]
    turning: NDArray[np.intp]
    sign: Array

    def displacement(self, nominal: Frames, poses: Array) -> Array:
        """Return the levers of the tool point at the frames of poses, (terms, m, 3).

        Along a direction of its axis frame, about it with the arm from there, or by the direction of travel tilted.
        """
        levers: Array = nominal.rotations[self.axis, :, :, self.along]
        about, tilted = levers[self.tilted], self.axis[self.tilted]
        travels = [nominal.rotations[axis] @ np.array(self.axes[axis].direction) for axis in tilted]
        levers[self.tilted] = cross(about, np.array(travels).reshape(about.shape)) * poses.T[tilted][:, :, None]
        arms = (nominal.tcp - nominal.origins)[self.axis[self.turning]]
        levers[self.turning] = cross(levers[self.turning], arms)
        levers *= self.sign[:, None, None]
        return levers

    def rotation(self, nominal: Frames) -> Array:
        """Return those of the tool's turn, (terms, m, 3)."""
        result = np.zeros((len(self.axis), *nominal.tcp.shape))
        turned = nominal.rotations[self.axis[self.turning], :, :, self.along[self.turning]]
        result[self.turning] = self.sign[self.turning, None, None] * turned
        return result


def levers_of(axes: tuple[Axis, ...], terms: Sequence[Term]) -> Levers:
    """Return how terms move the tool."""
    of = [axes[term.axis] for term in terms]
    tilted = [term.kind == "location" and term.linear for term in terms]
    pairs = zip(terms, tilted, strict=True)
    return Levers(
        axes,
        np.array([term.axis for term in terms], dtype=np.intp),
        np.array([term.component % 3 for term in terms], dtype=np.intp),
        np.flatnonzero(tilted),
        np.flatnonzero([term.angular and not aside for term, aside in pairs]),
        np.array([1.0 if aside else axis.sign for axis, aside in zip(of, tilted, strict=True)]),
    )
