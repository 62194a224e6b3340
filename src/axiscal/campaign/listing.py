"""Records, each with where its campaign stands, as fast as they can be read: nothing is estimated."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from axiscal.exceptions import AxiscalError
from axiscal.machine import machine_from_text
from axiscal.record.events import Finished, KeptResult
from axiscal.record.store import Record


class Standing(NamedTuple):
    """Where the campaign of a record stands.

    file : the record
    machine : its name
    at : time of the last event, ISO 8601, UTC
    taken, coming : readings so far, readings of the plan that are to come
    finished : why the campaign ended; None while it goes on
    result : what it came to
    """

    file: Path
    machine: str
    at: str
    taken: int
    coming: int
    finished: str | None
    result: KeptResult


def standings(files: Iterable[Path]) -> tuple[list[Standing], list[AxiscalError]]:
    """Return where each campaign stands, and why records cannot be read."""
    found, faults = list[Standing](), list[AxiscalError]()
    for file in files:
        try:
            found.append(_standing(file))
        except AxiscalError as fault:
            faults.append(fault)
    return found, faults


def _standing(file: Path) -> Standing:
    record = Record.open(file, write=False)
    state, events = record.state(), record.events()
    assert state.created is not None
    ends = [each.event.result for each in events if isinstance(each.event, Finished)]
    result = ends[-1] if ends and state.finished is not None else KeptResult()
    machine = machine_from_text(state.created.machine_text).name
    counts = len(state.readings), len(state.coming)
    return Standing(file, machine, events[-1].at, *counts, state.finished, result)
