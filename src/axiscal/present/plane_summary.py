"""One error of two axes as plain data in display units, beside the rest of a summary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.errors.iso230 import words
from axiscal.errors.model import ErrorModel, Term
from axiscal.errors.plane import PlaneError
from axiscal.estimation.estimation import Estimation
from axiscal.machine.names import COMPONENTS
from axiscal.numerics import Array
from axiscal.units import to_unit

_POSITIONS = 31
"""Points of a drawn map along each axis."""


@dataclass(frozen=True, slots=True)
class PlaneSummary:
    """One error of two axes over both; maps have a row for each position of the first axis.

    mean, std, prior_std : of what the axes do together alone, rest included; sign : +1 or -1, how the tool shows it
    whole_mean, whole_std : with the curves that each axis has alone in the same direction, signs as the tool moves,
        and their mean over the plane taken off
    """

    name: str
    axes: tuple[str, str]
    caption: str
    position: tuple[Sequence[float], Sequence[float]]
    position_unit: tuple[str, str]
    value_unit: str
    mean: Sequence[Sequence[float]]
    std: Sequence[Sequence[float]]
    prior_std: Sequence[Sequence[float]]
    whole_mean: Sequence[Sequence[float]]
    whole_std: Sequence[Sequence[float]]
    from_readings: float = 0.0
    sign: float = 1.0


def planes(estimation: Estimation) -> list[PlaneSummary]:
    """Return every error that is a function of two positions."""
    return [_plane(estimation, plane) for plane in estimation.case.errors.planes]


def _plane(estimation: Estimation, plane: PlaneError) -> PlaneSummary:
    errors, belief = estimation.case.errors, estimation.printed.belief
    axes = tuple(errors.machine.axes[index] for index in plane.axes)
    at = tuple(np.linspace(*axis.travel, _POSITIONS) for axis in axes)
    poses = np.tile(np.array(errors.machine.zero), (_POSITIONS**2, 1))
    poses[:, list(plane.axes)] = np.stack([grid.ravel() for grid in np.meshgrid(*at, indexing="ij")], axis=1)
    own, whole = (_rows(errors, terms, poses) for terms in ([plane], _beside(errors, plane)))
    whole -= whole.mean(axis=0)  # where the zero lies is no shape
    sign = float(errors.machine.axes[plane.axis].sign)
    rest = plane.rest**2
    beside = sum(term.rest**2 for term in _beside(errors, plane))
    prior = estimation.case.prior.factor[: errors.size]
    known, before = (_std(own, factor, rest) for factor in (belief.factor[: errors.size], prior))
    mean, unit = belief.mean[: errors.size], "urad" if plane.angular else "um"
    first, second = axes
    return PlaneSummary(
        name=plane.name,
        axes=(first.name, second.name),
        caption=words(plane.name),
        position=(to_unit(at[0], first.unit).tolist(), to_unit(at[1], second.unit).tolist()),
        position_unit=(first.unit, second.unit),
        value_unit=unit,
        mean=_map(sign * (own @ mean), unit),
        std=_map(known, unit),
        prior_std=_map(before, unit),
        whole_mean=_map(whole @ mean, unit),
        whole_std=_map(_std(whole, belief.factor[: errors.size], beside), unit),
        sign=sign,
        from_readings=float(np.clip(1.0 - np.sum(known**2) / np.sum(before**2), 0.0, 1.0)),
    )


def _beside(errors: ErrorModel, plane: PlaneError) -> list[Term]:
    """Return the plane and the curves in its direction that its axes have alone."""
    names = {f"E{COMPONENTS[plane.component]}{errors.machine.axes[axis].name}" for axis in plane.axes}
    return [*(function for function in errors.functions if function.name in names), plane]


def _rows(errors: ErrorModel, terms: Sequence[Term], poses: Array) -> Array:
    """Return the rows of a sum of errors, each with the sign that it has at the tool, (m, size)."""
    rows = np.zeros((len(poses), errors.size))
    for term in terms:
        rows[:, term.columns] = errors.machine.axes[term.axis].sign * term.rows(term.coordinates(poses))
    return rows


def _std(rows: Array, factor: Array, rest: float) -> Array:
    std: Array = np.sqrt(np.sum((rows @ factor) ** 2, axis=1) + rest)
    return std


def _map(values: Array, unit: str) -> list[list[float]]:
    shown: list[list[float]] = to_unit(values.reshape(_POSITIONS, _POSITIONS), unit).tolist()
    return shown
