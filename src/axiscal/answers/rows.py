"""Rows of an answer: what was found, how well that is known, what tables leave of it, and what is not measured.

found = √(estimate² + u²),    left = √((what the tables leave)² + u²),    both RMS over the places of a row
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from axiscal.estimation.accuracy.expanded import reach
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.functionals.asked import AskedRow, asked_rows
from axiscal.estimation.functionals.known import KnownRow, known_row, with_one_more, without_readings
from axiscal.estimation.machine_estimate import Estimate
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread
from axiscal.tables.offer import places, unknown_rms
from axiscal.tables.surface import Control, left_by


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
    found = [row for row in (_row(each, known, controls) for each in asked) if row.described]
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


def _row(asked: AskedRow, known: Estimation, controls: Mapping[str, Control]) -> AnsweredRow:
    """Return a row along lines, or that of the volume."""
    estimate, errors, belief, functional = known.estimate(), known.case.errors, known.printed.belief, asked.map
    shown: Callable[[Array], Array]
    if functional is None:
        where, dimensions = places(estimate), sum(estimate.counted)
        variances, shown = np.array(unknown_rms(estimate) ** 2), partial(_counted, estimate, where[0])
    else:
        where, dimensions, shown = (functional.poses, functional.sides), functional.dimensions, functional.row
        variances = functional.spectra(errors, belief.factor).sum(axis=1)
    if functional is not None and functional.angular:
        at, left = functional.rows(errors) @ estimate.mean, dict[str, Array]()
    else:
        after = partial(left_by, estimate.machine, estimate.deviation)
        at, left = (
            shown(estimate.deviation(*where)),
            {name: shown(after(each, *where)) for name, each in controls.items()},
        )

    def squares(row: Array) -> Array:
        """Return the squared length of each vector of a row, with what is not known of it."""
        found: Array = np.sum(row.reshape(-1, dimensions) ** 2, axis=1) + variances
        return found

    return AnsweredRow(
        **vars(known_row(asked, known.case, belief, bool(known.readings))),
        found=float(np.sqrt(np.mean(squares(at)))),
        largest=float(np.sqrt(np.max(squares(at)))),
        stated=without_readings(asked, known.stated),
        left={name: float(np.sqrt(np.mean(squares(each)))) for name, each in left.items()},
    )


def _counted(estimate: Estimate, poses: Array, deviations: Array) -> Array:
    """Return what counts of deviations (m, 3), their constant part taken off, one after another, (m d,)."""
    shaped = deviations if estimate.alignment is None else estimate.alignment.left(poses, deviations)
    centred: Array = (shaped - shaped.mean(axis=0))[:, list(estimate.counted)]
    return centred.ravel()
