"""`axiscal step skip`."""

from __future__ import annotations

from typing import Annotated

import typer

from axiscal.answers.answer_of_campaign import cost_sentence, cost_words
from axiscal.cli.arguments import Json, RecordFile
from axiscal.cli.opened import opened_to_write
from axiscal.cli.record import answered
from axiscal.language.spoken import said
from axiscal.present.guide.question import asked_text


def skip(
    record: RecordFile,
    reason: Annotated[list[str], typer.Argument(metavar="REASON", help="Why it cannot be taken.")],
    leave: Annotated[bool, typer.Option("--leave", help="Nothing more can be read with this set-up.")] = False,
    then_next: Annotated[bool, typer.Option("--next", help="Then say which reading comes next.")] = False,
    json: Json = False,
) -> None:
    """Skip the reading that is asked for, with its reason.

    It says what that costs; the plan is made anew around it. Undo takes it back.

    \b
    Examples:
      axiscal step skip mill.axiscal "the beam is blocked here"
      axiscal step skip mill.axiscal "the laser has to go back" --leave
    """
    with opened_to_write(record) as campaign:
        costs = cost_words(campaign, rest=leave)
        asked = campaign.skip(" ".join(reason), rest=leave)
        what = asked_text(campaign, asked)
        done = "Left the set-up at {reading}: {reason}" if leave else "Skipped {reading}: {reason}"
        lines = [said(done, reading=what, reason=" ".join(reason).strip()), cost_sentence(costs)]
        lines += [said("Take it back: axiscal step undo {record}", record=record)] if costs else []
        document: dict[str, object] = {"skipped": asked.reading, "set_up_left": leave, "costs": costs}
        answered(campaign, document, lines, then_next=then_next, as_json=json)
