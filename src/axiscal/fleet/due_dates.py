"""When each machine of a shop is due: how far off its tables are by now, and when that passes the target.

With the tables of the last mean m in the control, what is left after Δt has the mean square over the volume

    r²(Δt) = tr W [ρ² C + (1 − ρ²) C₀ + (1 − ρ)² m mᵀ] + rests

For errors of an axis that was renewed since, ρ = 0. Of a machine whose type is known C₀ is its own part, and what all
sisters have stays (`wearing`). Where the tables of a control are named, what they cannot hold is left besides
(`tables_left`). It is due when r passes the target, or when the worst place is beyond a tolerance with 5 %.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, date, datetime, timedelta
from itertools import pairwise
from pathlib import Path

from axiscal.design.plan.plan import Plan
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.type_prior import SisterRecord, TypePrior
from axiscal.estimation.uncertain import as_standard
from axiscal.exceptions import AxiscalError, InputError, PlanError, RecordError, TableError, TargetError
from axiscal.fleet.aging import YEAR, Aging, Pair, aging
from axiscal.fleet.measured_again import recalibration
from axiscal.fleet.sister_records import MachineRecord, equation_of, other_machine, read_records, why_not
from axiscal.fleet.wearing import Wearing, found_by
from axiscal.fleet.worn_machine import WornMachine
from axiscal.numerics.threads import one_thread

_HORIZON = 20.0
"""Years: nobody plans farther."""
_DAY = 86400.0 / YEAR
"""Years; dates are days."""
_CHANCE = 0.05
"""How probable it may be that the worst place is beyond the tolerance."""
Told = Callable[[str], None]


@dataclass(frozen=True, eq=False, slots=True)
class Wanted:
    """What is wanted of all machines.

    target : RMS, m, instead of that of each campaign; tolerance : of the worst place, m, None where none is stated
    tables : of which control they have; None where all that was found is taken away
    taught : by a type, of machines that were measured without it; machines of another build are as stated
    again : whether measuring them again is planned
    """

    target: float | None = None
    tolerance: float | None = None
    tables: str | None = None
    taught: TypePrior | None = None
    again: bool = False


@dataclass(frozen=True, eq=False, slots=True)
class DueMachine:
    """One machine and its last campaign.

    name : of machine and serial number; record : of that campaign; last : its day; minutes : of machine time it took
    target : RMS, m, None where only the worst place counts; then : RMS that its last campaign came to, before anything
    had changed, m
    now : RMS of what is left today with its tables, m; beyond : how probable it is that the worst place is beyond the
    tolerance today, None where there is none
    due : the day it passes the target, or is beyond with 5 %, None for never; by_worst : whether it is that
    renewed : the axes that were renewed since
    again : the plan by which it is measured again then, or today where that is later, until the targets of its last
    campaign; None where nobody asked; why_not : or none is found, or none is needed
    """

    name: str
    record: Path
    digest: str
    last: date
    minutes: float
    target: float | None
    then: float
    now: float
    beyond: float | None
    due: date | None
    by_worst: bool
    renewed: tuple[str, ...]
    again: Plan | None = None
    why_not: str = ""


@dataclass(frozen=True, eq=False, slots=True)
class Shop:
    """machines : those first that are due first; aging : how machines change; left_out : records that do not count

    histories : the records of each machine in the order of time, by the digest of the last; known : what each came to
    """

    machines: tuple[DueMachine, ...]
    aging: Aging
    left_out: tuple[SisterRecord, ...]
    histories: Mapping[str, Sequence[MachineRecord]]
    known: Mapping[str, Estimation]


def titles(machines: Sequence[DueMachine]) -> list[str]:
    """Return what tells machines apart: the name, and the record's where others without a serial number have it too."""
    names = Counter(machine.name for machine in machines)
    return [each.name if names[each.name] == 1 else f"{each.name} ({each.record.name})" for each in machines]


@one_thread()
def due_dates(files: Iterable[Path], today: date, wanted: Wanted = Wanted(), told: Told = lambda said: None) -> Shop:
    """Return when the machines of records are due.

    told : called with what is being done
    Raises RecordError where no record can be read, TargetError where no campaign has a target of RMS or U and no
    tolerance is stated, or no tables can be made.
    """
    found, left = read_records(files)
    records = [record for record in found if not record.description.compensation_active]
    left += [_with_tables(record) for record in found if record.description.compensation_active]
    known = dict[str, Estimation]()
    for record in records:
        told(f"{record.file.name} ...")
        try:
            known[record.digest] = concluded(case_of(record.description), record.readings)
        except AxiscalError as fault:
            left.append(_left(record, fault))
    if not known:
        whys = "; ".join(f"{each.file}: {each.left_out}" for each in left)
        raise RecordError("No record can be read" + (f": {whys}" if whys else ""), "Name records of measured machines")
    histories = _histories([record for record in records if record.digest in known])
    learnt = aging([pair for history in histories for pair in _pairs(history, known, left, wanted.taught)])
    machines, faults = list[DueMachine](), list[InputError]()
    for last in (history[-1] for history in histories):
        try:
            machines.append(_due(last, known[last.digest], learnt, today, wanted, told))
        except (TargetError, TableError) as fault:
            faults.append(fault)
            left.append(replace(_left(last, fault), left_out=f"{fault.what}; {fault.remedy}"))
    if not machines:
        raise faults[0]
    order = sorted(machines, key=lambda machine: (machine.due or date.max, machine.name))
    by_last = {history[-1].digest: history for history in histories}
    return Shop(tuple(order), learnt, tuple(left), by_last, known)


def _with_tables(record: MachineRecord) -> SisterRecord:
    why = "a compensation was active: it shows what that left, not the machine"
    return SisterRecord(record.file.name, record.digest, len(record.readings), why)


def _left(record: MachineRecord, fault: AxiscalError) -> SisterRecord:
    return SisterRecord(record.file.name, record.digest, len(record.readings), why_not(fault))


def _histories(records: Sequence[MachineRecord]) -> list[list[MachineRecord]]:
    """Return the records of each machine in the order of time; one without a serial number is a machine of its own.

    Two machines of different builds may have the same number.
    """
    machines = list[list[MachineRecord]]()
    for record in sorted(records, key=lambda each: (each.begun, each.digest)):
        same = (of for of in machines if record.serial and _same_machine(of[-1], record))
        history = next(same, None)
        if history is None:
            machines.append([record])
        else:
            history.append(record)
    return machines


def _same_machine(before: MachineRecord, after: MachineRecord) -> bool:
    return before.serial == after.serial and not other_machine(after.description.machine, before.description.machine)


def _pairs(
    history: Sequence[MachineRecord], known: dict[str, Estimation], left: list[SisterRecord], taught: TypePrior | None
) -> Iterable[Pair]:
    """Yield what each campaign of a machine says of the one before; left : takes those that say nothing of it."""
    for before, after in pairwise(history):
        if before.renewed:
            continue
        first = known[before.digest]
        years = (moment(after.begun) - moment(before.begun)).total_seconds() / YEAR
        try:
            equation = equation_of(after, first.case.errors)
        except AxiscalError as fault:
            left.append(_left(after, fault))
            continue
        yield Pair(years, found_by(first), equation, Wearing.of(first, taught))


def moment(text: str) -> datetime:
    """Return a time of a record; one that names no zone is UTC."""
    at = datetime.fromisoformat(text)
    return at if at.tzinfo else at.replace(tzinfo=UTC)


def _due(
    record: MachineRecord, known: Estimation, learnt: Aging, today: date, wanted: Wanted, told: Told
) -> DueMachine:
    own, tolerance = _own_target(known), wanted.tolerance
    target = own if wanted.target is None else wanted.target
    if target is None and tolerance is None:
        raise TargetError(
            "the campaign asks for no RMS and no U that could be kept",
            'Say one for all machines: --target "4 um"; `axiscal due --tolerance "20 um"` asks for the worst alone',
            record.file,
        )
    last = moment(record.begun).date()
    machine = WornMachine(known, learnt, record.renewed, wanted.tables, wanted.taught)
    passed = None if target is None else _first_day(lambda day: machine.rms(day * _DAY) > target)
    beyond = None if tolerance is None else _first_day(lambda day: machine.beyond(day * _DAY, tolerance) > _CHANCE)
    days = min((each for each in (passed, beyond) if each is not None), default=None)
    since = max((today - last).days, 0)
    found = DueMachine(
        name=record.description.machine.name + (f" {record.serial}" if record.serial else ""),
        record=record.file,
        digest=record.digest,
        last=last,
        minutes=known.seconds / 60.0,
        target=target,
        then=known.accuracy.rms,
        now=machine.rms(since * _DAY),
        beyond=None if tolerance is None else machine.beyond(since * _DAY, tolerance),
        due=None if days is None else last + timedelta(days=days),
        by_worst=days is not None and days != passed,
        renewed=record.renewed,
    )
    if not wanted.again:
        return found
    told(f"{record.file.name}: measuring it again ...")
    try:
        return replace(found, again=recalibration(known, machine.prior(max(since, days or 0) * _DAY), own, told))
    except PlanError as fault:
        return replace(found, why_not=fault.what)


def _own_target(known: Estimation) -> float | None:
    """Return the RMS that a campaign asks for, m: of a U by the factor between both that its readings came to."""
    asked = known.case.description.target
    found = [] if asked.rms is None else [asked.rms]
    if asked.expanded is not None:
        found.append(as_standard(known.case, known.knowledge, asked.expanded))
    return min(found, default=None)


def _first_day(passed: Callable[[int], bool]) -> int | None:
    """Return the first day on which it is passed, by bisection; None where it is not within the horizon."""
    low, high = -1, int(_HORIZON / _DAY)
    if not passed(high):
        return None
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if passed(middle) else (middle, high)
    return high
