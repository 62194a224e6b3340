"""A campaign opened to be changed by one command; after Ctrl-C the error says what was kept and what to call next."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.exceptions import AxiscalError
from axiscal.language.spoken import said
from axiscal.record.events import State


@contextmanager
def opened_to_write(record: Path, going_on: str = "next") -> Iterator[Campaign]:
    """Yield the campaign; raises AxiscalError in the place of KeyboardInterrupt.

    going_on : the command that goes on with it
    """
    try:
        with Campaign.open(record) as campaign:
            before = campaign.state
            try:
                yield campaign
            except KeyboardInterrupt:
                raise AxiscalError(
                    said("Stopped by Ctrl-C. {kept}", kept=_kept(before, campaign.looked_at_again(), record, going_on))
                ) from None
    except KeyboardInterrupt:
        raise AxiscalError(said("Stopped by Ctrl-C. {kept}", kept=_nothing(record))) from None


def _kept(before: State, now: State, record: Path, going_on: str) -> str:
    """Return what has happened since, in words, and what to call next."""
    if now.last == before.last:
        return _nothing(record)
    what = "No reading was added; go on with: axiscal {going_on} {record}"
    if now.finished is not None and before.finished is None:
        what = "The end was kept; write the results: axiscal finish {record}"
    elif len(now.readings) > len(before.readings):
        what = "Reading {number} was kept; go on with: axiscal {going_on} {record}"
    elif len(now.skipped) > len(before.skipped):
        what = "The skip was kept; go on with: axiscal {going_on} {record}"
    elif len(now.undo) < len(before.undo):
        what = "What was to be taken back is taken back; go on with: axiscal {going_on} {record}"
    number = now.readings[-1].number if now.readings else None
    return said(what, number=number, going_on=going_on, record=record)


def _nothing(record: Path) -> str:
    return said("Nothing was added to {record}; give the command again.", record=record)
