"""Rows of an answer: what was found, how well that is known, what tables leave of it, and what is not measured.

found = √(estimate² + u²),    left = √((what the tables leave)² + u²),    both RMS over the places of a row
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from axiscal.errors.volume import Counted
from axiscal.estimation.accuracy.expanded import reach
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.functionals.asked import AskedRow, asked_rows
from axiscal.estimation.functionals.functional import Functional
from axiscal.estimation.functionals.known import KnownRow, known_row, with_one_more, without_readings
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread
from axiscal.tables.offer import places, unknown_rms
from axiscal.tables.surface import Control, left_by, rms


@dataclass(frozen=True)
class AnsweredRow(KnownRow):
    """A row of an answer, all sizes m or rad.

    found, largest : RMS and largest size of the error over the places, with what is not known of it
    stated : U before the first reading, as a plan says it: of the machine as described
    left : RMS that the tables of each control leave, by its name; none of rotations
    then : U of a row that is not measured, after one reading from the other side; None where that tells no more
    """

    found: float
    largest: float
    stated: float
    left: Mapping[str, float]
    then: float | None = None


@one_thread()
def answered(known: Estimation, controls: Mapping[str, Control]) -> tuple[AnsweredRow, ...]:
    """Return the rows of a campaign.  controls : what the tables of each control that is offered do"""
    described = known.stated.description
    asked = asked_rows(described, known.readings, whole=bool(described.target.lines))
    every = (
        _volume(each, known, controls) if each.map is None else _row(each, each.map, known, controls) for each in asked
    )
    found = [row for row in every if row.described]
    turned = with_one_more(known, [each.lines[0] for each in found if _unturned(each)])
    if turned is None:
        return tuple(found)
    errors, maps = known.case.errors, {each.want.row: each.map for each in asked}
    return tuple(
        replace(each, then=reach(functional.spectra(errors, turned.factor), turned.degrees))
        if _unturned(each) and functional is not None
        else each
        for each, functional in ((each, maps[each.row]) for each in found)
    )


def _unturned(row: AnsweredRow) -> bool:
    """Return whether a backlash is not measured although its axis was read."""
    return row.row.kind == "backlash" and not row.measured and row.lines[0].read > 0


def _row(asked: AskedRow, functional: Functional, known: Estimation, controls: Mapping[str, Control]) -> AnsweredRow:
    """Return a row along lines."""
    estimate = known.estimate()
    case, belief = known.case, known.printed.belief
    variances = functional.spectra(case.errors, belief.factor).sum(axis=1)
    if functional.angular:
        at, left = functional.rows(case.errors) @ estimate.mean, dict[str, Array]()
    else:
        where = functional.poses, functional.sides
        at = functional.row(estimate.deviation(*where))
        left = {
            name: functional.row(left_by(estimate.machine, estimate.deviation, control, *where))
            for name, control in controls.items()
        }
    found = _squares(functional, at) + variances
    return AnsweredRow(
        **vars(known_row(asked, case, belief, bool(known.readings))),
        found=float(np.sqrt(np.mean(found))),
        largest=float(np.sqrt(np.max(found))),
        stated=without_readings(asked, known.stated),
        left={name: float(np.sqrt(np.mean(_squares(functional, each) + variances))) for name, each in left.items()},
    )


def _squares(functional: Functional, row: Array) -> Array:
    """Return the squared length of each vector of a row (k,), (k/d,)."""
    squares: Array = np.sum(row.reshape(-1, functional.dimensions) ** 2, axis=1)
    return squares


def _volume(asked: AskedRow, known: Estimation, controls: Mapping[str, Control]) -> AnsweredRow:
    """Return the row of the volume."""
    estimate = known.estimate()
    where = places(estimate)
    unknown = unknown_rms(estimate)

    def shape(deviations: Array) -> Array:
        return deviations if estimate.alignment is None else estimate.alignment.left(where[0], deviations)

    def root_mean_square(deviations: Array) -> float:
        return float(np.hypot(rms(shape(deviations), estimate.counted), unknown))

    here = estimate.deviation(*where)
    return AnsweredRow(
        **vars(known_row(asked, known.case, known.printed.belief, bool(known.readings))),
        found=root_mean_square(here),
        largest=float(np.hypot(_farthest(shape(here), estimate.counted), unknown)),
        stated=without_readings(asked, known.stated),
        left={
            name: root_mean_square(left_by(estimate.machine, estimate.deviation, control, *where))
            for name, control in controls.items()
        },
    )


def _farthest(deviations: Array, counted: Counted) -> float:
    """Return the largest deviation (m, 3), their constant part taken off, m.  counted : the directions that count"""
    centred = (deviations - deviations.mean(axis=0))[:, list(counted)]
    return float(np.sqrt(np.max(np.sum(centred**2, axis=1))))
