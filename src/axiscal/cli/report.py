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
        Path | None, typer.Option(metavar="FILE.html", help="Where to write it; default: beside the record.")
    ] = None,
) -> None:
    """Write the report of a campaign, finished or not: one page that needs no network.

    \b
    Example:
      axiscal report mill.axiscal --out mill.html
    """

    target = record.with_suffix(".html") if out is None else _page(out)
    with Campaign.open(record, write=False) as campaign:
        summary = summarise(campaign, ruled(campaign.concluded()), Extras(files=[str(record)]))
    target.parent.mkdir(parents=True, exist_ok=True)
    write_report(summary, target)
    say(f"The report is in {target}.")


def _page(out: Path) -> Path:
    """Return the file if its name is one of a page; raises RecordError for another kind of file."""
    if out.suffix.lower() in (".html", ".htm"):
        return out
    what = f"the report is an HTML page, and {out.name} is not the name of one"
    raise RecordError(what, f"Write it to {out.with_suffix('.html').name}; a browser prints it as PDF", out)
