"""`axiscal report`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.campaign.campaign import Campaign
from axiscal.cli.arguments import OwnRecord
from axiscal.cli.printing import say
from axiscal.estimation.ruled import ruled
from axiscal.exceptions import RecordError
from axiscal.report.delivery import write_report
from axiscal.report.summarising import Extras, summarise


def report(
    record: OwnRecord,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE.html", help="Where to write it, .html or .pdf; default: beside the record."),
    ] = None,
) -> None:
    """Write the report of a campaign, finished or not: one page that needs no network, or a PDF.

    \b
    Examples:
      axiscal report mill.axiscal --out mill.html
      axiscal report mill.axiscal --out mill.pdf
    """

    target = record.with_suffix(".html") if out is None else _page(out)
    with Campaign.open(record, write=False) as campaign:
        summary = summarise(campaign, ruled(campaign.concluded()), Extras(files=[str(record)]))
    target.parent.mkdir(parents=True, exist_ok=True)
    write_report(summary, target)
    say(f"The report is in {target}.")


def _page(out: Path) -> Path:
    """Return the file if its name is one of a page or a PDF; raises RecordError for another kind of file."""
    if out.suffix.lower() in (".html", ".htm", ".pdf"):
        return out
    what = f"the report is an HTML page or a PDF, and {out.name} is the name of neither"
    raise RecordError(what, f"Write it to {out.with_suffix('.html').name} or {out.with_suffix('.pdf').name}", out)
