"""What stderr shows of a campaign: prospects, and progress as one line that changes, on a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import Milestone
from axiscal.cli.printing import rewrite, tell
from axiscal.cli.texts import accuracy_text
from axiscal.description.target import Target
from axiscal.language.spoken import put, said
from axiscal.language.stages import listening
from axiscal.present.plan_answer import reach_answer
from axiscal.present.plan_words import reach_text
from axiscal.units import to_unit


@contextmanager
def shown_progress(target: Target) -> Iterator[Callable[[Milestone], None]]:
    """Yield what is to be told of every reading: a line that changes on a terminal, elsewhere nothing.

    Nothing is written between two readings: what a source asks whoever stands at the machine stands alone.
    """
    with listening(None):
        if not sys.stderr.isatty():
            yield lambda milestone: None
            return
        try:
            yield lambda milestone: rewrite(progress_line(milestone, target))
        finally:
            tell("")


def progress_line(milestone: Milestone, target: Target) -> str:
    """Return one line: reading, accuracy with its targets, minutes."""
    number = said("reading {number}", number=milestone.number)
    if target.readings is not None:
        number = said("{reading} of {most}", reading=number, most=target.readings)
    accuracy, passed = accuracy_text(milestone.accuracy, target), to_unit(milestone.seconds, "min")
    minutes = said("{minutes:.1f} min", minutes=passed)
    return put("{number}: {accuracy}, {minutes}", number=number, accuracy=accuracy, minutes=minutes)


def tell_out_of_reach(campaign: Campaign) -> None:
    """Say before the first reading if the target cannot be reached with the set-ups."""
    if campaign.state.readings:
        return
    reach = reach_answer(campaign.estimate(ended=True).case)
    if reach is not None:
        tell(reach_text(reach))
