"""When a source of readings is given up: it skips without end, or reads what no machine does."""

from __future__ import annotations

from axiscal.campaign.sources import Skip
from axiscal.estimation.estimation import Estimation
from axiscal.exceptions import SourceError

PATIENCE = 25
"""So many skipped readings in a row are taken for a source that does not work."""


def refuse_endless(in_a_row: int, answer: Skip) -> None:
    """Raise SourceError where a source has skipped too many readings in a row, `answer` the last one."""
    if in_a_row >= PATIENCE:
        what = f"the source has skipped {in_a_row} readings in a row; the last one because: {answer.reason}"
        raise SourceError(what, "Mend it, then go on with --resume")


def refuse_implausible(known: Estimation) -> None:
    """Raise SourceError where the last reading is one that no error of the stated size could make."""
    last = len(known.readings) - 1
    doubt = next((doubt for doubt in known.outliers if doubt.implausible and doubt.reading == last), None)
    if doubt is not None:
        remedy = "It is kept and not relied on. Mend the source; if it is right, undo it and record it with --accept"
        raise SourceError(known.objection_to(doubt), remedy)
