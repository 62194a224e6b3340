"""What a finished campaign leaves in a folder: tables, `result.json`, `report.pdf`."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.evidence import evidence_words
from axiscal.campaign.wrong_unit import refuse_implausible
from axiscal.description.campaign import CampaignDescription, Particulars
from axiscal.description.placed_readings import file_readings
from axiscal.document.durable import write_whole, written
from axiscal.estimation.estimation import Estimation
from axiscal.exceptions import ReadingError, TableError
from axiscal.language.spoken import capital, put, said, speaking, spoken_now
from axiscal.language.stages import stage
from axiscal.measurement.readers.csv_readings import Around
from axiscal.measurement.readers.files import recognised
from axiscal.measurement.readers.probe_offset import place_of
from axiscal.measurement.reading import Reading
from axiscal.present.answer import TablesChecked
from axiscal.present.answer_of_campaign import answer_of
from axiscal.present.conditions import NOT_KNOWN
from axiscal.present.result import Finding, Result, TableFile
from axiscal.present.result_of_campaign import record_state, result_of
from axiscal.present.result_set import RECORD, result_set, write_manifest
from axiscal.present.whose_language import named_language
from axiscal.tables import registry
from axiscal.tables.offer import Export, effect_sentence
from axiscal.units import to_unit
from axiscal_core.threads import one_thread

_ALWAYS = "csv"
"""What every finished campaign gets beside the files for its own controls; `axiscal export` makes others."""


class ReadIn(NamedTuple):
    """Readings of a file with the campaign that says where its probe stood, and what it was."""

    description: CampaignDescription
    readings: tuple[Reading, ...]
    told: str


def read_in(
    described: CampaignDescription, file: Path, unit: str = "", along: str = "", zero: str | None = None
) -> ReadIn:
    """Return the readings of a file of any kind; raises ReadingError.

    unit : of lengths, where it names none; along : name of the axis of a test that names none, "" where nobody said
    zero : where a printer homes Z, None where nobody said
    Raises DescriptionError for an axis that the machine does not have.
    """
    read = recognised(file, Around(described.machine.axes, described.setups), unit)
    if zero is not None:
        stated = place_of(zero)
        told = tuple(replace(row, zero=stated) for row in read.readings)
        read = replace(read, readings=told)
    rows = read.readings
    if along:
        described.machine.axis(along)
        if other := next((row for row in rows if not row.test or row.axis not in ("", along)), None):
            what = "the file says itself where it was read, so {axis} is not to be named"
            raise ReadingError(what, "Leave the axis out", file, other.line, axis=along)
        rows = tuple(replace(row, axis=along) for row in rows)
    described, placed = file_readings(rows, described, file)
    refuse_implausible(placed, described, file)
    return ReadIn(described, placed, read.sentence([each.setup for each in placed]))


@contextmanager
def evaluated(description: CampaignDescription, readings: tuple[Reading, ...]) -> Iterator[Campaign]:
    """Give a campaign of readings that exist, ended, for as long as its results are written; raises ReadingError."""
    with (
        TemporaryDirectory(prefix="axiscal-") as folder,
        Campaign.create(Path(folder) / RECORD, description) as campaign,
    ):
        campaign.adopt(readings)
        campaign.finish("all readings evaluated")
        yield campaign


@one_thread()
def deliver(
    campaign: Campaign,
    estimation: Estimation,
    out: Path,
    *,
    anyway: bool = False,
    checked: TablesChecked | None = None,
    warnings: Sequence[Finding] = (),
) -> Result:
    """Write record, tables, result and report of a campaign as a set, and return what they say.  Raises OSError.

    anyway : tables and uncertainties are written although readings contradict each other; each page says that they do
    checked : what a check of the tables on the machine found; warnings : about what was given
    A table that a control cannot hold is not written; the report says why.
    The report is in the language of the campaign, else of the person who ends it, all other files are in English.
    """
    described = campaign.description
    language = language_of_report(described.particulars, None, spoken_now())
    with speaking("en"):
        with stage("tables"):
            made = {name: _made(estimation, name, anyway) for name in (*described.controls, _ALWAYS)}
        files = [each for each in made.values() if isinstance(each, Export)]
        controls = {each.controller: each.control for each in files if each.controller in described.controls}
        answer = answer_of(campaign, estimation, controls, written=True, anyway=anyway, checked=checked)
        offers = [row for name, each in made.items() for row in _offered(name, each, described, answer.withheld)]
        advised = {step.control for step in answer.steps}
        best = min(files, key=lambda each: (each.controller not in advised, each.expected), default=None)
        result = result_of(campaign, estimation, answer, tables=offers, best=best, warnings=warnings)
    home = out / RECORD
    live = home.exists() and campaign.path.exists() and home.samefile(campaign.path)
    with speaking("en"), result_set(out) as folder:
        if not live:
            campaign.log.copy_to(folder / RECORD)
        doubts = [each.text for each in result.warnings]
        for name, each in made.items():
            if isinstance(each, Export):
                write_files(introduced(each, campaign, result.agreement.text, doubts), folder / "tables" / name)
        document = json.dumps(result.model_dump(mode="json", by_alias=True), indent=2, ensure_ascii=False)
        written(folder / "result.json", f"{document}\n".encode())
        with stage("the report"):
            write_report(campaign, result, folder / "report.pdf", language)
        write_manifest(folder, result.record, result.versions)
    return result


def language_of_report(particulars: Particulars, wanted: str | None, spoken: str = "en") -> str:
    """Return the language of a report: wanted or AXISCAL_LANGUAGE, else of campaign.toml, else of who is spoken to."""
    return named_language(wanted) or particulars.language or spoken


def write_report(campaign: Campaign, result: Result, path: Path, language: str) -> None:
    """Write the report as PDF; raises OSError."""
    with speaking(language):
        from axiscal.present.rendering import drawn_pictures, pdf  # pictures, which only a report needs

        content = pdf(result, drawn_pictures(campaign, result))
    write_whole(path, content)


def _made(estimation: Estimation, controller: str, anyway: bool) -> Export | str:
    """Return the files for one control, or why there are none."""
    if estimation.agreement.withheld and not anyway:
        return said(NOT_KNOWN)
    try:
        return registry.offered(estimation, controller)
    except (TableError, ReadingError) as refusal:
        return put("{what}. {remedy}.", what=refusal.what, remedy=capital(refusal.remedy))


def _offered(
    controller: str, made: Export | str, described: CampaignDescription, withheld: bool
) -> Iterator[TableFile]:
    """Yield each file for one control with what all leave, or why there are none."""
    if isinstance(made, str):
        yield TableFile(controller=controller, left_out=made)
        return
    left = effect_sentence(said("All files together"), made.effect, made.known)
    if (bump := described.bump_of(controller)) is not None:
        left = put("{left} {sign}", left=left, sign=said("Sign measured on {day}.", day=bump.day))
    before, after, expected, certain = (to_unit(each, "um") for each in (*made.effect, made.expected, made.certain))
    for name in made.files:
        yield TableFile(
            controller=controller,
            file=f"tables/{controller}/{name}",
            axis=name.partition(".")[0].replace("_", " "),
            before_um=before,
            after_um=after,
            expected_um=expected,
            U_um=None if withheld else certain,
            left_out=left,
        )


def introduced(offered: Export, campaign: Campaign, agreement: str, warnings: Sequence[str]) -> Export:
    """Return an export whose README.txt says where it comes from, and last what is doubtful.

    agreement : whether the readings agree, "" before the first
    """
    record, signed = record_state(campaign), evidence_words(campaign.log)
    origin = f"From the record {record.file} at event {record.event}: {record.hash}\n"
    origin += f"{signed}\n" if signed else ""
    before = origin + (f"{agreement}.\n" if agreement else "")
    text = offered.readme.replace("\nThese files hold ", f"\n{before}These files hold ", 1)
    if warnings:
        text = f"{text.rstrip()}\n\nMind, before the files are loaded:\n" + "".join(f"- {each}\n" for each in warnings)
    return replace(offered, readme=text)


def write_files(offered: Export, folder: Path) -> None:
    """Write the files of an export with their README.txt; raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in {**offered.files, "README.txt": offered.readme}.items():
        write_whole(folder / name, text.encode())
