"""What `--out DIR` receives."""

from __future__ import annotations

from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.cli.last_screen import written_screen
from axiscal.cli.printing import say, say_document
from axiscal.cli.texts import count_text
from axiscal.exceptions import AxiscalError, ReadingError, RecordError
from axiscal.report.delivery import deliver
from axiscal.report.headline import NOT_KNOWN, first_lines
from axiscal.report.result_document import result_json
from axiscal.report.summarising import Extras
from axiscal.report.summary import Summary


def write_outputs(
    campaign: Campaign,
    out: Path,
    *,
    as_json: bool,
    details: bool = False,
    record: Path | None = None,
    extras: Extras | None = None,
    again: str = "",
    anyway: bool = False,
) -> None:
    """Write record, tables, result and report of a finished campaign to a folder and print them.

    details : say what U holds for and all warnings, too; record : where the campaign stays, unless where it is
    again : what to do after a failure, by default another `finish`
    anyway : U and tables are written although the readings contradict each other
    Raises RecordError, TableError; AxiscalError after Ctrl-C; ReadingError, when all else is written, where the
    readings contradict each other.
    """

    summary = _delivered(campaign, out, extras or Extras(compared=True), again, anyway)
    if as_json:
        say_document(result_json(summary))
    else:
        if details:
            _tell(summary, out)
        say(written_screen(summary, campaign, record or campaign.path, out))
    if summary.withheld:
        remedy = "Take the readings again that stand out, or write U and tables all the same with finish --anyway"
        raise ReadingError(NOT_KNOWN, f"{remedy}; all readings are kept and the report is written", out)


def _tell(summary: Summary, out: Path) -> None:
    tables = "" if summary.withheld else f"Tables: {out / 'tables'}\n"
    say(
        f"{first_lines(summary)}\n"
        f"{summary.stopped_because}: {count_text(summary.readings, 'reading')}, {summary.minutes:.1f} minutes.\n"
        f"Report: {out / 'report.html'}, {out / 'report.pdf'}\n{tables}Figures: {out / 'result.json'}"
    )
    for offer in summary.tables:
        if not offer.axis:
            say(f"No table for {offer.controller}: {offer.left_out}")
    for warning in summary.warnings:
        say(f"Mind: {warning.text}")


def _delivered(campaign: Campaign, out: Path, extras: Extras, again: str, anyway: bool) -> Summary:
    whole = f"The results in {out} are whole, those of before or the new ones"
    again = again or f"write them by: axiscal finish {campaign.path} --out {out}"
    try:
        return deliver(campaign, campaign.concluded(), out, extras, anyway)
    except OSError as failure:
        what = f"The results were not written: {failure.strerror or failure}"
        remedy = f"Check the permissions and the room on the disk; those of before, if any, stand whole; then {again}"
        raise RecordError(what, remedy, failure.filename or out) from failure
    except KeyboardInterrupt:
        raise AxiscalError(f"Stopped by Ctrl-C. Every reading is kept. {whole}; {again}") from None
