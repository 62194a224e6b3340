"""`axiscal measure`."""

from __future__ import annotations

from axiscal.answers.answer_of_campaign import results_beside
from axiscal.cli.arguments import Language, OwnRecord, ResultsFolder
from axiscal.cli.opened import opened_to_write
from axiscal.cli.outputs import write_outputs
from axiscal.cli.printing import say
from axiscal.cli.prompt import Prompt
from axiscal.language.spoken import said, speaking, spoken_now
from axiscal.present.result_set import RECORD
from axiscal.present.summarising import Extras
from axiscal.present.whose_language import chosen


def measure(
    record: OwnRecord,
    out: ResultsFolder = None,
    language: Language = None,
) -> None:
    """Take the readings of a campaign at one prompt.

    It says where to go and what to expect; you type what you read. Each reading is on the disk before the next question
    is shown. Type ? for help, pause to stop for now; at the end the results are written.

    \b
    Examples:
      axiscal measure mill.axiscal
      axiscal measure mill.axiscal -o results --language de
    """
    folder = out or results_beside(record)
    with speaking(chosen(language)):
        with opened_to_write(record, "measure") as campaign:
            over = False
            try:
                over = Prompt(campaign, folder).held()
            except EOFError:
                say("")
            if over:
                campaign.refuse_other(folder / RECORD)
                campaign.finish()
                write_outputs(campaign, folder, as_json=False, extras=Extras(spoken=spoken_now()))
            else:
                campaign.sign()
        if not over:
            say(said("Paused; every reading is kept. Go on: axiscal measure {record}", record=record))
