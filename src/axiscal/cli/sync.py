"""`axiscal shop sync` and `adopt`: a laptop and the store of a shop."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.campaign.adopting import adopted
from axiscal.cli.arguments import Json, RecordFile, own_record, records_here
from axiscal.cli.printing import say_either, tell
from axiscal.cli.texts import opened_to_write
from axiscal.language.spoken import counted, later, put, said
from axiscal.ports.postgres.database import Database, opened_database
from axiscal.ports.postgres.server_log import entries, only_entry
from axiscal.ports.postgres.syncing import Synced, set_aside, synced
from axiscal.ports.postgres.tables import ROLES, prepare, quarantined, refuse_other
from axiscal.record.copies import end_at, opened_log
from axiscal.record.log import STORED, campaign_of
from axiscal.record.store import Record


def sync(
    record: Annotated[
        Path | None,
        typer.Argument(metavar="RECORD", autocompletion=records_here, help="The record; default: the only one here."),
    ] = None,
    store: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="postgresql://USER@HOST/DATABASE; default: AXISCAL_STORE.")
    ] = None,
    name: Annotated[
        str | None, typer.Option(metavar="NAME", help="Of a campaign that is new there; default: that of the file.")
    ] = None,
    prepared: Annotated[
        bool, typer.Option("--prepare", help="Make the database a store: tables, triggers, roles. Once, as its owner.")
    ] = False,
    aside: Annotated[
        str | None,
        typer.Option("--quarantine", metavar="store:NAME:N", help="As its owner, set event N and all behind it aside."),
    ] = None,
    drop: Annotated[
        bool,
        typer.Option("--drop", help="Go on without what the store has set aside; all of it stays in a file beside."),
    ] = False,
    json: Json = False,
) -> None:
    """Bring a laptop's record and the shop's store together.

    Either may have gone on; no reading is lost. If both have gone on, the laptop's part becomes a branch, a campaign of
    its own. Nothing is merged. The laptop's later readings go there, too.

    \b
    Examples:
      axiscal shop sync --prepare --store postgresql://keeper@server/shop
      axiscal shop sync mill.axiscal
      axiscal shop sync --quarantine store:mill:17
    """
    database = opened_database(store)
    try:
        if prepared:
            new = prepare(database)
            text = "{address} is a store now." if new else "{address} is a store already."
            let_in = "Let people in: GRANT {write} TO anna; to read alone: GRANT {read} TO otto."
            words = put(
                "{state} {let_in}",
                state=said(text, address=database.address.shown),
                let_in=said(let_in, write=ROLES[1], read=ROLES[0]),
            )
            say_either(json, "axiscal-sync/1", {"store": database.address.shown, "prepared": new}, [words])
            return
        if aside is not None:
            _set_aside(database, aside, json)
            return
        path = record or own_record()
        if drop:
            _dropped(database, path)
        with Record.open(path) as opened:
            found = synced(database, opened, name or opened.path.stem)
            path, head = opened.path, opened.name
    finally:
        database.close()
    back = said(
        "Mind: the store had seen event {event} in {record}: it was set back or changed since.",
        event=found.set_back,
        record=path,
    )
    lines = [_words(path, found), *([back] if found.set_back else [])]
    document = {
        "record": str(path),
        "case": found.case,
        "campaign": found.campaign.id,
        "name": found.campaign.name,
        "branch_of": found.campaign.branch_of,
        "branch_at": found.campaign.branch_at,
        "sent": found.sent,
        "taken": found.taken,
        "set_back": found.set_back,
        "head": head,
    }
    say_either(json, "axiscal-sync/1", document, lines)


def _dropped(database: Database, path: Path) -> None:
    """Let a record end before what the store has set aside."""
    with Record.open(path, write=False) as record:
        texts = record.texts()
    if first := set_aside(database, campaign_of(texts[0]), texts):
        kept = end_at(path, first - 1)
        tell(said("{record} ends at event {last} now; all of it is in {kept}.", record=path, last=first - 1, kept=kept))


def _set_aside(database: Database, text: str, as_json: bool) -> None:
    name, _, first = text.removeprefix(STORED).rpartition(":")
    if not name or not (first.isascii() and first.isdigit()):
        raise typer.BadParameter(said("write it as store:NAME:N, N the first event"), param_hint="--quarantine")
    refuse_other(database)
    found = only_entry(name, entries(database, name))
    count = quarantined(database, found.id, int(first))
    words = said(
        "store:{name}: {events} from {first} on set aside; the database keeps them.",
        name=found.called,
        events=counted("{count} event", "{count} events", count),
        first=first,
    )
    say_either(as_json, "axiscal-sync/1", {"campaign": found.id, "name": found.name, "set_aside": count}, [words])


def _words(path: Path, found: Synced) -> str:
    sent, taken = (counted("{count} event", "{count} events", count) for count in (found.sent, found.taken))
    branch = said(
        "branch store:{branch} of store:{name}, from event {event}",
        branch=found.campaign.called,
        name=found.campaign.name,
        event=found.shared + 1,
    )
    taking = later("{record}: the record has {taken} more now, of {branch}.")
    sending = later("{record}: the store has {sent} more now, of {branch}.")
    words = {
        "new": later("{record}: new in the store as store:{name}, {sent}."),
        "ahead": later("{record}: the store had less, and has {sent} more now."),
        "behind": later("{record}: the store had more; the record has {taken} more now."),
        "same": later("{record}: the store has the same."),
        "fork": later("{record}: it and the store have each gone on. Nothing is merged: {sent} are kept as {branch}."),
        "fork again": later("{record}: the store has the same, as {branch}."),
    }.get(found.case, taking if found.taken else sending)
    return said(words, record=path, name=found.campaign.name, sent=sent, taken=taken, branch=branch)


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
            count=counted("{count} reading", "{count} readings", found.taken),
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
