"""What `--out DIR` receives, and the last screen of a command."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from axiscal.campaign.agreement_words import agreement_words
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.evidence import evidence_words
from axiscal.cli.printing import DOCUMENTS, say, say_document
from axiscal.exceptions import AxiscalError, ReadingError, RecordError
from axiscal.language.spoken import again, put, said, speaking
from axiscal.present.answer_of_campaign import results_of, standing_answer
from axiscal.present.answer_words import screen
from axiscal.present.conditions import NOT_KNOWN
from axiscal.present.delivery import deliver
from axiscal.present.plan_answer import coming_answer
from axiscal.present.plan_words import plan_screen
from axiscal.present.result import Finding, Result, TableFile
from axiscal.present.sentences import U_OF_TABLES


def write_outputs(
    campaign: Campaign,
    out: Path,
    *,
    details: bool = False,
    record: Path | None = None,
    warnings: Sequence[Finding] = (),
    again: str = "",
    anyway: bool = False,
) -> Result:
    """Write record, tables, result and report of a finished campaign to a folder, print them and return the result.

    details : say what U holds for and all warnings, too; record : where the campaign stays, unless where it is
    again : what to do after a failure, by default another `finish`
    anyway : U and tables are written although the readings contradict each other
    Raises RecordError, TableError; AxiscalError after Ctrl-C; ReadingError, when all else is written, where the
    readings contradict each other.
    """

    whole = f"The results in {out} are whole, those of before or the new ones"
    again = again or said("write them by: axiscal finish {record} --out {out}", record=campaign.path, out=out)
    try:
        result = deliver(campaign, campaign.estimate(ended=True), out, anyway=anyway, warnings=warnings)
    except OSError as failure:
        what, reason = "The results were not written: {reason}", failure.strerror or failure
        remedy = "Check the permissions and the room on the disk; those of before, if any, stand whole; then {again}"
        raise RecordError(what, remedy, failure.filename or out, reason=reason, again=again) from failure
    except KeyboardInterrupt:
        raise AxiscalError(f"Stopped by Ctrl-C. Every reading is kept. {whole}; {again}") from None
    if DOCUMENTS.get():
        with speaking("en"):
            say_document(result.model_dump(mode="json", by_alias=True))
    else:
        if details:
            tell_details(result)
        say(written_screen(result, record or campaign.path, out, evidence_words(campaign.log)))
    if result.answer.withheld:
        remedy = (
            "Take the readings again that stand out, or write U and tables all the same with finish --anyway; all "
            "readings are kept and the report is written"
        )
        raise ReadingError(NOT_KNOWN, remedy, out)
    return result


def tell_details(result: Result) -> None:
    """Print what U holds for, what the files of each control leave, and all warnings."""
    if result.U_holds_for is not None:
        say(put("{what}: {these}", what=said("Holds"), these=result.U_holds_for))
    for table in {each.controller: each for each in result.tables}.values():
        say(_offered(table))
    if result.tables and not result.answer.withheld:
        say(said(U_OF_TABLES))
    for warning in result.warnings:
        say(said("Mind: {sentence}", sentence=warning.text))


def _offered(table: TableFile) -> str:
    where = table.controller if table.file else said("No table for {control}", control=table.controller)
    return put("{where}: {why}", where=where, why=again(table.left_out))


def written_screen(result: Result, record: Path, out: Path, signed: str = "") -> str:
    """Return the screen of a campaign whose results are written.

    record : where it stays; signed : who answers for it, "" for nobody
    """
    none = "" if result.answer.withheld or any(each.file for each in result.tables) else _offered(result.tables[0])
    return screen(result.answer, result.agreement.text, str(record), str(out), str(out / "report.pdf"), signed, none)


def standing_screen(campaign: Campaign) -> str:
    """Return the screen of a campaign as it stands: before the first reading, of its plan."""
    path, planned = campaign.path, coming_answer(campaign)
    if planned is not None:
        return plan_screen(planned, str(path))
    words = agreement_words(campaign.so_far()) if campaign.state.readings else ""
    results, signed = str(results_of(path)).removeprefix("."), evidence_words(campaign.log)
    return screen(standing_answer(campaign), words, str(path), results, evidence=signed)
