"""Records of machines of one type: which of them teach, which do not and why not, and what each of them says."""

from __future__ import annotations

import hashlib
import json
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from axiscal.campaign.possible import described
from axiscal.description.campaign import CampaignDescription
from axiscal.description.type_text import SisterRecord
from axiscal.errors.model import ErrorModel
from axiscal.estimation.case import Case
from axiscal.estimation.data_equation import DataEquation, data_equation
from axiscal.estimation.estimate import concluded
from axiscal.estimation.type_prior import carried_over
from axiscal.exceptions import AxiscalError, InputError, RecordError, UnreachableError
from axiscal.language.spoken import said
from axiscal.language.stages import staged
from axiscal.machine.description import Machine
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.present.result_set import RECORD
from axiscal.record.copies import opened_log
from axiscal.record.events import Recorded
from axiscal.record.log import ChainedText, campaign_of, shared_events
from axiscal.record.payload import encode
from axiscal.units import format_quantity

RENEWED = re.compile(r"\(renewed: ([\w, ]+)\)$")
"""How a note ends that says which axes were renewed, as `axiscal step note --renewed` writes it."""
ACTIVE = "a compensation was active: it shows what that left, not the machine"
"""Why a record does not count that was measured so."""
_TRAVEL = 0.01
"""Share by which travels may differ in one type: what is rounded in a description, and no other size."""


class Copy(NamedTuple):
    """A record as it stands, which others of its campaign may stand beside.

    campaign : which one it is of; chains, kinds : the hash behind each of its events, and of what kind each is
    """

    file: Path
    campaign: str
    chains: tuple[str, ...]
    kinds: tuple[str, ...]

    @classmethod
    def from_texts(cls, file: Path, texts: Sequence[ChainedText]) -> Copy:
        """Return a record of events as they were written."""
        chains, kinds = (tuple(each) for each in zip(*((text.chain, text.row.kind) for text in texts), strict=True))
        return cls(file, campaign_of(texts[0]), chains, kinds)

    @property
    def chain(self) -> str:
        """The name of all that it holds."""
        return self.chains[-1]

    def holds(self, other: Sequence[str]) -> bool:
        """Return whether it has all events of a log.  other : the hash behind each of these"""
        return shared_events(self.chains, other) == len(other)

    @property
    def name(self) -> str:
        """Its file; with its folder where it is called as every command calls one."""
        return file_name(self.file)

    def parted(self, other: Copy) -> str:
        """Return from where on it and another one of its campaign hold different events."""
        event = shared_events(self.chains, other.chains) + 1
        return said("it and {other} went on differently from event {event}", other=other.name, event=event)


def file_name(file: Path) -> str:
    """Return what a record is called, where the folder alone tells some apart."""
    return f"{file.parent.name}/{file.name}" if file.name == RECORD else file.name


def beside_others(record: Copy, records: Iterable[Copy]) -> tuple[str, str]:
    """Return why a record does not count beside the others of its campaign, and what is to be minded where it does."""
    remark = ""
    for other in records:
        if other.campaign != record.campaign or other.file == record.file:
            continue
        if other.chain == record.chain:
            if other.file < record.file:
                return said("it is the same as {other}", other=other.name), ""
        elif other.holds(record.chains):
            return said("it is an earlier copy of {other}", other=other.name), ""
        elif not record.holds(other.chains):
            remark = record.parted(other)
    return "", remark


@dataclass(frozen=True, eq=False, slots=True)
class MachineRecord:
    """A record as it was read.

    digest : of its machine and readings; begun : ISO 8601, UTC; renewed : axes that a note after its last reading names
    """

    copy: Copy
    digest: str
    begun: str
    description: CampaignDescription
    readings: tuple[Reading, ...]
    renewed: tuple[str, ...] = ()

    @property
    def file(self) -> Path:
        """Where it is."""
        return self.copy.file

    @property
    def serial(self) -> str:
        """The serial number of the machine, "" where nobody said."""
        return self.description.particulars.serial

    def as_sister(self, left_out: str) -> SisterRecord:
        """Return what became of it.  left_out : why it does not count, "" where it does"""
        return SisterRecord(self.copy.name, self.digest, len(self.readings), left_out)


def read_records(files: Iterable[Path]) -> tuple[list[MachineRecord], list[SisterRecord]]:
    """Return the records that can be read and have readings, and of the others why they are left out.

    Digests give the order, whatever the order of the files. Copies are judged as in the list of a shop. The same
    readings of a machine count once. The record with most readings counts if several of one campaign went on.
    Raises UnreachableError where the server of records goes away: nobody knows then what it holds.
    """
    read, left = list[MachineRecord](), list[SisterRecord]()
    for file in sorted({file.resolve(): file for file in files}.values(), key=lambda file: file.name):
        try:
            read.append(_read(file))
        except UnreachableError:
            raise
        except (InputError, OSError) as fault:
            left.append(SisterRecord(file_name(file), "", 0, why_not(fault)))
    whys = _beside_each_other(read)
    left += [record.as_sister(whys[record.file]) for record in read if record.file in whys]
    counted = (record for record in read if record.file not in whys)
    return sorted(counted, key=lambda record: record.digest), left


def _beside_each_other(records: Sequence[MachineRecord]) -> dict[Path, str]:
    """Return why records do not count beside others, by their files."""
    whys, seen, most = dict[Path, str](), dict[str, MachineRecord](), dict[str, MachineRecord]()
    for record in records:
        why, _ = beside_others(record.copy, [each.copy for each in records])
        if not why and seen.setdefault(record.digest, record) is not record:
            why = said("it is the same as {other}", other=seen[record.digest].copy.name)
        if why:
            whys[record.file] = why
    for record in sorted(seen.values(), key=lambda record: (-len(record.readings), record.digest)):
        if (other := most.setdefault(record.copy.campaign, record)) is not record:
            parted = record.copy.parted(other.copy)
            whys[record.file] = said("{parted}, and that one has as many readings or more", parted=parted)
    return whys


def _read(file: Path) -> MachineRecord:
    with opened_log(file, write=False) as record:
        description, state, texts = described(record), record.state(), record.texts()
    if not state.readings:
        raise RecordError("it has no readings", "Measure the machine", file)
    read = sorted(encode(Recorded(replace(reading, number=None)))[1] for reading in state.readings)
    text = json.dumps([description.machine.text, read])
    digest = hashlib.sha256(text.encode()).hexdigest()
    later = [note.text for note in state.notes if note.after >= len(state.readings)]
    which = Copy.from_texts(file, texts), digest, texts[0].row.at
    return MachineRecord(*which, description, state.readings, renewed_axes(later))


def renewed_axes(notes: Iterable[str]) -> tuple[str, ...]:
    """Return the axes that notes say were renewed."""
    found = (RENEWED.search(note) for note in notes)
    return tuple(dict.fromkeys(axis for each in found if each for axis in each.group(1).split(", ")))


def usual_machine(records: Sequence[MachineRecord]) -> Machine:
    """Return the description that most of the records have, names and numbers of machines apart.

    Raises RecordError where there are no records.
    """
    if not records:
        raise RecordError("None of the records has readings", "Name records of campaigns that have been measured")
    machines = sorted((record.description.machine for record in records), key=lambda machine: machine.text)
    counts = Counter(_form(machine) for machine in machines)
    most = max(counts.values())
    return next(machine for machine in machines if counts[_form(machine)] == most)


def _form(machine: Machine) -> str:
    return repr((machine.chain, [(axis.name, axis.travel) for axis in machine.axes], machine.errors, machine.planes))


def other_machine(machine: Machine, reference: Machine) -> str:
    """Return why a machine is not of the type of another one, "" where it may be."""
    if machine.chain != reference.chain:
        return said("another machine: its chain is {own}, not {chain}", own=machine.chain, chain=reference.chain)
    for axis, other in zip(machine.axes, reference.axes, strict=True):
        pairs = zip(axis.travel, other.travel, strict=True)
        if axis.name != other.name or axis.rotary != other.rotary:
            what = "another machine: it has an axis {axis} in the place of {other}"
            return said(what, axis=axis.name, other=other.name)
        if any(abs(one - two) > _TRAVEL * other.length for one, two in pairs):
            long, usual = (format_quantity(each.length, each.unit, 6) for each in (axis, other))
            what = "another size: {axis} travels {long}, not {usual}, or from elsewhere"
            return said(what, axis=axis.name, long=long, usual=usual)
    if not set(machine.error_names) & set(reference.error_names):
        return said("it describes none of the errors of the type")
    return ""


def repeated(records: Sequence[MachineRecord]) -> dict[str, str]:
    """Return why records of a machine that was measured again later do not count, by their digests.

    The serial number identifies a machine; a record without one counts as another machine.
    """
    last = dict[str, MachineRecord]()
    for record in sorted(records, key=lambda record: (record.begun, record.digest)):
        if record.serial:
            last[record.serial] = record
    return {
        record.digest: said(
            "machine {serial} was measured again: {file}", serial=record.serial, file=last[record.serial].copy.name
        )
        for record in records
        if record.serial and last[record.serial] is not record
    }


def equations_of(
    records: Sequence[MachineRecord], reference: Machine, units: Array
) -> tuple[list[SisterRecord], dict[str, DataEquation]]:
    """Return what became of each record, and of those that count the data equations over the units of the type.

    units : (n, k) T of the reference machine's errors
    """
    errors = ErrorModel(reference)
    again = repeated([record for record in records if not _unlike(record, reference)])
    seen, equations = list[SisterRecord](), dict[str, DataEquation]()
    for record in staged("records", records, len(records)):
        why = _unlike(record, reference) or again.get(record.digest, "")
        if not why:
            try:
                equations[record.digest] = equation_of(record, errors).in_units(units)
            except AxiscalError as fault:
                why = why_not(fault)
        seen.append(record.as_sister(why))
    return seen, equations


def why_not(fault: AxiscalError | OSError) -> str:
    """Return in words why a record does not count."""
    if isinstance(fault, OSError):
        return said("it cannot be read: {reason}", reason=fault.strerror or fault)
    return fault.what if isinstance(fault, InputError) else str(fault)


def _unlike(record: MachineRecord, reference: Machine) -> str:
    if record.description.compensation_active:
        return said(ACTIVE)
    return other_machine(record.description.machine, reference)


def equation_of(record: MachineRecord, errors: ErrorModel) -> DataEquation:
    """Return what a record says of the errors of a type, whatever prior it was measured with.

    Raises RecordError where its readings do not fit its model, AmbiguityError where they fit two.
    """
    plain = replace(record.description, prior_text="", sisters=None, doubt=None)
    known = concluded(Case(plain), record.readings)
    if known.agreement.withheld:
        what = "its readings contradict each other (p = {p:.1g})"
        raise RecordError(what, "Look at its report", record.file, p=known.agreement.p)
    own = known.case.errors
    across, root = carried_over(errors, own), own.prior_root()
    new = [term.columns for term in own.terms if term.name not in across.known]
    others = np.hstack([across.beyond(), *(root[:, columns] for columns in new)])
    left_out = known.absorbed.left_out
    counts = [reading for index, reading in enumerate(known.readings) if index not in left_out]
    return data_equation(known.case.observation, counts, others).in_units(across.matrix)
