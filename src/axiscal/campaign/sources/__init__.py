"""Where readings come from.

`sim[:SEED]`, `truth:FILE`, `csv:FILE`, `exec:COMMAND`, `linuxcnc[:SEED|:FILE]`,
`linuxcnc-live[:HOST]`, `moonraker:HOST`, `duet:HOST`.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from axiscal.campaign.sources.source import Answer, Request, Skip, Source
from axiscal.document.ports import one_of, ours
from axiscal.exceptions import SourceError

if TYPE_CHECKING:
    from axiscal.measurement.simulation import Simulator

__all__ = ["Answer", "Request", "Skip", "Source", "open_source"]

STARTED = "ports.linuxcnc.linuxcnc_source:LinuxcncSource"
"""What moves a virtual machine by a LinuxCNC that is started for it."""
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
    kind, colon, rest = text.partition(":")
    if kind == "sim":
        return _simulated(simulator, rest, bool(colon))
    if kind == "linuxcnc-live":
        in_force = ours("ports.linuxcnc.live:InForce")(active)
        live: Source = ours("ports.linuxcnc.live:attached_to")(rest, simulator.machine, in_force)
        return live
    if kind == "linuxcnc":
        return _linuxcnc(simulator, rest, bool(colon))
    if kind in ("truth", "csv", "exec", "moonraker", "duet") and not rest.strip():
        raise SourceError("the source '{text}' names nothing after '{kind}:'", _KINDS, text=text, kind=kind)
    if kind == "truth":
        from axiscal.campaign.sources.simulated import SimulatedSource

        return SimulatedSource(simulator.from_curves(Path(rest), TRUTH_SEED), TRUTH_SEED)
    if kind == "csv":
        from axiscal.campaign.sources.csv import CsvSource

        source = CsvSource(Path(rest))
        source.pass_over(taken)
        return source
    if kind == "exec":
        from axiscal.campaign.sources.exec import TIMEOUT, ExecSource

        return ExecSource(rest, TIMEOUT if timeout is None else timeout)
    if kind in ("moonraker", "duet"):
        printer: Source = ours("ports.printers.printer:reached")(kind, rest.strip())
        return printer
    if (brought := one_of("axiscal.sources", kind)) is not None:
        made: Source = brought(rest)
        return made
    raise SourceError("'{text}' is not a source", _KINDS, text=text)


_KINDS = (
    "Sources are sim, sim:SEED, truth:FILE.csv, csv:FILE and exec:COMMAND, linuxcnc:SEED with LinuxCNC, "
    "linuxcnc-live:HOST with one that runs, and moonraker:HOST and duet:HOST with a printer"
)


def _simulated(simulator: Simulator, seed: str, named: bool) -> Source:
    from axiscal.campaign.sources.simulated import SimulatedSource

    number = _seed(seed, "sim") if named else 0
    return SimulatedSource(simulator.drawn(number), number)


def _linuxcnc(simulator: Simulator, rest: str, named: bool) -> Source:
    from axiscal.campaign.sources.simulated import SimulatedSource

    from_file = rest.endswith(".csv")
    number = TRUTH_SEED if from_file else _seed(rest, "linuxcnc") if named else 0
    truth = simulator.from_curves(Path(rest), number) if from_file else simulator.drawn(number)
    source: Source = ours(STARTED)(truth, lambda machine: SimulatedSource(machine, number))
    return source


def _seed(text: str, kind: str) -> int:
    if not (text.isascii() and text.isdigit() and len(text) <= 18):
        raise SourceError("'{text}' is not a seed", "Write a whole number from 0, as in {kind}:7", text=text, kind=kind)
    return int(text)
