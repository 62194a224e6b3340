"""Records of machines of one type: which of them teach, which do not and why not, and what each of them says."""

from __future__ import annotations

import hashlib
import json
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from axiscal.campaign.possible import described
from axiscal.description.campaign import CampaignDescription
from axiscal.errors.model import ErrorModel
from axiscal.estimation.case import Case
from axiscal.estimation.data_equation import DataEquation, data_equation
from axiscal.estimation.estimate import concluded
from axiscal.estimation.type_prior import SisterRecord, carried_over
from axiscal.exceptions import AxiscalError, InputError, RecordError, UnreachableError
from axiscal.language.spoken import said
from axiscal.language.stages import staged
from axiscal.machine.description import Machine
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.record.copies import opened_log
from axiscal.record.events import Recorded
from axiscal.record.log import campaign_of, shared_events
from axiscal.record.payload import encode
from axiscal.units import format_quantity

RENEWED = re.compile(r"\(renewed: ([\w, ]+)\)$")
"""How a note ends that says which axes were renewed, as `axiscal step note --renewed` writes it."""
ACTIVE = "a compensation was active: it shows what that left, not the machine"
"""Why a record does not count that was measured so."""
_TRAVEL = 0.01
"""Share by which travels may differ in one type: what is rounded in a description, and no other size."""


@dataclass(frozen=True, eq=False, slots=True)
class MachineRecord:
    """A record as it was read.

    digest : of its machine and readings; begun : ISO 8601, UTC; renewed : axes that a note after its last reading names
    campaign : which one it is of; chains : the hash behind each of its events
    """

    file: Path
    digest: str
    begun: str
    description: CampaignDescription
    readings: tuple[Reading, ...]
    renewed: tuple[str, ...] = ()
    campaign: str = ""
    chains: tuple[str, ...] = ()

    @property
    def serial(self) -> str:
        """The serial number of the machine, "" where nobody said."""
        return self.description.particulars.serial

    def as_sister(self, left_out: str) -> SisterRecord:
        """Return what became of it.  left_out : why it does not count, "" where it does"""
        return SisterRecord(self.file.name, self.digest, len(self.readings), left_out)


def read_records(files: Iterable[Path]) -> tuple[list[MachineRecord], list[SisterRecord]]:
    """Return the records that can be read and have readings, and of the others why they are left out.

    Digests give the order, whatever the order of the files. The same reading of a machine counts once. The record
    with most readings counts if several are of one campaign.
    Raises UnreachableError where the server of records goes away: nobody knows then what it holds.
    """
    found, left = dict[str, MachineRecord](), list[SisterRecord]()
    for file in sorted({file.resolve(): file for file in files}.values(), key=lambda file: file.name):
        try:
            record = _read(file)
        except UnreachableError:
            raise
        except InputError as fault:
            left.append(SisterRecord(file.name, "", 0, fault.what))
            continue
        except OSError as fault:
            left.append(
                SisterRecord(file.name, "", 0, said("it cannot be read: {reason}", reason=fault.strerror or fault))
            )
            continue
        if record.digest in found:
            left.append(record.as_sister(said("it is the same as {other}", other=found[record.digest].file.name)))
        else:
            found[record.digest] = record
    whys = _of_one_campaign([found[digest] for digest in sorted(found)])
    left += [found[digest].as_sister(why) for digest, why in whys.items()]
    return [found[digest] for digest in sorted(found) if digest not in whys], left


def _of_one_campaign(records: Sequence[MachineRecord]) -> dict[str, str]:
    """Return why records do not count beside another of the same campaign, by their digests."""
    whole = dict[str, MachineRecord]()
    for record in records:
        if record.campaign not in whole or len(record.readings) > len(whole[record.campaign].readings):
            whole[record.campaign] = record
    whys = dict[str, str]()
    for record in records:
        other = whole[record.campaign]
        shared = shared_events(record.chains, other.chains)
        if other is record:
            continue
        if shared == len(record.chains):
            whys[record.digest] = f"it is an earlier copy of {other.file.name}"
        else:
            parted = f"it and {other.file.name} went on differently from event {shared + 1}"
            whys[record.digest] = f"{parted}, and that one has as many readings or more"
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
    chains = tuple(text.chain for text in texts)
    which = file, digest, texts[0].row.at, description, state.readings
    return MachineRecord(*which, renewed_axes(later), campaign_of(texts[0]), chains)


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
        return f"another machine: its chain is {machine.chain}, not {reference.chain}"
    for axis, other in zip(machine.axes, reference.axes, strict=True):
        pairs = zip(axis.travel, other.travel, strict=True)
        if axis.name != other.name or axis.rotary != other.rotary:
            return f"another machine: it has an axis {axis.name} in the place of {other.name}"
        if any(abs(one - two) > _TRAVEL * other.length for one, two in pairs):
            long, usual = (format_quantity(each.length, each.unit, 6) for each in (axis, other))
            return f"another size: {axis.name} travels {long}, not {usual}, or from elsewhere"
    if not set(machine.error_names) & set(reference.error_names):
        return "it describes none of the errors of the type"
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
        record.digest: f"machine {record.serial} was measured again: {last[record.serial].file.name}"
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


def why_not(fault: AxiscalError) -> str:
    """Return in words why a record does not count."""
    return fault.what if isinstance(fault, InputError) else str(fault)


def _unlike(record: MachineRecord, reference: Machine) -> str:
    return ACTIVE if record.description.compensation_active else other_machine(record.description.machine, reference)


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
