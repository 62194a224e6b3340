"""The error of the volume: what the tool does at places spread over it, as found, as left, and how well it is known."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.accuracy.expanded import BAND
from axiscal.compensation.effect import Control, left_by
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.machine_estimate import Estimate
from axiscal.language.spoken import listed, put
from axiscal.machine.kinematics import frames
from axiscal.numerics import Array
from axiscal.units import said_quantity, to_unit

_COUNTS = {1: (11,), 2: (7, 7), 3: (5, 5, 3)}
"""Places along the axes that move, the longest first: enough to see a shape; a matter of taste."""

Triple = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class VolumeError:
    """Deviations of the tool point from the workpiece at places, one shift of all of them taken off.

    axes : that move from place to place; parked : where the others stand, in words, "" where none does
    tcp_mm : nominal places in the workpiece frame; found_um : as estimated; half_um : ± of it, 95 %, along x, y, z
    left_um : with the tables of `controller` loaded, as estimated; empty where there are none
    """

    axes: Sequence[str]
    parked: str
    tcp_mm: Sequence[Triple]
    found_um: Sequence[Triple]
    half_um: Sequence[Triple]
    left_um: Sequence[Triple] = ()
    controller: str = ""


def volume_error(estimation: Estimation, controller: str = "", control: Control | None = None) -> VolumeError:
    """Return the error of the volume; both sides from which an axis may come count alike.

    control : what the tables of `controller` do, None where there are none
    """
    estimate = estimation.estimate()
    moving = _moving(estimate)
    poses = _places(estimate, moving)
    found = _either_way(lambda sides: estimate.deviation(poses, sides), poses)
    left = () if control is None else _rows(_either_way(
        lambda sides: left_by(estimate.machine, estimate.deviation, control, poses, sides), poses))  # fmt: skip
    axes = estimate.machine.axes
    still = [(axis, said_quantity(float(poses[0, k]), axis.unit, 4)) for k, axis in enumerate(axes) if k not in moving]
    parked = listed(", ", [put("{axis} {at}", axis=axis.name, at=at) for axis, at in still])
    places = [(x, y, z) for x, y, z in to_unit(frames(estimate.machine, poses).tcp, "mm").tolist()]
    names = [axes[k].name for k in moving]
    return VolumeError(names, parked, places, _rows(found), _rows(_half(estimate, poses)), left, controller)


def _moving(estimate: Estimate) -> list[int]:
    """Return the axes that span the picture: the linear ones, or else those that turn."""
    spans = [high - low for low, high in estimate.box]
    free = [k for k, span in enumerate(spans) if span > 0]
    linear = [k for k in free if not estimate.machine.axes[k].rotary]
    return sorted(sorted(linear or free, key=lambda k: -spans[k])[:3])


def _places(estimate: Estimate, moving: Sequence[int]) -> Array:
    """Return a grid over the axes that move, (m, q); rotary ones stand as near to zero as the volume lets them."""
    box, axes = np.array(estimate.box), estimate.machine.axes
    middle = np.where([axis.rotary for axis in axes], np.clip(0.0, box[:, 0], box[:, 1]), box.mean(axis=1))
    spans = box[list(moving), 1] - box[list(moving), 0]
    order = np.argsort(np.argsort(-spans, kind="stable"), kind="stable")
    counts = [_COUNTS[len(moving)][rank] for rank in order] if moving else []
    lines = [np.linspace(box[k, 0], box[k, 1], count) for k, count in zip(moving, counts, strict=True)]
    poses = np.tile(middle, (int(np.prod(counts)), 1))
    for k, each in zip(moving, np.meshgrid(*lines, indexing="ij"), strict=True):
        poses[:, k] = each.ravel()
    return poses


def _either_way(deviation: Callable[[Array], Array], poses: Array) -> Array:
    """Return the mean of both sides, (m, 3), less one shift of all places."""
    mean = (deviation(np.ones_like(poses)) + deviation(-np.ones_like(poses))) / 2
    shifted: Array = mean - mean.mean(axis=0)
    return shifted


def _half(estimate: Estimate, poses: Array) -> Array:
    """Return ± of the deviation along x, y and z, 95 %, one shift of all places taken off, (m, 3) m."""
    rows = (estimate.model.rows(poses, np.ones_like(poses)) + estimate.model.rows(poses, -np.ones_like(poses))) / 2
    spread = (rows - rows.mean(axis=0)) @ estimate.factor
    rests = np.einsum("fmc,f->mc", estimate.model.levers(poses) ** 2, estimate.model.rests**2)
    half: Array = BAND * np.sqrt(np.sum(spread**2, axis=2) + rests)
    return half


def _rows(metres: Array) -> list[Triple]:
    return [(x, y, z) for x, y, z in to_unit(metres, "um").tolist()]
