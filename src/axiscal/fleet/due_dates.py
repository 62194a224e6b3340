"""When each machine of a shop is due: how far off its tables are by now, and when that passes the target.

With the tables of the last mean m in the control, what is left after Δt has the mean square over the volume

    r²(Δt) = tr W [ρ² C + (1 − ρ²) C₀ + (1 − ρ)² m mᵀ] + rests

For errors of an axis that was renewed since, ρ = 0. Of a machine whose type is known C₀ is its own part, and m̄ that all
sisters have stays: m − m̄ stands in the place of m. Where the tables of a control are named, what they cannot hold is
left besides (`tables_left`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, date, datetime, timedelta
from itertools import pairwise
from pathlib import Path

import numpy as np

from axiscal.estimation.case import Inherited
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.type_prior import SisterRecord, TypePrior
from axiscal.estimation.uncertain import as_standard
from axiscal.exceptions import AxiscalError, InputError, RecordError, TableError, TargetError
from axiscal.fleet.aging import YEAR, Aging, Pair, aging
from axiscal.fleet.sister_records import MachineRecord, equation_of, other_machine, read_records, why_not
from axiscal.fleet.tables_left import products_left
from axiscal.fleet.wearing import Wearing
from axiscal.numerics.threads import one_thread

_HORIZON = 20.0
"""Years: nobody plans farther."""
_DAY = 86400.0 / YEAR
"""Years; dates are days."""


@dataclass(frozen=True, eq=False, slots=True)
class DueMachine:
    """One machine and its last campaign.

    name : of machine and serial number; record : of that campaign; last : its day; minutes : of machine time it took
    target : m; then : RMS that its last campaign came to, before anything had changed, m
    now : RMS of what is left today with its tables, m; due : the day it passes the target, None for never
    renewed : the axes that were renewed since
    """

    name: str
    record: Path
    digest: str
    last: date
    minutes: float
    target: float
    then: float
    now: float
    due: date | None
    renewed: tuple[str, ...]


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


@one_thread()
def due_dates(
    files: Iterable[Path],
    today: date,
    target: float | None = None,
    told: Callable[[str], None] = lambda said: None,
    tables: str | None = None,
    taught: TypePrior | None = None,
) -> Shop:
    """Return when the machines of records are due.

    target : RMS, m, instead of that of each campaign; told : called with what is being done
    tables : of which control they have; None where all that was found is taken away
    taught : by a type, of machines that were measured without it; machines of another build are as stated
    Raises RecordError where no record can be read, TargetError where no campaign has a target of RMS or U, or no
    tables can be made.
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
    learnt = aging([pair for history in histories for pair in _pairs(history, known, left, taught)])
    machines, faults = list[DueMachine](), list[InputError]()
    for last in (history[-1] for history in histories):
        try:
            machines.append(_due(last, known[last.digest], learnt, today, target, tables, taught))
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
        errors = first.case.errors
        factor = first.whole.factor[: errors.size]
        found = Inherited(first.whole.mean[: errors.size], factor @ factor.T)
        years = (moment(after.begun) - moment(before.begun)).total_seconds() / YEAR
        try:
            equation = equation_of(after, errors)
        except AxiscalError as fault:
            left.append(_left(after, fault))
            continue
        yield Pair(years, found, equation, Wearing.of(first, taught))


def moment(text: str) -> datetime:
    """Return a time of a record; one that names no zone is UTC."""
    at = datetime.fromisoformat(text)
    return at if at.tzinfo else at.replace(tzinfo=UTC)


def _due(
    record: MachineRecord,
    known: Estimation,
    learnt: Aging,
    today: date,
    target: float | None,
    tables: str | None,
    taught: TypePrior | None,
) -> DueMachine:
    wanted = target if target is not None else _own_target(known)
    if wanted is None:
        raise TargetError(
            "the campaign asks for no RMS and no U that could be kept",
            'Say one for all machines: --target "4 um"',
            record.file,
        )
    last = moment(record.begun).date()
    left = rms_left(known, learnt, record.renewed, tables, taught)
    days = _first_day(lambda day: left(day * _DAY) > wanted)
    due = None if days is None else last + timedelta(days=days)
    name = record.description.machine.name + (f" {record.serial}" if record.serial else "")
    now = left(max((today - last).days, 0) * _DAY)
    then = known.case.yardstick.measure(known.whole).rms
    return DueMachine(
        name, record.file, record.digest, last, known.seconds / 60.0, wanted, then, now, due, record.renewed
    )  # fmt: skip


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


def rms_left(
    known: Estimation,
    learnt: Aging,
    renewed: Sequence[str] = (),
    tables: str | None = None,
    taught: TypePrior | None = None,
) -> Callable[[float], float]:
    """Return what is left after a time in years with the tables of this estimate, RMS over the volume, m.

    renewed : axes of which nothing is kept; tables : of which control, None where they take all away that was found
    taught : by a type, where it was measured without
    Raises TableError where none can be made for it.
    """
    errors, root, wears = known.case.errors, known.case.yardstick.root, Wearing.of(known, taught)
    fresh = np.zeros(errors.size, dtype=bool)
    for term in errors.terms:
        axes = term.axes
        fresh[term.columns] = any(errors.machine.axes[axis].name in renewed for axis in axes)
    gram, aging_pair, fresh_pair = root.gram, np.outer(~fresh, ~fresh), np.outer(fresh, fresh)
    same, shared = gram.value(wears.own * aging_pair), gram.value(wears.common * aging_pair)
    new = gram.value((wears.own + wears.common) * fresh_pair)
    known_well = root.value(known.whole.factor[: errors.size] * ~fresh[:, None])
    if tables is None:
        moving = known.whole.mean[: errors.size] - wears.mean
        fields = np.array([root.matrix @ (moving * share) for share in (0.0, ~fresh, fresh)])
        products = fields @ fields.T
    else:
        products = products_left(known, tables, fresh, wears.mean)

    def left(years: float) -> float:
        rho, square = learnt.kept(years)
        once = np.array([1.0, rho - 1.0, -1.0])
        moved = once @ products @ once + (square - rho**2) * products[1, 1]
        total = square * known_well + (1 - square) * same + (1 - 2 * rho + square) * shared + new + moved
        return known.case.yardstick.rms_of(float(total))

    return left
