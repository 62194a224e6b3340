"""One machine over the years: what its campaigns found, how far off its tables were between them, what was renewed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

from axiscal.errors.model import ErrorFunction
from axiscal.estimation.estimation import Estimation
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread
from axiscal.ports.fleet.due_dates import DueMachine, Shop, moment
from axiscal.ports.fleet.sister_records import MachineRecord, renewed_axes
from axiscal.ports.fleet.worn_machine import WornMachine

_STEPS, _PLACES = 40, 61
"""Points of a curve between two campaigns, and of an error along its axis; a matter of taste."""
_AHEAD = 0.25
"""Years that are drawn beyond the day on which a machine is due; a matter of taste."""
_FAR = 2.0
"""Years that are drawn beyond today where it is never due."""


@dataclass(frozen=True, slots=True)
class Found:
    """One figure of an error in one campaign: its year, such as 2026.4, mean and standard deviation, m or rad."""

    year: float
    mean: float
    std: float


@dataclass(frozen=True, slots=True)
class Parameter:
    """Estimates of one error, campaign by campaign.

    spans : the figure is the range of a curve, its highest less its lowest value; else the value of a constant
    """

    name: str
    angular: bool
    spans: bool
    found: tuple[Found, ...]


@dataclass(frozen=True, slots=True)
class Happened:
    """What a person noted: when, what, and which axes were renewed."""

    year: float
    text: str
    renewed: tuple[str, ...]


@dataclass(frozen=True, eq=False, slots=True)
class MachineHistory:
    """A machine over the years.

    due : as `axiscal due` has it; records : in the order of time
    left : pieces of (year, RMS of what is left with the tables of the last campaign, m), (k, 2) each
    """

    due: DueMachine
    records: tuple[MachineRecord, ...]
    parameters: tuple[Parameter, ...]
    happened: tuple[Happened, ...]
    left: tuple[Array, ...]


@one_thread()
def histories(shop: Shop, today: datetime) -> tuple[MachineHistory, ...]:
    """Return the history of each machine of a shop, those first that are due first."""
    return tuple(_history(machine, shop, today) for machine in shop.machines)


def year_of(at: datetime) -> float:
    """Return a time as a year with its fraction."""
    begin = datetime(at.year, 1, 1, tzinfo=UTC)
    length = datetime(at.year + 1, 1, 1, tzinfo=UTC) - begin
    return float(at.year + (at.astimezone(UTC) - begin) / length)


def _history(machine: DueMachine, shop: Shop, today: datetime) -> MachineHistory:
    records = tuple(shop.histories[machine.digest])
    happened = tuple(
        Happened(year_of(moment(note.at)), note.text, renewed_axes([note.text]))
        for record in records
        for note in record.notes
    )
    begun = [year_of(moment(record.begun)) for record in records]
    until = max(year_of(today), begun[-1]) + _FAR
    if machine.due is not None:
        until = max(year_of(datetime(*machine.due.timetuple()[:3], tzinfo=UTC)) + _AHEAD, year_of(today))
    pieces = list[Array]()
    for record, start, end in zip(records, begun, [*begun[1:], until], strict=True):
        pieces += _left(record, shop, start, end)
    return MachineHistory(machine, records, _parameters(records, shop, begun), happened, tuple(pieces))


def _left(record: MachineRecord, shop: Shop, start: float, end: float) -> list[Array]:
    """Return what is left with the tables of a campaign until the next one, in a piece for each renewal."""
    later = [note for note in record.notes if note.after >= len(record.readings) and renewed_axes([note.text])]
    turns = [(start, list[str]())]
    for note in later:
        turns.append((max(start, year_of(moment(note.at))), [*turns[-1][1], note.text]))
    ends = [at for at, _ in turns[1:]] + [end]
    pieces = list[Array]()
    for (begin, texts), stop in zip(turns, ends, strict=True):
        machine = WornMachine(shop.known[record.digest], shop.aging, renewed_axes(texts))
        years = np.linspace(begin, min(max(stop, begin), end), _STEPS)
        pieces.append(np.array([[year, machine.rms(year - start)] for year in years.tolist()]))
    return pieces


def _parameters(records: Sequence[MachineRecord], shop: Shop, begun: Sequence[float]) -> tuple[Parameter, ...]:
    found = dict[str, tuple[ErrorFunction, list[Found]]]()
    for record, year in zip(records, begun, strict=True):
        known = shop.known[record.digest]
        for name, function in known.case.errors.names.items():
            mean, std = _figure(known, function)
            found.setdefault(name, (function, []))[1].append(Found(year, mean, std))
    return tuple(
        Parameter(name, function.angular, function.basis.size > 1, tuple(each))
        for name, (function, each) in found.items()
    )


def _figure(known: Estimation, function: ErrorFunction) -> tuple[float, float]:
    """Return the value of a constant, or the range of a curve, with its standard deviation where it was found."""
    belief = known.banded.knowledge.belief
    mean, factor = belief.mean[function.columns], belief.factor[function.columns]
    if function.basis.size == 1:
        row = function.rows(np.zeros(1))[0]
    else:
        low, high = (float(function.basis.knots[end]) for end in (0, -1))
        rows = function.rows(np.linspace(low, high, _PLACES))
        curve = rows @ mean
        row = rows[int(np.argmax(curve))] - rows[int(np.argmin(curve))]
    return float(row @ mean), float(np.linalg.norm(row @ factor))
