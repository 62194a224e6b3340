"""campaign.toml -> CampaignDescription: what is to be reached, with which set-ups, on which machine.

[programs] has the same words as a command line: how programs go to their readings.

Who measured what with which instruments: what a report is signed for, and no figure depends on.
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from pydantic import Field

from axiscal.description.artefacts import read_artefacts
from axiscal.description.campaign_schema import CampaignTable, ReportTable
from axiscal.description.fields import CONTROLS, TableContext
from axiscal.description.screws import BedScrews
from axiscal.description.setups import each_alone, read_setups
from axiscal.description.sights import refuse_idle_artefacts
from axiscal.description.sites import Surroundings
from axiscal.description.stated_type_b import REFERENCE, refers_to_20
from axiscal.description.target import Target, read_target
from axiscal.description.usual import usual_machine
from axiscal.document import Document, meant, read_model, shown
from axiscal.document.gone import instead_of, without_gone
from axiscal.document.ports import names
from axiscal.exceptions import DescriptionError
from axiscal.machine import DescribedMachine, builtin_names, load_machine, machine_from_text
from axiscal.machine.motion import Driving
from axiscal.measurement.setup import CARRIED, TRUED, Setup, Unknown
from axiscal.record.accepted import Bumped
from axiscal.record.carried import TYPE
from axiscal.record.events import Created, Mounted, Warmed
from axiscal.units import format_quantity
from axiscal_core.instrument import TOOL
from axiscal_core.machine import Machine
from axiscal_core.refusals import one
from axiscal_core.theta import Sure


@dataclass(frozen=True, slots=True)
class Equipment:
    """The instrument or artefact of readings: serial number and calibration certificate, "" where nobody said."""

    serial: str = ""
    certificate: str = ""


class Particulars(ReportTable, frozen=True):
    """[report] of campaign.toml, with its machine, instruments and artefacts; "" where nothing is said.

    maker, serial : of the machine; setups, artefacts : by name
    """

    maker: str = ""
    serial: str = ""
    setups: dict[str, Equipment] = Field(default={})
    artefacts: dict[str, Equipment] = Field(default={})


NOTHING_SAID = Particulars()


def read_particulars(table: CampaignTable, machine: DescribedMachine) -> Particulars:
    """Return who measured with what."""
    built = tomllib.loads(machine.text)
    of_machine = {key: str(built.get(key, "")) for key in ("maker", "serial")}
    mounted = [each for one in table.setups for each in each_alone(one)]
    said = mounted, table.artefacts
    setups, artefacts = ({each.name: Equipment(each.serial, each.certificate) for each in tables} for tables in said)
    return Particulars(**table.report.model_dump(), **of_machine, setups=setups, artefacts=artefacts)


_PRINTERS = {"klipper", "marlin", "reprapfirmware"}
_SCALES: dict[str | None, Sure] = {None: "roughly", "stated": "well", "estimate": "roughly"}
"""What campaigns said before there was `sure`."""
_ONCE_USUAL = 5e-6
"""m: of the tool's length in records that do not say which doubts are usual (an assumption of then)."""


class Era(NamedTuple):
    """What counts where a campaign says nothing; records of before say none of it, and do not have it.

    usual_doubts : zeros wander, the tool is not quite as stated; fine_knots : knots are as close as is cheap
    whole_lengths : as of `Surroundings`
    """

    usual_doubts: bool = True
    fine_knots: bool = True
    whole_lengths: bool = True


TODAY = Era()


@dataclass(frozen=True, slots=True)
class CampaignDescription:
    """A campaign as described by its owner.

    setups : in the order of the file; text, source : the campaign.toml it came from, and where that was read
    machine_source : the file or the built-in name of the machine, whose text is `machine.text`
    sure : how well stated sizes and lengths of errors are known, where an error does not say it itself
    usual : with what usually goes wrong; else what is stated and nothing besides, the model of the paper
    prior_text : the campaign whose result is the prior (see `heritage`); empty for none
    prior_gone : whether the record carries a prior that a type has taught, which does not count
    kept : share of each error that is as that campaign found it
    compensation_active : whether a compensation is active on the control while measuring, or the files of it; None
        where nobody said
    particulars : who measured, with which instruments, for the report
    era : of the record it is of, today's without one
    controls : those whose files a finished campaign gets, the first one first
    screws : under the bed of a printer; None where nobody states them
    zero_at : X and Y where a printer has the zero of Z, m; None where nobody states it
    bumps : what the record says of the signs of controls
    """

    machine: DescribedMachine
    target: Target
    setups: tuple[Setup, ...]
    text: str
    source: str
    machine_source: str
    sure: Sure = "exactly"
    usual: bool = False
    prior_text: str = ""
    prior_gone: bool = False
    kept: float = 1.0
    compensation_active: bool | tuple[str, ...] | None = None
    particulars: Particulars = NOTHING_SAID
    era: Era = TODAY
    controls: tuple[str, ...] = ("linuxcnc",)
    screws: BedScrews | None = None
    zero_at: tuple[float, float] | None = None
    bumps: tuple[Bumped, ...] = ()

    @property
    def unsaid_offsets(self) -> list[str]:
        """The set-ups of a printer's probe of which nobody says how far it stands beside the nozzle."""
        probes = (each for each in self.setups if each.instrument == "probe" and each.chart is None)
        return [each.name for each in probes if each.offset is None and set(self.controls) <= _PRINTERS]

    def bump_of(self, controller: str) -> Bumped | None:
        """Return the latest bump in the tables of a control, None where nobody has read one."""
        return next((each for each in reversed(self.bumps) if each.controller == controller), None)

    def setup(self, name: str) -> Setup:
        """Return the set-up of that name; raises DescriptionError when there is none."""
        for setup in self.setups:
            if setup.name == name:
                return setup
        known = ", ".join(f'"{setup.name}"' for setup in self.setups)
        remedy = "The set-ups are {known}"
        raise DescriptionError("there is no set-up {name}", remedy, self.source, name=shown(name), known=known)


def read_campaign(path: str | Path, *, target_needed: bool = True, asking: bool = True) -> CampaignDescription:
    """Return the campaign in a file, with its machine (a file beside it, or a built-in name).

    target_needed : refuse a campaign that nothing would ever stop
    asking : readings are to be asked for, and set-ups that do not say where they can be read are refused
    Raises DescriptionError or UnitError with file, line, value and remedy.
    """
    document = Document.read(one("read_campaign", "path", path, (str, Path), '"campaign.toml"'))
    name = _machine_name(document)
    source = name if name in builtin_names() else str(document.path.parent / name)
    prior = _prior_text(document)
    found = _described(document, load_machine(source), source, prior, TODAY, True, target_needed, asking)
    known = names(CONTROLS)  # a record opens without the package that writes its tables
    for control in (each for each in document.data.get("controls", ()) if each not in known):
        what = "{controller} is not a controller that tables can be made for"
        remedy = instead_of("controls", control) or meant(control, known, quoted="{}")
        fault = DescriptionError(what, remedy, controller=shown(control))
        raise document.fault(fault, "controls")
    for named in found.compensation_active if isinstance(found.compensation_active, tuple) else ():
        if not any((document.path.parent / each).exists() for each in (named, named.partition("=")[2] or named)):
            what = "compensation_active names {name}, which is not there"
            remedy = "Name a file that is, or write true or false without quotes"
            raise DescriptionError(what, remedy, document.path, document.line("compensation_active"), name=shown(named))
    return found


def _prior_text(document: Document) -> str:
    """Return the campaign that `prior` names, "" where there is none."""
    name = document.data.get("prior")
    if not isinstance(name, str) or not name.strip():
        return ""
    from axiscal.record.carried import carried_text

    return carried_text(document.path.parent / name)


def campaign_from_texts(
    text: str,
    source: str,
    machine_text: str,
    machine_source: str,
    *,
    prior_text: str = "",
    era: Era = TODAY,
    anew: bool = False,
) -> CampaignDescription:
    """Return the campaign of a record, from the texts it carries; raises as `read_campaign` does.

    One that does not say where its set-ups can be read opens: readings of an earlier time are no less true.
    anew : no record has it yet, and keys of which nothing comes are refused
    """
    document = Document.parse(text, source)
    document = document if anew else without_gone(document)
    machine = machine_from_text(machine_text, machine_source, fine_knots=era.fine_knots)
    of_type = TYPE in prior_text[:200]
    found = _described(document, machine, machine_source, "" if of_type else prior_text, era, anew)
    return replace(found, prior_gone=of_type)


def description_of(created: Created) -> CampaignDescription:
    """Return the description that a campaign began with; raises DescriptionError."""
    texts = created.campaign_text, created.campaign_source, created.machine_text, created.machine_source
    era = Era(*(getattr(created, name) for name in Era._fields))
    return campaign_from_texts(*texts, prior_text=created.prior_text, era=era)


def with_offset(described: CampaignDescription, setup: str, beside: tuple[float, float]) -> CampaignDescription:
    """Return a campaign whose text also says where the probe of a set-up stands.  beside : x and y, m

    Raises DescriptionError where the set-up is not written line by line.
    """
    x, y = (format_quantity(each, "mm", 6) for each in beside)
    said = f'offset = ["{x}", "{y}", "0 mm"]'
    document = without_gone(Document.parse(described.text, described.source))
    tables = read_model(document, CampaignTable, context=TableContext(described.machine, document)).setups
    line = document.line("setups", [table.name for table in tables].index(setup), "name") or 1
    if not document.text.split("\n")[line - 1].lstrip().startswith("name"):
        what, remedy = "the probe stands beside the nozzle, and this set-up does not say so", "Write {said}"
        raise DescriptionError(what, remedy, described.source, line, said=said)
    return _with_line(described, line, said)


def with_zero(described: CampaignDescription, zero: tuple[float, float]) -> CampaignDescription:
    """Return a campaign whose text also says where its printer has the zero of Z.  zero : x and y, m"""
    x, y = (format_quantity(each, "mm", 6) for each in zero)
    return _with_line(described, 0, f'zero_at = ["{x}", "{y}"]')


def _with_line(described: CampaignDescription, line: int, said: str) -> CampaignDescription:
    """Return a campaign with a further line of text behind a line."""
    lines = described.text.split("\n")
    text = "\n".join([*lines[:line], said, *lines[line:]])
    sources, kept = (described.machine.text, described.machine_source), (described.prior_text, described.era)
    return campaign_from_texts(text, described.source, *sources, prior_text=kept[0], era=kept[1])


def _machine_name(document: Document) -> str:
    name = document.data.get("machine")
    if isinstance(name, str) and name.strip() and name.isprintable():
        return name
    what = '"machine" is missing' if name is None else "machine: {name} is not the name of a machine"
    remedy, known = 'Give a file, machine = "machine.toml", or one of {known}', ", ".join(builtin_names())
    raise DescriptionError(what, remedy, document.path, document.line("machine") or 1, name=shown(name), known=known)


def _described(
    document: Document,
    machine: DescribedMachine,
    machine_source: str,
    prior_text: str,
    era: Era,
    anew: bool,
    target_needed: bool = False,
    asking: bool = False,
) -> CampaignDescription:
    usual_doubts = era.usual_doubts
    table = read_model(document, CampaignTable, context=TableContext(machine, document, anew))
    target = read_target(table.target, machine, document)
    artefacts = read_artefacts(table.artefacts, document) if table.artefacts else {}
    tool = _tool(table, machine, usual_doubts)
    printer = usual_doubts and set(table.controls) <= _PRINTERS  # records of before know no such probe
    at_20 = refers_to_20(table, artefacts, document)
    target = replace(target, refers_to="20 degC" if at_20 else "as read")
    of_era = usual_doubts, printer, at_20, era.whole_lengths
    around = Surroundings(machine, document, artefacts, tool, asking, anew, *of_era)
    setups = read_setups(table.setups, around)
    if anew:
        refuse_idle_artefacts(table.artefacts, document)
    driving = Driving(**dict(table.programs))
    setups = tuple(replace(setup, driving=driving) for setup in setups)
    only = machine.only
    if only is not None and target.part is None and machine.axes[only].name not in table.target.volume:
        target = _along_the_line(target, machine, only, setups)
    if target_needed and target.empty:
        remedy = 'Add at least one of rms = "2 um", worst = "4 um", readings = 40, budget = "90 min" under [target]'
        raise DescriptionError("nothing would ever stop this campaign", remedy, document.path, document.line("target"))
    _refuse_budget(target, setups, document)
    usual = table.usual == "on"
    machine = usual_machine(machine, setups, printer) if usual else machine
    # from its record a file of instruments is looked for again, wherever that is opened
    source = str(document.path.absolute() if any(setup.written for setup in setups) else document.path)
    return CampaignDescription(
        machine=machine,
        target=target,
        setups=setups,
        text=document.text,
        source=source,
        machine_source=machine_source,
        sure=table.sure or _SCALES[table.scales],
        usual=usual,
        prior_text=prior_text,
        kept=table.kept,
        compensation_active=table.compensation_active,
        particulars=read_particulars(table, machine),
        era=era,
        controls=tuple(dict.fromkeys(table.controls)),
        screws=None if table.screws is None else table.screws.screws(),
        zero_at=table.zero_at,
    )


def _along_the_line(target: Target, machine: Machine, only: int, setups: Sequence[Setup]) -> Target:
    """Return a target over the line that set-ups can read, of a machine that describes one axis alone."""
    spans = [setup.span(machine.axes[only], only) for setup in setups if only in setup.moves] or [target.volume[only]]
    ends = min(low for low, _ in spans), max(high for _, high in spans)
    return replace(target, volume=(*target.volume[:only], ends, *target.volume[only + 1 :]))


def _tool(table: CampaignTable, machine: Machine, usual_doubts: bool) -> tuple[Unknown, ...]:
    """Return what is not known of where the tool's point sits along its x, y, z; nothing where no axis turns it."""
    if not any(axis.rotary for axis in machine.axes):
        return ()
    usual, trued = (CARRIED, TRUED) if usual_doubts else (_ONCE_USUAL, 0.0)
    length = usual if table.tool_length is None else table.tool_length
    aside = min(length, trued) if table.tool_eccentricity is None else table.tool_eccentricity
    stds = zip(TOOL, (aside, aside, length), strict=True)
    return tuple(Unknown(name, std, "tool") for name, std in stds if std > 0)


def _refuse_budget(target: Target, setups: tuple[Setup, ...], document: Document) -> None:
    quickest = min(setup.setup_time + setup.settle + setup.reading_time for setup in setups)
    if target.budget is not None and target.budget < quickest:
        needs = format_quantity(quickest, "min", 3)
        what = "{given} is less than the {needs} that the first reading takes"
        remedy = "Allow more time, or give a shorter setup_time"
        fault = DescriptionError(what, remedy, given=format_quantity(target.budget, "min", 3), needs=needs)
        raise document.fault(fault, "target", "budget")


def with_mounted(
    description: CampaignDescription, mounted: Sequence[Mounted], warmed: Sequence[Warmed] = ()
) -> CampaignDescription:
    """Return a campaign with its set-ups as warm as somebody said, and as they were mounted anew behind them.

    Of several temperatures of one set-up the mean counts.
    Unknowns of a set-up alone begin as stated, whatever is known of the other one: zero, slope, station, drift of the
    zero. Quantities of an artefact, a bar or a tool stay one; but where an artefact stood before a jump is its own.
    Raises DescriptionError where there is no such set-up.
    """

    def warm(setup: Setup) -> Setup:
        said = [each.temperature for each in warmed if each.setup == setup.name]
        return replace(setup, warmer=sum(said) / len(said) - REFERENCE) if said else setup

    description = replace(description, setups=tuple(map(warm, description.setups)))
    for each in mounted:
        setup = description.setup(each.setup)
        stood = setup.artefact.standing if setup.artefact and not each.branch else None
        moved = (replace(one, owner=each.name) if one.owner == stood else one for one in setup.unknowns)
        anew = warm(replace(setup, name=each.name, unknowns=tuple(moved)))
        description = replace(description, setups=(*description.setups, anew))
    return description
