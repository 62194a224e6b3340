"""`axiscal finish` and `report`: the results of a campaign."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.answers.answer_of_campaign import results_of, standing_answer
from axiscal.campaign.campaign import Campaign
from axiscal.cli.arguments import Anyway, Details, Json, OwnRecord, ReportLanguage, ResultsFolder
from axiscal.cli.outputs import write_outputs
from axiscal.cli.printing import say
from axiscal.cli.texts import opened_to_write
from axiscal.document.gone import instead_of
from axiscal.exceptions import RecordError
from axiscal.language.spoken import said
from axiscal.present.delivery import write_report
from axiscal.present.result_set import RECORD
from axiscal.present.summarising import Extras, summarise


def report(
    record: OwnRecord,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE.html", help="Where to write it, .html or .pdf; default: beside the record."),
    ] = None,
    language: ReportLanguage = None,
) -> None:
    """Write the report of a campaign, finished or not.

    The report is a page that needs no network, or a PDF. It is in the language that --language or AXISCAL_LANGUAGE
    names, else in that of campaign.toml ([report] language), else in English.

    \b
    Examples:
      axiscal report mill.axiscal --out mill.html
      axiscal report mill.axiscal --out mill.pdf --language de
    """

    target = out or record.with_suffix(".html")
    option = f"report --out FILE{target.suffix.lower()}"
    if instead := instead_of("options", option):
        raise typer.BadParameter(said("{name} is gone. {instead}.", name=option, instead=instead))
    if target.suffix.lower() not in (".html", ".htm", ".pdf"):
        what = "the report is an HTML page or a PDF, and {out} is the name of neither"
        names = ", ".join(target.with_suffix(suffix).name for suffix in (".html", ".pdf"))
        raise RecordError(what, "Write it to one of {names}", target, out=target.name, names=names)
    with Campaign.open(record, write=False) as campaign:
        summary = summarise(campaign, campaign.estimate(ended=True), Extras(answer=standing_answer(campaign)))
    target.parent.mkdir(parents=True, exist_ok=True)
    write_report(summary, target, language)
    say(said("The report is in {file}.", file=target))


def finish(
    record: OwnRecord, out: ResultsFolder = None, anyway: Anyway = False, details: Details = False, json: Json = False
) -> None:
    """End a campaign and write its results.

    A finished campaign is written again, into the same folder if you like; `axiscal step undo` takes the end back.

    \b
    Example:
      axiscal finish mill.axiscal --out results
    """

    with opened_to_write(record) as campaign:
        folder = out or results_of(record)
        campaign.refuse_other(folder / RECORD)
        campaign.finish()
        write_outputs(campaign, folder, as_json=json, details=details, anyway=anyway)
