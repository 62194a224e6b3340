"""As-found and as-left readings of a virtual machine: the same truth without tables and with them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from axiscal.campaign.sources import STARTED, Answer, Request, Source
from axiscal.campaign.sources.simulated import SimulatedSource
from axiscal.document.ports import ours
from axiscal.exceptions import SourceError
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.tables.effect import CommandedMachine
from axiscal.tables.offer import Export

_FIRST = (1_000_000, 2_000_000)
"""Numbers of the readings, so that their noise is that of no reading of the campaign."""
_KINDS = "A check without a person takes sim, sim:SEED, truth:FILE.csv, linuxcnc, linuxcnc:SEED or linuxcnc:FILE.csv"


def as_found_and_left(
    text: str, simulator: Simulator, tables: Export, wanted: Sequence[Request]
) -> tuple[tuple[Reading, ...], tuple[Reading, ...]]:
    """Return the readings without and with the tables; raises SourceError, InputError, ControlError.

    text : names the source as `axiscal run` does; wanted : the places
    """
    kind, _, rest = text.partition(":")
    seed = _seed(kind, rest)
    truth = simulator.from_curves(Path(rest), seed) if rest.endswith(".csv") else simulator.drawn(seed)
    return _both(_pair(kind, truth, seed, tables), wanted)


def of_machine(
    truth: VirtualMachine, seed: int, tables: Export, wanted: Sequence[Request]
) -> tuple[tuple[Reading, ...], tuple[Reading, ...]]:
    """Return the readings of a machine without and with the tables."""
    return _both(_pair("sim", truth, seed, tables), wanted)


def _both(sources: tuple[Source, Source], wanted: Sequence[Request]) -> tuple[tuple[Reading, ...], tuple[Reading, ...]]:
    found, left = (_taken(source, wanted, n) for source, n in zip(sources, _FIRST, strict=True))
    return found, left


def _seed(kind: str, rest: str) -> int:
    if kind == "truth" and rest.endswith(".csv"):
        return 0
    if kind not in ("sim", "linuxcnc") or (kind == "sim" and rest.endswith(".csv")):
        raise SourceError("'{kind}' cannot be asked without a person and with tables", _KINDS, kind=kind[:40])
    if rest.endswith(".csv") or not rest:
        return 0
    if not (rest.isascii() and rest.isdigit() and len(rest) <= 18):
        raise SourceError("'{text}' is not a seed", "Write a whole number from 0, as in sim:7", text=rest[:40])
    return int(rest)


def _pair(kind: str, truth: VirtualMachine, seed: int, tables: Export) -> tuple[Source, Source]:
    def simulated(machine: VirtualMachine) -> Source:
        return SimulatedSource(machine, seed)

    if kind == "linuxcnc":
        started = ours(STARTED)
        return started(truth, simulated), started(truth, simulated, tables.files)
    return simulated(truth), simulated(CommandedMachine.corrected(truth, tables.control))


def _taken(source: Source, wanted: Sequence[Request], first: int) -> tuple[Reading, ...]:
    readings = []
    try:
        for number, place in enumerate(wanted, first):
            answer = source.read(Request(number, place.setup, place.axes, place.pose, place.approach))
            assert isinstance(answer, Answer)  # virtual machines do not skip
            at = (place.setup.name, place.pose, place.approach)
            readings.append(Reading(*at, answer.value, answer.std, others=answer.others))
    finally:
        source.close()
    return tuple(readings)
