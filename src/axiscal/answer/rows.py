"""Rows of an answer: what was found, how well that is known, what tables leave of it, and what is not measured.

    found = √(estimate² + u²),    left = √((what the tables leave)² + u²),    both RMS over the places of a row

U is the size that 95 % of what is not known stays below, over the posterior and over the places. A row whose U is more
than half of its U before the first reading is not measured.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from axiscal.accuracy.expanded import expanded, expanded_floor, reach
from axiscal.answer.asked import Asked, asked_rows
from axiscal.answer.functional import Functional
from axiscal.answer.line import Line
from axiscal.answer.one_more import with_one_more
from axiscal.compensation.effect import Control, left_by, rms, tour
from axiscal.compensation.offer import POSES, spread_poses, unknown_rms
from axiscal.description.wants import Row, Want
from axiscal.error_model.model import ErrorModel
from axiscal.error_model.volume import Counted
from axiscal.estimation.bands import Banded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.uncertain import expanded_uncertainty
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread

_MEASURED = 0.5
"""Of the U before the first reading: a row that is known no better is not measured."""


@dataclass(frozen=True)
class Answered:
    """A row of an answer, all sizes m or rad.

    angular : they are rad
    found, largest : RMS and largest size of the error over the places, with what is not known of it
    known : U; before : U before the first reading, at the sizes as learnt; floor : U that endless readings leave
    left : RMS that the tables of each control leave, by its name; none of rotations
    limit : what U is to be; None where no limit is given
    measured : whether readings tell it; then : U after one reading from the other side; None where that tells no more
    lines : where it holds
    """

    row: Row
    angular: bool
    found: float
    largest: float
    known: float
    before: float
    floor: float
    left: Mapping[str, float]
    limit: float | None
    measured: bool
    lines: tuple[Line, ...] = ()
    then: float | None = None

    @property
    def reached(self) -> bool | None:
        """Whether it is known as well as asked for; None where no limit is given."""
        return None if self.limit is None else self.measured and self.known <= self.limit

    @property
    def reachable(self) -> bool:
        """Whether endless readings with these set-ups would do; true where no limit is given."""
        return self.limit is None or self.floor <= self.limit


@one_thread()
def answered(known: Estimation, controls: Mapping[str, Control]) -> tuple[Answered, ...]:
    """Return the rows of a campaign.  controls : what the tables of each control that is offered do"""
    asked = asked_rows(known.stated.description, known.readings)
    found = [
        _volume(each.want, known, controls) if each.map is None else _row(each, each.map, known, controls)
        for each in asked
    ]
    turned = with_one_more(known, [each.lines[0] for each in found if _unturned(each)])
    if turned is None:
        return tuple(found)
    maps = {each.want.row: each.map for each in asked}
    return tuple(
        replace(each, then=_u(functional, turned)) if _unturned(each) and functional is not None else each
        for each, functional in ((each, maps[each.row]) for each in found)
    )


def _unturned(row: Answered) -> bool:
    """Return whether a backlash is not measured although its axis was read."""
    return row.row.kind == "backlash" and not row.measured and row.lines[0].read > 0


def _row(asked: Asked, functional: Functional, known: Estimation, controls: Mapping[str, Control]) -> Answered:
    """Return a row along lines."""
    estimate, wide = known.estimate(), known.banded
    variances = _variances(functional, wide.case.errors, wide.knowledge.belief.factor)
    if functional.angular:
        at, left = functional.rows(wide.case.errors) @ estimate.mean, dict[str, Array]()
    else:
        where = functional.poses, functional.sides
        at = functional.of(estimate.deviation(*where))
        left = {
            name: functional.of(left_by(estimate.machine, estimate.deviation, control, *where))
            for name, control in controls.items()
        }
    before = reach(_variances(functional, wide.case.errors, wide.case.prior.factor)[:, None])
    u = reach(variances[:, None])
    return Answered(
        asked.want.row,
        functional.angular or asked.want.row.kind == "squareness",
        found=_size(at, variances),
        largest=float(np.sqrt(np.max(at**2 + variances))),
        known=u,
        before=before,
        floor=reach(_variances(functional, wide.case.errors, wide.case.yardstick.left)[:, None]),
        left={name: _size(each, variances) for name, each in left.items()},
        limit=asked.want.limit,
        measured=bool(u <= _MEASURED * before),
        lines=asked.lines,
    )


def _u(functional: Functional, wide: Banded) -> float:
    return reach(_variances(functional, wide.case.errors, wide.knowledge.belief.factor)[:, None])


def _variances(functional: Functional, errors: ErrorModel, factor: Array) -> Array:
    """Return the variances of a row, (k,).  factor : F (n, r) of what is not known, of the errors first"""
    spread = functional.rows(errors) @ factor[: errors.size]
    variances: Array = np.sum(spread**2, axis=1) + functional.rests(errors)
    return variances


def _size(at: Array, variances: Array) -> float:
    """Return √(estimate² + u²), RMS over the places."""
    return float(np.sqrt(np.mean(at**2 + variances)))


def _volume(want: Want, known: Estimation, controls: Mapping[str, Control]) -> Answered:
    """Return the row of the volume: U is the one that a report begins with."""
    estimate, wide = known.estimate(), known.banded.case
    sample = estimate.sample
    where = spread_poses(estimate) if sample is None else tour(sample[:POSES], estimate.box)
    unknown = unknown_rms(estimate, *where)

    def shape(deviations: Array) -> Array:
        return deviations if estimate.alignment is None else estimate.alignment.left(where[0], deviations)

    def size(deviations: Array) -> float:
        return float(np.hypot(rms(shape(deviations), estimate.counted), unknown))

    here = estimate.deviation(*where)
    u = expanded_uncertainty(known)
    return Answered(
        want.row,
        angular=False,
        found=size(here),
        largest=float(np.hypot(_farthest(shape(here), estimate.counted), unknown)),
        known=u.space,
        before=expanded(wide.yardstick, wide.prior).space,
        floor=expanded_floor(wide.yardstick).space,
        left={
            name: size(left_by(estimate.machine, estimate.deviation, control, *where))
            for name, control in controls.items()
        },
        limit=known.stated.description.target.expanded,
        measured=bool(known.readings),
    )


def _farthest(deviations: Array, counted: Counted) -> float:
    """Return the largest deviation (m, 3), their constant part taken off, m.  counted : the directions that count"""
    centred = (deviations - deviations.mean(axis=0))[:, list(counted)]
    return float(np.sqrt(np.max(np.sum(centred**2, axis=1))))
