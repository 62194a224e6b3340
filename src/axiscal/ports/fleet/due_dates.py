"""When each machine of a shop is due: how far off its tables are by now, and when that passes the target.

With the tables of the last mean m in the control, what is left after Δt has the mean square over the volume

    r²(Δt) = tr W [ρ² C + (1 − ρ²) C₀ + (1 − ρ)² m mᵀ] + rests

For errors of an axis that was renewed since, ρ = 0. If its type is known m and C₀ are counted from what that has
taught; named tables of a control add the errors that they cannot hold (`worn_machine`). It is due when r
passes the target.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from datetime import date, datetime, timedelta
from itertools import pairwise
from pathlib import Path

from axiscal.description.campaign import CampaignDescription
from axiscal.description.type_text import SisterRecord
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation, as_standard
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.promise.problem import Inherited
from axiscal.exceptions import AxiscalError, InputError, RecordError, TableError, TargetError
from axiscal.language.spoken import listed, put, said
from axiscal.language.stages import staged
from axiscal.ports.fleet.sister_records import ACTIVE, MachineRecord, equation_of, other_machine, read_records, why_not
from axiscal.ports.fleet.worn_machine import YEAR, Aging, Pair, Wearing, aging, found_by, worn
from axiscal.units import said_quantity
from axiscal_core.threads import one_thread

_HORIZON = 20.0
"""Years: nobody plans farther."""
_DAY = 86400.0 / YEAR
"""Years; dates are days."""


@dataclass(frozen=True, eq=False, slots=True)
class DueMachine:
    """One machine and its last campaign.

    name : of machine and serial number; record : of that campaign; last : its day; minutes : of machine time it took
    target : RMS, m; then : RMS that its last campaign came to, before anything had changed, m
    now : RMS of what is left today with its tables, m; due : the day it passes the target, None for never
    renewed : the axes that were renewed since
    """

    name: str
    record: Path
    last: date
    minutes: float
    target: float
    then: float
    now: float
    due: date | None
    renewed: tuple[str, ...]

    @property
    def day_text(self) -> str:
        """When it is due, in words."""
        if self.due is None:
            return said("not within 20 years")
        if self.due > self.last:
            return self.due.isoformat()
        worse, faded = (
            "at once: its last campaign was not as good",
            "at once: its last campaign came to {rms}, and what is not kept is more",
        )
        return said(worse if self.then > self.target else faded, rms=said_quantity(self.then, "um"))


@dataclass(frozen=True, eq=False, slots=True)
class Shop:
    """machines : those first that are due first; aging : how machines change; left_out : records that do not count"""

    machines: tuple[DueMachine, ...]
    aging: Aging
    left_out: tuple[SisterRecord, ...]


def titles(machines: Sequence[DueMachine]) -> list[str]:
    """Return what tells machines apart: the name, and the record's where others without a serial number have it too."""
    names = Counter(machine.name for machine in machines)
    return [each.name if names[each.name] == 1 else f"{each.name} ({each.record.name})" for each in machines]


@one_thread()
def due_dates(files: Iterable[Path], today: date, target: float | None = None, tables: str | None = None) -> Shop:
    """Return when the machines of records are due.

    target : RMS, m, instead of that of each campaign
    tables : of which control they have; None where all that was found is taken away
    Raises RecordError where no record can be read, TargetError where no campaign has a target of RMS or U, TableError
    where no tables can be made.
    """
    found, left = read_records(files)
    records = [record for record in found if not record.description.compensation_active]
    left += [record.as_sister(said(ACTIVE)) for record in found if record.description.compensation_active]
    known = dict[str, Estimation]()
    for record in staged("records", records, len(records)):
        try:
            known[record.digest] = concluded(case_of(record.description), record.readings)
        except AxiscalError as fault:
            left.append(record.as_sister(why_not(fault)))
    if not known:
        whys = listed("; ", [put("{file}: {why}", file=each.file, why=each.left_out) for each in left])
        what = "No record can be read: {whys}" if left else "No record can be read"
        raise RecordError(what, "Name records of measured machines", whys=whys)
    histories = _histories([record for record in records if record.digest in known])
    learnt = aging([pair for history in histories for pair in _pairs(history, known, left)])
    machines, faults = list[DueMachine](), list[InputError]()
    for last in (history[-1] for history in histories):
        try:
            machines.append(_due(last, known[last.digest], learnt, today, target, tables))
        except (TargetError, TableError) as fault:
            faults.append(fault)
            left.append(last.as_sister(put("{what}; {remedy}", what=fault.what, remedy=fault.remedy)))
    if not machines:
        raise faults[0]
    order = sorted(machines, key=lambda machine: (machine.due or date.max, machine.name))
    return Shop(tuple(order), learnt, tuple(left))


def _histories(records: Sequence[MachineRecord]) -> list[list[MachineRecord]]:
    """Return the records of each machine in the order of time; one without a serial number counts as another machine.

    Two machines of different builds may have the same number.
    """
    machines = list[list[MachineRecord]]()
    for record in sorted(records, key=lambda each: (each.begun, each.digest)):
        of_its_number = (each for each in machines if record.serial and each[-1].serial == record.serial)
        machine = record.description.machine
        same = (each for each in of_its_number if not other_machine(machine, each[-1].description.machine))
        history = next(same, None)
        if history is None:
            machines.append([record])
        else:
            history.append(record)
    return machines


def _pairs(history: Sequence[MachineRecord], known: dict[str, Estimation], left: list[SisterRecord]) -> Iterable[Pair]:
    """Yield what each campaign of a machine says of the one before; left : takes those that say nothing of it."""
    for before, after in pairwise(history):
        if before.renewed:
            continue
        first = known[before.digest]
        years = (datetime.fromisoformat(after.begun) - datetime.fromisoformat(before.begun)).total_seconds() / YEAR
        try:
            equation = equation_of(after, first.case.errors)
        except AxiscalError as fault:
            left.append(after.as_sister(why_not(fault)))
            continue
        yield Pair(years, found_by(first), equation, Wearing.from_estimation(first))


def _due(
    record: MachineRecord, known: Estimation, learnt: Aging, today: date, asked: float | None, tables: str | None
) -> DueMachine:
    target = _own_target(known) if asked is None else asked
    if target is None:
        remedy = 'Say one for all machines: --target "4 um"'
        raise TargetError("the campaign asks for no RMS and no U that could be kept", remedy, record.file)
    last = datetime.fromisoformat(record.begun).date()
    rms = worn(known, learnt, record.renewed, tables)
    days = _first_day(lambda day: rms(day * _DAY) > target)
    return DueMachine(
        name=record.description.machine.name + (f" {record.serial}" if record.serial else ""),
        record=record.file,
        last=last,
        minutes=known.timed.seconds / 60.0,
        target=target,
        then=known.accuracy.rms,
        now=rms(max((today - last).days, 0) * _DAY),
        due=None if days is None else last + timedelta(days=days),
        renewed=record.renewed,
    )


def _own_target(known: Estimation) -> float | None:
    """Return the RMS that a campaign asks for, m: of a U by the factor between both that its readings came to."""
    asked = known.case.description.target
    found = [] if asked.rms is None else [asked.rms]
    if asked.expanded is not None:
        found.append(as_standard(known.case, known.knowledge, asked.expanded))
    return min(found, default=None)


def _first_day(passed: Callable[[int], bool]) -> int | None:
    """Return the first day on which it is passed, by bisection; None where it is not within the horizon."""
    last = int(_HORIZON / _DAY)
    return bisect_left(range(last), True, key=passed) if passed(last) else None


def again(known: Estimation) -> CampaignDescription:
    """Return the description of a campaign with noise and sizes as learnt, and places anew."""
    described, learnt = known.stated.description, known.case.description
    pairs = zip(described.setups, learnt.setups, strict=True)
    setups = tuple(replace(mine, noise=found.noise) for mine, found in pairs)
    return replace(described, machine=learnt.machine, setups=setups)


def case_again(described: CampaignDescription, prior: Inherited) -> Case:
    """Return the case of a machine of which so much is known; readings and minutes end it no more."""
    target = replace(described.target, readings=None, budget=None)
    plain = replace(described, prior_text="", sisters=None, doubt=None, target=target, sure="exactly", usual=False)
    return Case(plain, prior)
