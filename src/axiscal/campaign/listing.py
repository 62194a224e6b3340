"""Records, each with where its campaign stands, as fast as they can be read: nothing is estimated."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from axiscal.exceptions import AxiscalError
from axiscal.machine import machine_from_text
from axiscal.record.events import State
from axiscal.record.store import Record


class Standing(NamedTuple):
    """Where the campaign of a record stands.  machine : its name; at : time of the last event, ISO 8601, UTC"""

    file: Path
    machine: str
    at: str
    state: State


def standings(files: Iterable[Path]) -> tuple[list[Standing], list[AxiscalError]]:
    """Return where each campaign stands, and why records cannot be read."""
    found, faults = list[Standing](), list[AxiscalError]()
    for file in files:
        try:
            record = Record.open(file, write=False)
            state = record.state()
            machine = machine_from_text(state.created.machine_text if state.created else "").name
        except AxiscalError as fault:
            faults.append(fault)
        else:
            found.append(Standing(file, machine, record.rows[-1].at, state))
    return found, faults
