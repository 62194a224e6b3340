"""`axiscal shop adopt`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.campaign.adopting import Adopted, adopted
from axiscal.cli.arguments import Json, RecordFile
from axiscal.cli.opened import opened_to_write
from axiscal.cli.printing import say_either
from axiscal.cli.texts import count_text
from axiscal.record.opening import opened_log


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
        raise typer.BadParameter("Say --same-mounting or --mounted-anew, not both.")
    with opened_to_write(record) as campaign, opened_log(record, write=False) as own:
        with opened_log(branch, write=False) as other:
            found = adopted(campaign, own, other, same_mounting, again, mounted_anew)
        readings = len(campaign.state.readings)
    document = {"record": str(record), "branch": str(branch), "taken": found.taken, "readings": readings}
    taken_back = {"taken_back_there": list(found.undone), "taken_back_here": found.back}
    say_either(json, "axiscal-adopt/1", document | taken_back, _lines(record, branch, found, readings))


def _lines(record: Path, branch: Path, found: Adopted, readings: int) -> list[str]:
    lines = [f"{record}: {count_text(found.taken, 'reading')} of {branch} taken over; it has {readings} now."]
    if not found.taken:
        which = "was not taken over before" if found.back else "is not here already"
        lines = [f"{record}: {branch} has no reading that {which}."]
    if found.back:
        said = "was" if found.back == 1 else "were"
        lines.append(
            f"{record}: {count_text(found.back, 'reading')} of it {said} taken over and taken back here since; --again "
            f"takes {'it' if found.back == 1 else 'them'} once more."
        )
    if found.undone:
        numbers = ", ".join(map(str, found.undone))
        lines.append(
            f"The branch took back reading {numbers}, which stands here: axiscal undo takes back what is last."
        )
    return lines
