"""A campaign opened to be changed by one command; after Ctrl-C the error says what was kept and what to call next."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.exceptions import AxiscalError
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
                    f"Stopped by Ctrl-C. {_kept(before, campaign.looked_at_again(), record, going_on)}"
                ) from None
    except KeyboardInterrupt:
        raise AxiscalError(f"Stopped by Ctrl-C. Nothing was added to {record}; give the command again.") from None


def _kept(before: State, now: State, record: Path, going_on: str) -> str:
    """Return what has happened since, in words, and what to call next."""
    if now.last == before.last:
        return f"Nothing was added to {record}; give the command again."
    onwards = f"go on with: axiscal {going_on} {record}"
    if now.finished is not None and before.finished is None:
        return f"The end was kept; write the results: axiscal finish {record} --out DIR"
    if len(now.readings) > len(before.readings):
        return f"Reading {now.readings[-1].number} was kept; {onwards}"
    if len(now.skipped) > len(before.skipped):
        return f"The skip was kept; {onwards}"
    if len(now.undo) < len(before.undo):
        return f"What was to be taken back is taken back; {onwards}"
    return f"No reading was added; {onwards}"
