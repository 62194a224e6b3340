"""The error of the volume: what the tool does at places spread over it, as found, as left, and how well it is known.

One error of two axes as plain data in display units.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from axiscal.errors.iso230 import words
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.machine_estimate import Estimate
from axiscal.language.spoken import listed, put
from axiscal.numerics import Array
from axiscal.present.result import PlaneMap, VolumeFigures
from axiscal.tables.surface import Control, left_by
from axiscal.units import said_quantity, to_unit
from axiscal_core.errors import COMPONENTS
from axiscal_core.machine import Machine
from axiscal_core.terms import Term

_POSITIONS = 31
"""Points of a drawn map along each axis."""


def planes(estimation: Estimation) -> dict[str, PlaneMap]:
    """Return every error that is a function of two positions, as `result.json` has it, by name.

    Maps have a row for each position of the first axis; sign : +1 or -1, how the tool shows the error
    """
    return {plane.name: _plane(estimation, plane) for plane in estimation.case.errors.planes}


def _plane(estimation: Estimation, plane: Term) -> PlaneMap:
    errors, belief = estimation.case.errors, estimation.printed.belief
    axes = tuple(errors.axes[index] for index in plane.axes)
    at = tuple(np.linspace(*axis.travel, _POSITIONS) for axis in axes)
    poses = np.tile(np.array(errors.zero), (_POSITIONS**2, 1))
    poses[:, list(plane.axes)] = np.stack([grid.ravel() for grid in np.meshgrid(*at, indexing="ij")], axis=1)
    names = {f"E{COMPONENTS[plane.component]}{axis.name}" for axis in axes}  # of curves in the same direction
    beside: list[Term] = [
        *(function for function in errors.curves if function.name in names),
        plane,
    ]  # in its direction
    own, whole = (_rows_of_plane(errors, terms, poses) for terms in ([plane], beside))
    whole -= whole.mean(axis=0)  # where the zero lies is no shape
    sign, unit = float(errors.axes[plane.axis].sign), "urad" if plane.angular else "um"

    def shown(values: Array) -> list[list[float]]:
        return [to_unit(row, unit).tolist() for row in values.reshape(_POSITIONS, _POSITIONS)]

    def spread(rows: Array, terms: Sequence[Term]) -> Array:
        variance = np.sum((rows @ belief.factor[: errors.size]) ** 2, axis=1)
        std: Array = np.sqrt(variance + sum(term.rest**2 for term in terms))
        return std

    mean = belief.mean[: errors.size]
    first, second = axes
    return PlaneMap(
        axes=[first.name, second.name],
        words=words(plane.name),
        position=[to_unit(at[0], first.unit).tolist(), to_unit(at[1], second.unit).tolist()],
        mean=shown(sign * (own @ mean)),
        std=shown(spread(own, [plane])),
        position_unit=[first.unit, second.unit],
        value_unit=unit,
        whole_mean=shown(whole @ mean),
        whole_std=shown(spread(whole, beside)),
        sign=int(sign),
    )


def _rows_of_plane(errors: Machine, terms: Sequence[Term], poses: Array) -> Array:
    """Return the rows of a sum of errors, each with the sign that it has at the tool, (m, size)."""
    rows = np.zeros((len(poses), errors.size))
    for term in terms:
        rows[:, term.columns] = errors.axes[term.axis].sign * term.rows(*term.at(poses))
    return rows


_COUNTS = {1: (11,), 2: (7, 7), 3: (5, 5, 3)}
"""Places along the axes that move, the longest first: enough to see a shape; a matter of taste."""


def volume_error(estimation: Estimation, controller: str = "", control: Control | None = None) -> VolumeFigures:
    """Return the error of the volume as `result.json` has it; both sides from which an axis may come count alike.

    One shift of all places is taken off. control : what the tables of `controller` do, None where there are none
    """
    estimate = estimation.estimate()
    moving, poses, counts = _places_over(estimate)
    found = _shifted(estimate.deviation, poses)
    left = ()
    if control is not None:
        after = partial(left_by, estimate.machine, estimate.deviation, control)
        left = to_unit(_shifted(after, poses), "um").tolist()
    axes = estimate.machine.axes
    at = {axis.name: said_quantity(float(poses[0, k]), axis.unit, 4) for k, axis in enumerate(axes) if k not in moving}
    parked = listed(", ", [put("{axis} {at}", axis=name, at=at[name]) for name in sorted(at)])
    places = to_unit(estimate.machine.frames(poses).tcp, "mm").tolist()
    names = [axes[k].name for k in moving]
    spread = _shifted(estimate.model.rows_at, poses) @ estimate.factor
    rests = np.einsum("fmc,f->mc", estimate.model.levers(poses) ** 2, estimate.model.rests**2)
    half: Array = BAND * np.sqrt(np.sum(spread**2, axis=2) + rests)
    return VolumeFigures(
        axes=names,
        counts=counts,
        parked=parked,
        tcp_mm=places,
        found_um=to_unit(found, "um").tolist(),
        half_um=to_unit(half, "um").tolist(),
        left_um=left,
        controller=controller,
    )


def _places_over(estimate: Estimate) -> tuple[list[int], Array, tuple[int, ...]]:
    """Return the axes that span a picture, a grid over them, (m, q), and its places along each.

    Linear axes span it, or else those that turn; rotary ones stand as near to zero as the volume lets them, otherwise.
    """
    box, rotary = np.array(estimate.box), [axis.rotary for axis in estimate.machine.axes]
    middle, sides = np.where(rotary, np.clip(0.0, box[:, 0], box[:, 1]), box.mean(axis=1)), box[:, 1] - box[:, 0]
    free = np.flatnonzero(sides > 0).tolist()
    linear = [k for k in free if not rotary[k]]
    moving = sorted(sorted(linear or free, key=lambda k: -sides[k])[:3])
    order = np.argsort(np.argsort(-sides[moving], kind="stable"), kind="stable")
    along = tuple(_COUNTS[len(moving)][rank] for rank in order) if moving else ()
    lines = [np.linspace(box[k, 0], box[k, 1], count) for k, count in zip(moving, along, strict=True)]
    poses = np.tile(middle, (int(np.prod(along)), 1))
    for k, each in zip(moving, np.meshgrid(*lines, indexing="ij"), strict=True):
        poses[:, k] = each.ravel()
    return moving, poses, along


def _shifted(of: Callable[[Array, Array], Array], poses: Array) -> Array:
    """Return deviations, or their rows, as the mean of both sides, less one shift of all places, (m, ...)."""
    mean = (of(poses, np.ones_like(poses)) + of(poses, -np.ones_like(poses))) / 2
    shifted: Array = mean - mean.mean(axis=0)
    return shifted
