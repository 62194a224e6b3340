"""`axiscal finish`."""

from __future__ import annotations

from axiscal.answers.answer_of_campaign import results_of
from axiscal.cli.arguments import Anyway, Details, Json, OwnRecord, ResultsFolder
from axiscal.cli.opened import opened_to_write
from axiscal.cli.outputs import write_outputs
from axiscal.present.result_set import RECORD


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
