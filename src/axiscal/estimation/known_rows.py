"""How well the rows of an answer are known, and whether that is as well as asked for.

U is the size that 95 % of what is not known stays below, over the posterior and over the places. A row whose U is more
than half of its U before the first reading is not measured.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.description.target import RowName, dimension
from axiscal.estimation.accuracy.expanded import expanded, expanded_floor, reach
from axiscal.estimation.accuracy.yardstick import attainable
from axiscal.estimation.case import Case, Knowledge
from axiscal.estimation.functionals.asked import AskedRow, asked_rows
from axiscal.estimation.functionals.functional import NOUGHT, AxisLine
from axiscal.exceptions import DescriptionError
from axiscal.measurement.reading import Reading
from axiscal_core.normal import Normal
from axiscal_core.threads import one_thread

_MEASURED = 0.5
"""Of the U before the first reading: a row that is known no better is not measured."""


@dataclass(frozen=True)
class KnownRow:
    """How well a row is known, all sizes m or rad.

    angular : they are rad
    known : U; before : U without readings; floor : U that endless readings leave, both at the sizes as learnt
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
    def unit(self) -> str:
        """The unit in which the row is shown."""
        return "um/m" if self.row.kind == "scale" else "urad" if self.angular else "um"

    @property
    def described(self) -> bool:
        """Whether an error of the description makes the row or somebody set it a limit."""
        return self.limit is not None or self.before > NOUGHT

    @property
    def reached(self) -> bool | None:
        """Whether it is known as well as asked for; None where no limit is given."""
        return None if self.limit is None else self.measured and self.known <= self.limit

    @property
    def open(self) -> bool:
        """Whether it is not reached; without a limit: not measured, though readings can."""
        return self.reached is False or (self.limit is None and self.reachable and not self.measured)

    @property
    def reachable(self) -> bool:
        """Whether endless readings would reach its limit (without a limit: would measure it)."""
        return self.floor <= self.goal

    @property
    def settled(self) -> bool:
        """Whether it is reached (without a limit: measured) or readings took away what they can."""
        return self.known <= attainable(self.goal, self.floor)

    @property
    def goal(self) -> float:
        """U at which it is reached, or measured where no limit is given; of the volume inf where none is."""
        measured = math.inf if self.row.kind == "volume" else _MEASURED * self.before
        return min(math.inf if self.limit is None else self.limit, measured)


@one_thread()
def known_rows(case: Case, knowledge: Knowledge, readings: Sequence[Reading]) -> tuple[KnownRow, ...]:
    """Return how well the rows of a campaign are known, as far as its set-ups may read them."""
    asked = asked_rows(case.description, readings, whole=True)
    found = (known_row(each, case, knowledge.belief, bool(readings)) for each in asked)
    return tuple(row for row in found if row.described)


def known_row(asked: AskedRow, case: Case, belief: Normal, read: bool, prior: Normal | None = None) -> KnownRow:
    """Return how well a belief knows a row.

    read : whether any reading was taken; prior : what is known without, None for that at the sizes of the case
    """
    before, own, target = u_of_row(asked, case, prior), asked.own, case.description.target
    u = before if belief is (case.prior if prior is None else prior) else u_of_row(asked, case, belief)
    limit = target.expanded if asked.map is None else asked.want.limit
    if own is None:
        floor = expanded_floor(case.yardstick_as_sized).space
    else:
        floor = reach(own.spectra(case.errors, case.yardstick_as_sized.left))
    angular = dimension(asked.want.row, case.description.machine) == "angle"
    measured = read if asked.map is None else before > NOUGHT and u <= _MEASURED * before
    return KnownRow(asked.want.row, angular, u, before, min(floor, u), limit, bool(measured), asked.lines)


def refuse_unmade(case: Case) -> None:
    """Raise DescriptionError where a row is wanted that no error of the machine makes.  case : as described"""
    described, target = case.description, case.description.target
    for asked in asked_rows(described, ()):
        wanted = target.wants or (asked.map is None and target.accurate)
        if wanted and (_off_at_corners(case) if asked.own is None else u_of_row(asked, case)) <= NOUGHT:
            what = "{row} is wanted, and no error of {machine} makes it"
            remedy, machine = "Describe that error there, or ask for something else", described.machine_source
            raise DescriptionError(what, remedy, described.source, row=asked.want.row.name, machine=machine)


def _off_at_corners(case: Case) -> float:
    """Return the most that one unknown moves the tool point at two corners of the volume, along what counts, m."""
    target, factor = case.description.target, case.prior.factor[: case.errors.size]
    corners = np.array(target.volume).T
    rows = case.errors.rows_at(corners, np.ones_like(corners))[:, list(target.counted)]
    return float(np.abs(rows @ factor).max())


def u_of_row(asked: AskedRow, case: Case, belief: Normal | None = None) -> float:
    """Return U of a row, m or rad.  belief : None for that without readings, at the sizes of the case"""
    belief = case.prior if belief is None else belief
    if asked.own is None:
        return expanded(case.yardstick, belief).space
    return reach(asked.own.spectra(case.errors, belief.factor), belief.degrees)
