"""`axiscal shop adopt`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.campaign.adopting import adopted
from axiscal.cli.arguments import Json, RecordFile
from axiscal.cli.opened import opened_to_write
from axiscal.cli.printing import say_either
from axiscal.cli.texts import count_text
from axiscal.language.spoken import counted, said
from axiscal.record.copies import opened_log


def adopt(
    record: RecordFile,
    branch: Annotated[Path, typer.Argument(metavar="BRANCH", help="What went on elsewhere: store:ID, or a file.")],
    same_mounting: Annotated[
        bool, typer.Option("--same-mounting", help="Set-ups that both have read stayed mounted for both.")
    ] = False,
    mounted_anew: Annotated[
        bool, typer.Option("--mounted-anew", help="They were mounted anew for the branch: other zeros, other stations.")
    ] = False,
    again: Annotated[
        bool, typer.Option("--again", help="Also those that were taken over before and taken back here since.")
    ] = False,
    json: Json = False,
) -> None:
    """Take the readings of a branch over into its campaign.

    The branch stays as it is. Its readings come behind those of the campaign, as readings that were given. What was
    planned, asked and taken back there stays there. Given again, it takes only what has been read since.

    \b
    Example:
      axiscal shop adopt store:mill-7 store:3f2a91c4-07de
    """
    if same_mounting and mounted_anew:
        raise typer.BadParameter(said("Say --same-mounting or --mounted-anew, not both."))
    with opened_to_write(record) as campaign, opened_log(record, write=False) as own:
        with opened_log(branch, write=False) as other:
            found = adopted(campaign, own, other, same_mounting, again, mounted_anew)
        readings = len(campaign.state.readings)
    document = {"record": str(record), "branch": str(branch), "taken": found.taken, "readings": readings}
    taken_back = {"taken_back_there": list(found.undone), "taken_back_here": found.back}
    lines = [
        said(
            "{record}: {count} of {branch} taken over; it has {readings} now.",
            record=record,
            count=count_text(found.taken, "reading"),
            branch=branch,
            readings=readings,
        )
    ]
    if not found.taken:
        back = "{record}: {branch} has no reading that was not taken over before."
        here = "{record}: {branch} has no reading that is not here already."
        lines = [said(back if found.back else here, record=record, branch=branch)]
    if found.back:
        lines.append(
            counted(
                "{record}: {count} reading of it was taken over and taken back here since; --again takes it once more.",
                "{record}: {count} readings of it were taken over and taken back here since; --again takes them once "
                "more.",
                found.back,
                record=record,
            )
        )
    if found.undone:
        numbers = ", ".join(map(str, found.undone))
        lines.append(
            said(
                "The branch took back reading {numbers}, which stands here: axiscal step undo takes back what is last.",
                numbers=numbers,
            )
        )
    say_either(json, "axiscal-adopt/1", document | taken_back, lines)
