"""The verdict on an estimate, and what it rests on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from axiscal.accuracy.expanded import Expanded
from axiscal.estimation.checks import Checks
from axiscal.estimation.defence import Defence
from axiscal.inference.contradiction import Comparison
from axiscal.measurement.reading import Reading

VerdictWord = Literal["holds", "widened", "contradicted", "unchecked"]


@dataclass(frozen=True, eq=False, slots=True)
class Ruling:
    """verdict : in one word

        contradicted  the readings contradict every explanation that was tried: nothing is promised
        widened       they contradict the model; what explains them is averaged over, in means and bands
        unchecked     they could not have shown what would make the promise much too good
        holds         they could have contradicted it, and did not; or could have, had it been a little larger, which it
                      is made then

    comparison : of the departures with the model; expanded : what may be promised, never less than the model does
    defence : what the readings can vouch for, beside what is promised
    standard : uncertainty, RMS over the volume, of the distribution that `expanded` is of, m: of the model, or of the
        mixture over scales and departures where that promises less
    model : the share of the belief that the model as it is holds, other scales among it, 0 to 1
    inflated : the factor on the variances of the last resort (Birge), 1 where it is not needed
    raised : how many times as large as the model's bands and tables are, so that what readings would not show does not
        spoil the promise; 1 where that is not needed
    readings : those that were compared; one that others contradict is among them where a shape explains that as well
    checks : what readings say that were predicted before they were used, None where there were too few
    """

    verdict: VerdictWord
    comparison: Comparison
    expanded: Expanded
    defence: Defence
    standard: float
    model: float = 1.0
    inflated: float = 1.0
    raised: float = 1.0
    checks: Checks | None = None
    readings: tuple[Reading, ...] = ()

    @property
    def promises(self) -> bool:
        """Whether an accuracy may be said at all."""
        return self.verdict != "contradicted"
