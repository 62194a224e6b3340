"""How well the rows of an answer are known, and whether that is as well as asked for.

U is the size that 95 % of what is not known stays below, over the posterior and over the places. A row whose U is more
than half of its U before the first reading is not measured.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from axiscal.accuracy.expanded import expanded, expanded_floor, reach
from axiscal.accuracy.yardstick import attainable
from axiscal.answer.asked import AskedRow, asked_rows
from axiscal.answer.axis_line import AxisLine
from axiscal.answer.functional import Functional
from axiscal.description.wants import RowName
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.uncertain import expanded_uncertainty
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread

_MEASURED = 0.5
"""Of the U before the first reading: a row that is known no better is not measured."""


@dataclass(frozen=True)
class KnownRow:
    """How well a row is known, all sizes m or rad.

    angular : they are rad
    known : U; before : U before the first reading, at the sizes as learnt; floor : U that endless readings leave
    limit : what U is to be; None where no limit is given
    measured : whether readings tell it
    lines : where it holds
    """

    row: RowName
    angular: bool
    known: float
    before: float
    floor: float
    limit: float | None
    measured: bool
    lines: tuple[AxisLine, ...]

    @property
    def reached(self) -> bool | None:
        """Whether it is known as well as asked for; None where no limit is given."""
        return None if self.limit is None else self.measured and self.known <= self.limit

    @property
    def reachable(self) -> bool:
        """Whether endless readings would reach its limit, or measure it where no limit is given."""
        return self.floor <= self._goal

    @property
    def settled(self) -> bool:
        """Whether it is reached, or measured where no limit is given; else whether readings took away what they can."""
        return self.known <= attainable(self._goal, self.floor)

    @property
    def _goal(self) -> float:
        measured = math.inf if self.row.kind == "volume" else _MEASURED * self.before
        return min(math.inf if self.limit is None else self.limit, measured)


@one_thread()
def known_rows(known: Estimation) -> tuple[KnownRow, ...]:
    """Return how well the rows of a campaign are known, as far as its set-ups may read them."""
    asked = asked_rows(known.stated.description, known.readings, whole=True)
    return tuple(_known(each, each.map, known) for each in asked)


def _known(asked: AskedRow, functional: Functional | None, known: Estimation) -> KnownRow:
    if functional is None:
        return known_volume(asked, known)
    return known_line(asked, functional, known, spectra_of(functional, known))


def spectra_of(functional: Functional, known: Estimation) -> Array:
    """Return the variances of each vector of a row along its main directions, (k/d, d)."""
    wide = known.banded
    return functional.spectra(wide.case.errors, wide.knowledge.belief.factor)


def known_line(asked: AskedRow, functional: Functional, known: Estimation, spectra: Array) -> KnownRow:
    """Return how well a row along lines is known.  spectra : `spectra_of` it"""
    wide, kind = known.banded.case, asked.want.row.kind
    before, u = reach(functional.spectra(wide.errors, wide.prior.factor)), reach(spectra)
    return KnownRow(
        asked.want.row,
        functional.angular or kind == "squareness",
        known=u,
        before=before,
        floor=reach(functional.spectra(wide.errors, wide.yardstick.left)),
        limit=asked.want.limit,
        measured=bool(u <= _MEASURED * before),
        lines=asked.lines,
    )


def known_volume(asked: AskedRow, known: Estimation) -> KnownRow:
    """Return how well the volume is known: U is the one that a report begins with."""
    wide = known.banded.case
    return KnownRow(
        asked.want.row,
        angular=False,
        known=expanded_uncertainty(known).space,
        before=expanded(wide.yardstick, wide.prior).space,
        floor=expanded_floor(wide.yardstick).space,
        limit=known.stated.description.target.expanded,
        measured=bool(known.readings),
        lines=(),
    )
