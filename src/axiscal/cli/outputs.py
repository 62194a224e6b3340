"""What `--out DIR` receives."""

from __future__ import annotations

from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.cli.printing import say, say_document
from axiscal.cli.texts import count_text
from axiscal.report.delivery import deliver
from axiscal.report.headline import first_lines
from axiscal.report.summarising import Extras
from axiscal.report.summary import result_json

RECORD = "campaign.axiscal"


def write_outputs(campaign: Campaign, out: Path, *, as_json: bool, extras: Extras | None = None) -> None:
    """Write tables, result and report of a finished campaign to a folder and print them; raises OSError, TableError."""

    summary = deliver(campaign, campaign.concluded(), out, extras or Extras(compared=True))
    if as_json:
        say_document(result_json(summary))
        return
    say(
        f"{first_lines(summary)}\n"
        f"{summary.stopped_because}: {count_text(summary.readings, 'reading')}, {summary.minutes:.1f} minutes.\n"
        f"Report: {out / 'report.html'}\nTables: {out / 'tables'}\nFigures: {out / 'result.json'}"
    )
    for offer in summary.tables:
        if not offer.axis:
            say(f"No table for {offer.controller}: {offer.left_out}")
    for warning in summary.warnings:
        say(f"Mind: {warning.text}")
