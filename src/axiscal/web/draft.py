"""A campaign that has not begun: what a person chose, in a folder that becomes the campaign's when it begins.

The folder holds the choices, kept at every touch, and once there is a plan the files of `axiscal init` and the record.
"""

from __future__ import annotations

import re
import secrets
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path

from pydantic import ValidationError

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.listing import standings
from axiscal.campaign.sources import virtual_note
from axiscal.description import first_files
from axiscal.description.campaign import CampaignDescription
from axiscal.description.first_campaign import UNSAID, Beginning, Purpose, setups_of
from axiscal.description.target import RowName, rows_of
from axiscal.document.durable import write_whole
from axiscal.exceptions import DescriptionError, InputError, PlanError, RecordError
from axiscal.language.spoken import WORDS, said
from axiscal.machine import machine_from_text
from axiscal.numerics.remembered import Memo
from axiscal.planning.helping import rows_shown
from axiscal.planning.next_readings import next_places
from axiscal.present.answer_of_campaign import results_beside
from axiscal.present.guide.progress import RecordStanding
from axiscal.present.plan_answer import coming_answer, minutes_curve
from axiscal.present.plan_words import open_questions, planned_figures
from axiscal.present.row_words import said_row
from axiscal.present.schematic import machine_schematic, setup_picture, setup_schematic
from axiscal.present.sentences import spelt
from axiscal.record.door import record_errors
from axiscal.units import parse_quantity, to_unit, within
from axiscal.web import shapes

FOLDER, _CHOSEN = "axiscal-draft", "draft.json"
"""Of a draft, and of its choices."""
_ROUGH = Memo(1)
"""The campaign of the last choices with a rough plan, of which minutes are asked afterwards."""
_ALONE, _SHOWN = Memo(16), Memo(32)
"""Campaigns with one instrument, and the rows that it shows, by the machine: picture, choice and plan ask for them."""
MACHINES = WORDS["machines"]
"""Built-in machines that are offered, in the order in which they stand."""
_MACHINES = 1000
"""Virtual machines, one of which each campaign on one gets."""
_ACTIVE = {"no": "compensation_active = false", "yes": "compensation_active = true"}
"""The line of campaign.toml by the answer of a person."""
_LISTED = 20
"""Records that are shown, those of the last days first."""
_SHORTEST, _LONGEST = 1e-2, 1e3
"""m of a travel; any that no machine has would do, and 1.000 mm is none: who writes it means a metre."""
_FINEST = 1e-9
"""m of an uncertainty that can be wanted; nobody measures a machine better."""


def start(here: Path) -> shapes.StartShape:
    """Return all that the start shows of a folder; raises RecordError."""
    draft, (begun, left_out) = kept(here), _records(here)
    return shapes.StartShape(
        folder=str(here),
        begun=begun,
        left_out=left_out,
        machines={name: said(words) for name, words in MACHINES.items()},
        instruments=first_files.offered_names(here),
        draft=draft,
        machine=_shown(here, draft),
    )


def kept(here: Path) -> shapes.DraftShape:
    """Return what was chosen so far; raises RecordError where the draft is damaged."""
    file = here / FOLDER / _CHOSEN
    if not file.exists():
        return shapes.DraftShape()
    try:
        return shapes.DraftShape.model_validate_json(file.read_bytes())
    except ValidationError as fault:
        remedy = "Remove the folder {folder} to begin anew"
        raise RecordError("The draft cannot be read", remedy, file, folder=FOLDER) from fault


def keep(here: Path, draft: shapes.DraftShape) -> shapes.MachineShape:
    """Keep what was chosen on the disk, and return what it makes of a machine; raises RecordError."""
    with record_errors(here / FOLDER):
        (here / FOLDER).mkdir(exist_ok=True)
        write_whole(here / FOLDER / _CHOSEN, draft.model_dump_json().encode())
    return _shown(here, draft)


def plan(here: Path) -> shapes.PlanShape:
    """Return roughly the plan of the draft, which is made in full as it begins; raises InputError where none can be."""
    campaign = _planned(here)
    answer = coming_answer(campaign)
    if answer is None:
        raise PlanError("No reading of these set-ups is worth its time", "Choose other instruments")
    minds = open_questions(campaign.description)
    return shapes.PlanShape(
        answer=shapes.AnswerShape.of_campaign(campaign, answer),
        rows={row.row: [spelt(figure) for figure in planned_figures([row])] for row in answer.rows},
        minds=[spelt(mind) for mind in minds],
    )


def _begun(here: Path) -> Path:
    """Make the draft a campaign in a folder of its own, and return its record; raises InputError."""
    record, described = _written(here)
    draft = kept(here)
    if draft.file and draft.machine:
        _evaluate(record, described, draft)
    else:
        with Campaign.create(record, described) as campaign:
            campaign.prepared()
            if draft.virtual:
                campaign.note(virtual_note(secrets.randbelow(_MACHINES)))
    number, named = 1, here / record.stem
    while named.exists():
        number += 1
        named = here / f"{record.stem}-{number}"
    record.parent.rename(named)
    (named / _CHOSEN).unlink()
    return named / record.name


def _evaluate(record: Path, described: CampaignDescription, draft: shapes.DraftShape) -> None:
    """Make a record of the readings that were dropped, with its results beside it; raises InputError."""
    from axiscal.present.delivery import deliver, read_in  # pictures and tables, which no draft else waits for
    from axiscal.present.findings import of_readings

    found = read_in(described, record.with_name(draft.file), along=draft.along)
    with Campaign.create(record, found.description) as campaign:
        campaign.adopt(found.readings, found.told)
        campaign.finish("all readings evaluated")
        warnings = of_readings(found.readings, described.setups, described.machine.axes)
        deliver(campaign, campaign.estimate(ended=True), results_beside(record), warnings=warnings)


def record_of(here: Path, name: str) -> Path:
    """Return a record of the start by its name, "" for that of the draft, which begins; raises InputError."""
    if not name:
        return _begun(here)
    if name not in [begun.record for begun in _records(here)[0]]:
        raise RecordError("There is no record {name} here", "Choose one of the list", here, name=name)
    return here / name


def picture(here: Path, width: float, machine: str, instrument: str, *, lengths: bool) -> str:
    """Return the machine, with an instrument on it if one is named, as SVG; raises InputError where there is none.

    machine : built-in, "" for that of the draft; lengths : whether its axes say how far they travel
    """
    begun = first_files.of_builtin(machine) if machine else _beginning(here, kept(here), {})
    if not instrument:
        return setup_picture(machine_schematic(machine_from_text(begun.text), lengths=lengths), width)
    campaign = _with(begun, instrument)
    return setup_picture(setup_schematic(campaign, campaign.setups[0], ()), width)


def shown_rows(here: Path, instrument: str) -> shapes.RowsShape:
    """Return the rows that an instrument can show on the machine of the draft, or why it cannot be set up there."""
    try:
        shown = _shown_by(_beginning(here, kept(here), {}), instrument)
    except InputError as failure:
        return shapes.RowsShape(fault=str(failure))
    return shapes.RowsShape(rows={row.name: said_row(row.name) for row in shown})


def curve(here: Path) -> shapes.CurveShape:
    """Return what minutes buy beside those of the plan of the draft; raises InputError as `plan`."""
    return shapes.CurveShape(marks=minutes_curve(_planned(here)))


def _with(begun: Beginning, instrument: str) -> CampaignDescription:
    if instrument not in (known := first_files.offered_names(begun.folder)):
        raise DescriptionError("There is no such instrument", "Known are {known}", known=", ".join(known))
    return _ALONE.answer((repr(begun), instrument), lambda: first_files.first_described(begun, [instrument], Purpose()))


def _shown_by(begun: Beginning, instrument: str) -> tuple[RowName, ...]:
    def shown() -> tuple[RowName, ...]:
        described = _with(begun, instrument)
        return rows_shown(described, rows_of(described.machine))

    return _SHOWN.answer((repr(begun), instrument), shown)


def _planned(here: Path) -> Campaign:
    """Return the campaign of the draft with a rough plan, as it was made last, in its folder; raises InputError."""

    def made() -> Campaign:
        with Campaign.create(*_written(here), partial(next_places, rough=True)) as campaign:
            campaign.prepared()
            return campaign

    return _ROUGH.answer((here, kept(here).model_copy(update={"screen": "start"}).model_dump_json()), made)


def _written(here: Path) -> tuple[Path, CampaignDescription]:
    """Write the files of the draft; return where its record will stand, and its campaign; raises InputError."""
    draft, folder, faults = kept(here), here / FOLDER, dict[str, InputError]()
    begun, target = _beginning(here, draft, faults), _length(draft.target, "um", _FINEST, faults, "target")
    for fault in faults.values():
        raise fault
    shown = {row for instrument in draft.instruments for row in _shown_by(begun, instrument)}
    wants = [row.name for row in rows_of(machine_from_text(begun.text)) if row in shown]
    wants = [name for name in wants if name not in draft.without]
    if shown and not wants:
        raise DescriptionError("Nothing is to be known", "Tick a row at least")
    described = first_files.first_described(begun, draft.instruments, Purpose(target, wants, draft.budget))
    for file in [file for file in folder.iterdir() if file.name != _CHOSEN]:
        file.unlink()
    if draft.file:
        write_whole(folder / draft.file, draft.text.encode())
    for own in {name.partition(":")[0] for name in draft.instruments if ".py:" in name}:
        write_whole(folder / own, (here / own).read_bytes())
    first_files.write_files(folder, described)
    described = replace(described, source="campaign.toml")  # as it will stand
    called = f"{'virtual ' * draft.virtual}{described.machine.name}"
    name = re.sub("[^a-z0-9]+", "-", called.casefold()).strip("-") or "machine"
    return folder / f"{name}.axiscal", described


def _beginning(here: Path, draft: shapes.DraftShape, faults: dict[str, InputError]) -> Beginning:
    """Return the machine of a draft with the travels that can be; raises InputError.  faults : takes the others"""
    if draft.machine:
        begun = first_files.of_builtin(draft.machine)
    elif draft.file:
        begun = first_files.of_text(draft.text, draft.file)
    else:
        raise DescriptionError("No machine is chosen", "Choose one, or drop the file of its control")
    lengths = dict[str, float]()
    for axis in first_files.linear_travels(begun):
        if typed := _length(draft.travels.get(axis, ""), "mm", _SHORTEST, faults, f"travels.{axis}"):
            lengths[axis] = to_unit(parse_quantity(typed, "length"), "mm")
    if draft.compensated and begun.active == UNSAID:
        begun = replace(begun, active=_ACTIVE[draft.compensated])
    sized = first_files.with_errors_times(replace(begun, folder=here), first_files.SIZES[draft.size])
    return first_files.with_travels(first_files.with_carriers(sized, draft.switched), lengths)


def _length(text: str, unit: str, least: float, faults: dict[str, InputError], field: str) -> str:
    """Return a length with its unit, which may be left out, "" for none; faults : takes what is wrong, by the field."""
    if not (text := text.strip().replace(",", ".")):
        return ""
    with suppress(ValueError):
        text = f"{float(text):.9g} {unit}"
    try:
        within(text, "length", least, _LONGEST)
    except InputError as failure:
        faults[field] = failure
        return ""
    return text


def _shown(here: Path, draft: shapes.DraftShape) -> shapes.MachineShape:
    """Return what a draft makes of a machine, and what is wrong with it, by the field."""
    faults, begun = dict[str, InputError](), None
    _length(draft.target, "um", _FINEST, faults, "target")
    readings = said(first_files.readings_in(draft.text, draft.file)) if draft.file else ""
    try:
        begun = _beginning(here, draft, faults)
    except InputError as failure:
        if (draft.file or draft.machine) and not readings:
            faults["file"] = failure
    if readings and len(draft.text) == shapes.LETTERS:
        what, remedy = "Readings of up to {most} letters can be dropped", "Drop a part of it"
        faults["file"] = DescriptionError(what, remedy, draft.file, most=shapes.LETTERS)
    in_words = {field: str(fault) for field, fault in faults.items()}
    if begun is None:
        return shapes.MachineShape(faults=in_words, readings=readings)
    machine = machine_from_text(begun.text)
    return shapes.MachineShape(
        title=machine.name,
        faults=in_words,
        readings=readings,
        lengths=first_files.linear_travels(begun),
        carried=[axis.name for axis in machine.axes if axis.workpiece_side],
        radii=[axis.name for axis in machine.axes if axis.diameters],
        look=begun.look,
        offered=[name for name in first_files.offered_names(here) if setups_of(machine, name)],
        asks=begun.active in (UNSAID, *_ACTIVE.values()),
    )


def _record_files(here: Path) -> list[Path]:
    """Return the last records of a folder and of those below it, the last first."""
    files = {file: file.stat().st_mtime for pattern in ("*.axiscal", "*/*.axiscal") for file in here.glob(pattern)}
    results = {results_beside(file) for file in files}
    own = {file: at for file, at in files.items() if file.parent not in {*results, here / FOLDER}}
    return sorted(own, key=lambda file: -own[file])[:_LISTED]


def _records(here: Path) -> tuple[list[RecordStanding], list[str]]:
    """Return the campaigns that can be gone on with, and what cannot be read."""
    found, faults = standings(_record_files(here))
    return [RecordStanding.of(each, here) for each in found], [str(fault) for fault in faults]
