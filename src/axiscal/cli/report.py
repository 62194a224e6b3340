"""`axiscal finish` and `report`: the results of a campaign."""

from __future__ import annotations

from pathlib import Path

import typer

from axiscal.campaign.campaign import Campaign
from axiscal.cli.outputs import write_outputs
from axiscal.cli.printing import say
from axiscal.cli.texts import opened_to_write
from axiscal.document.gone import instead_of
from axiscal.exceptions import RecordError
from axiscal.language.spoken import said
from axiscal.present.answer_of_campaign import results_of, standing_answer
from axiscal.present.delivery import language_of_report, write_report
from axiscal.present.result_of_campaign import result_of
from axiscal.present.result_set import RECORD


def report(record: Path, out: Path | None = None, language: str | None = None) -> None:
    """Write the report of a campaign, finished or not."""
    target = out or record.with_suffix(".pdf")
    option = f"report --out FILE{target.suffix.lower()}"
    if instead := instead_of("options", option):
        raise typer.BadParameter(said("{name} is gone. {instead}.", name=option, instead=instead))
    if target.suffix.lower() != ".pdf":
        what = "the report is a PDF, and {out} is the name of none"
        raise RecordError(what, "Write it to {name}", target, out=target.name, name=target.with_suffix(".pdf").name)
    with Campaign.open(record, write=False) as campaign:
        known = campaign.estimate(ended=True)
        result = result_of(campaign, known, standing_answer(campaign))
        target.parent.mkdir(parents=True, exist_ok=True)
        write_report(campaign, result, target, language_of_report(campaign.description.particulars, language))
    say(said("The report is in {file}.", file=target))


def finish(record: Path, out: Path | None = None, anyway: bool = False, details: bool = False) -> None:
    """End a campaign and write its results."""
    with opened_to_write(record, "finish") as campaign:
        folder = out or results_of(record)
        campaign.log.refuse_other(folder / RECORD)
        campaign.finish()
        write_outputs(campaign, folder, details=details, anyway=anyway)
