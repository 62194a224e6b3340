"""Where readings come from.

`sim[:SEED]`, `truth:FILE`, `csv:FILE`, `exec:COMMAND`, `linuxcnc-live[:HOST]`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from axiscal.campaign.sources.source import Answer, CsvSource, Request, SimulatedSource, Skip, Source
from axiscal.document.gone import instead_of
from axiscal.document.ports import made_by, of_class, one_of
from axiscal.exceptions import SourceError
from axiscal.record.events import Note

if TYPE_CHECKING:
    from axiscal.measurement.simulation import Simulator, VirtualMachine

__all__ = ["Answer", "Request", "Skip", "Source", "open_source", "virtual_in", "virtual_machine", "virtual_note"]

VIRTUAL = "sim", "truth"
"""Kinds of virtual machines."""
TRUTH_SEED = 0
"""Seed of the noise and of the set-ups' unknowns on a machine whose errors are given."""


def open_source(
    text: str, simulator: Simulator, timeout: float | None = None, taken: int = 0, active: bool = False
) -> Source:
    """Return the source that `text` names.

    simulator : makes the virtual machines of `sim` and `truth`
    timeout : s that an `exec` command may take over one reading
    taken : number of readings that an earlier run has had from this source
    active : whether a compensation is to be in force on a control that runs
    Raises SourceError for an unknown kind, InputError for a file that cannot be used.
    """
    kind, rest = _parted(text)
    if kind in VIRTUAL:
        return SimulatedSource(*virtual_machine(text, simulator))
    if kind == "csv":
        return CsvSource(Path(rest), taken, simulator.setups)
    if kind == "exec":
        from axiscal.campaign.sources.exec import TIMEOUT, ExecSource

        return ExecSource(rest, TIMEOUT if timeout is None else timeout)
    if (runs := one_of("axiscal.running", kind)) is not None:
        running: Source = runs(rest.strip(), simulator.machine, active)
        return running
    if (brought := made_by("axiscal.sources", kind, Source, rest)) is not None:
        source: Source = brought
        return source
    raise SourceError("'{text}' is not a source", _KINDS, text=text)


def answered(source: Source, request: Request) -> Answer | Skip:
    """Return what a source answers; raises PortError for what is no answer."""
    found: Answer | Skip = of_class("the answer of the source", source.read(request), Answer, Skip)
    return found


_KINDS = (
    "Sources are sim, sim:SEED, truth:FILE.csv, csv:FILE and exec:COMMAND, and linuxcnc-live:HOST with a LinuxCNC "
    "that runs"
)


def _parted(text: str) -> tuple[str, str]:
    """Return the kind of a source and what it names; raises SourceError for one that is gone, or names nothing."""
    kind, _, rest = text.partition(":")
    if instead := instead_of("sources", kind):
        raise SourceError("the source {kind} is gone", instead, kind=kind)
    if kind in ("truth", "csv", "exec") and not rest.strip():
        raise SourceError("the source '{text}' names nothing after '{kind}:'", _KINDS, text=text, kind=kind)
    return kind, rest


def virtual_machine(text: str, simulator: Simulator) -> tuple[VirtualMachine, int]:
    """Return the machine of `sim[:SEED]` or `truth:FILE`, and the seed of its noise.

    Raises SourceError for anything else, InputError for a file that cannot be used.
    """
    kind, rest = _parted(text)
    if kind not in VIRTUAL:
        what = "'{kind}' cannot be asked without a person and with tables"
        raise SourceError(what, "Take sim:SEED or truth:FILE.csv", kind=kind[:40])
    if kind == "truth":
        from axiscal.measurement.simulation import read_truth  # which whoever has a simulator has loaded

        return simulator.with_curves(read_truth(Path(rest)), TRUTH_SEED, Path(rest)), TRUTH_SEED
    if text != kind and not (rest.isascii() and rest.isdigit() and len(rest) <= 18):
        raise SourceError("'{text}' is not a seed", "Write a whole number from 0, as in sim:7", text=rest[:40])
    seed = int(rest or 0)
    return simulator.drawn(seed), seed


_VIRTUAL_NOTE = re.compile(r"virtual machine (sim:\d+)")
"""The note with which a campaign on a virtual machine begins."""


def virtual_note(seed: int) -> str:
    """Return what the record of a campaign says whose readings a virtual machine gives."""
    return f"virtual machine sim:{seed}"


def virtual_in(notes: Sequence[Note]) -> str:
    """Return the source that the notes of a campaign name whose readings a virtual machine gives, "" for none."""
    found = next((_VIRTUAL_NOTE.fullmatch(note.text) for note in notes[:1]), None)
    return "" if found is None else found[1]
