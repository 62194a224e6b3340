"""`axiscal step skip`."""

from __future__ import annotations

from typing import Annotated

import typer

from axiscal.cli.arguments import Json, RecordFile
from axiscal.cli.record import skipped


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
    skipped(record, " ".join(reason), leave=leave, then_next=then_next, as_json=json)
