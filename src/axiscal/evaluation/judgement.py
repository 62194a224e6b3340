"""What the readings of a check say of a compensated machine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from axiscal.evaluation.datums import Datum
from axiscal.evaluation.table_checks import Share
from axiscal.numerics import Array

_UNLIKELY = 0.01
HARDLY = 1e-4
"""A change of the readings that is less likely than this is not the one that the tables make."""

Verdict = Literal["pass", "fail", "undecided"]


@dataclass(frozen=True, eq=False, slots=True)
class Judgement:
    """What as-found and as-left readings say; m.

    found, left : (m,) deviations, one for each value of a reading, the datums of the set-ups taken off
    std : (m,) of each, from the instrument and from what else is not known of its set-up
    agrees : probability that as-left readings lie this far from what the estimate expects, if it is right
    changed : probability that the tables change readings as little like they should as these, if they are loaded
    share : by which multiple of what the tables take away the readings changed; None when that is nothing
    lines : set-ups that are judged against their own line; strained : datums further off than stated
    still : set-ups all of whose as-left readings show one and the same number
    shares : how much of each table the readings show; idle : axes that were not moved through their volume, or along
        which nothing was read
    tools : set-ups that are judged with the tool where the readings put it
    proved : what as-left deviations alone prove of the tolerance (ISO 14253-1), whatever the tables do
    """

    verdict: Verdict
    tolerance: float
    found: Array
    left: Array
    std: Array
    agrees: float
    changed: float
    share: float | None
    lines: tuple[str, ...]
    strained: tuple[Datum, ...]
    still: tuple[str, ...] = ()
    shares: tuple[Share, ...] = ()
    idle: tuple[str, ...] = ()
    tools: tuple[str, ...] = ()
    proved: Verdict = "undecided"

    @property
    def loaded(self) -> bool:
        """Whether the readings changed as the tables make them."""
        return self.changed >= HARDLY

    @property
    def faulty(self) -> tuple[Share, ...]:
        """The tables that are missing, or loaded with the wrong sign."""
        return tuple(share for share in self.shares if share.checked and not share.works)

    @property
    def unchecked(self) -> tuple[str, ...]:
        """The tables of which the readings cannot tell whether they work."""
        return tuple(share.name for share in self.shares if not share.checked)

    @property
    def believed(self) -> bool:
        """Whether the readings agree with the estimate and its uncertainty."""
        return self.agrees >= _UNLIKELY
