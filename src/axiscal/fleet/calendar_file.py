"""Dates at which machines are due as a calendar (iCalendar, RFC 5545)."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime

from axiscal.fleet.due_dates import DueMachine, titles
from axiscal.units import to_unit

_LONGEST = 75
"""Octets of a line (RFC 5545 3.1)."""


def calendar(machines: Sequence[DueMachine], now: datetime) -> str:
    """Return the calendar, a day for each machine that is due; the same machine keeps its entry."""
    lines = ["BEGIN:VCALENDAR", "VERSION:2.0", "PRODID:-//axiscal//due//EN"]
    for machine, name in zip(machines, titles(machines), strict=True):
        if machine.due is None:
            continue
        minutes = machine.minutes if machine.again is None else machine.again.seconds / 60.0
        said = f"{_why(machine)}; last measured {machine.last}, {machine.record.name}; about {minutes:.0f} minutes"
        lines += [
            "BEGIN:VEVENT",
            f"UID:{machine.digest[:32]}@axiscal",
            f"DTSTAMP:{now.astimezone(UTC):%Y%m%dT%H%M%SZ}",
            f"DTSTART;VALUE=DATE:{machine.due:%Y%m%d}",
            f"SUMMARY:{_escaped(f'{name} is due for calibration')}",
            f"DESCRIPTION:{_escaped(said)}",
            "END:VEVENT",
        ]
    return "".join(f"{_folded(line)}\r\n" for line in [*lines, "END:VCALENDAR"])


def _why(machine: DueMachine) -> str:
    if machine.by_worst or machine.target is None:
        return "the worst place may be beyond its tolerance"
    return f"RMS passes {to_unit(machine.target, 'um'):.3g} um"


def _escaped(text: str) -> str:
    for sign in "\\;,":
        text = text.replace(sign, f"\\{sign}")
    return text.replace("\n", "\\n")


def _folded(line: str) -> str:
    """Return a line in pieces that are short enough, none of which cuts a letter."""
    pieces, piece = list[str](), ""
    for letter in line:
        if len((piece + letter).encode()) > _LONGEST:
            pieces.append(piece)
            piece = " "
        piece += letter
    return "\r\n".join([*pieces, piece])
