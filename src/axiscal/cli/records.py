"""`axiscal data copy`, `repair`, `merge` and `sign`."""

from __future__ import annotations

import sys
from contextlib import suppress
from functools import partial
from pathlib import Path

from axiscal.campaign.evidence import signed_text
from axiscal.campaign.possible import beginning_of, described
from axiscal.campaign.repairing import Repaired, repaired
from axiscal.cli.printing import agreed, say_either
from axiscal.cli.texts import opened_to_write
from axiscal.description.campaign import read_campaign
from axiscal.document.consent import asking
from axiscal.exceptions import CodeError, RecordError
from axiscal.language.spoken import capital, counted, said
from axiscal.record.signing import key_file, make_key
from axiscal.record.store import Record


def copy_record(record: Path, to: Path | None = None) -> None:
    """Copy a record, checked and whole."""
    beside = record.with_name(f"{record.name}.copy")
    target = beside if to is None else to / record.name if to.is_dir() else to
    log = Record.open(record, write=False)
    with suppress(CodeError), asking(None):
        described(log)  # checked
    log.copy_to(target)
    readings, last, name = len(log.state().readings), len(log.lines), log.name
    count = counted("{count} reading", "{count} readings", readings)
    document = {"copy": str(target), "readings": readings, "event": last, "hash": name}
    words = said(
        "{copy} holds {count}, up to event {last} of the record, {digest}.",
        copy=target,
        count=count,
        last=last,
        digest=name[:12],
    )
    say_either("axiscal-copy/1", document, [words])


def repair(
    record: Path,
    new: Path,
    beginning: Path | None = None,
    take: bool | None = None,
    campaign: str = "",
) -> None:
    """Make a new record of all that stands whole in a damaged one."""
    begun = None if beginning is None else beginning_of(read_campaign(beginning))
    _say(new, repaired([record], new, partial(_asked, take), beginning=begun, campaign=campaign))


def merge(record: Path, other: Path, new: Path, take: bool | None = None) -> None:
    """Make a new record of all that two copies of a record hold."""
    _say(new, repaired([record, other], new, partial(_asked, take)))


def _asked(take: bool | None, question: str) -> bool:
    if take is None and not sys.stdin.isatty():
        what = "Nobody is here to be asked: {question}"
        raise RecordError(what, "Say --take if they count, --leave if not", question=question)
    return agreed(f"{capital(question)}. {said('Do they count?')}") if take is None else take


def _say(new: Path, found: Repaired) -> None:
    document = {"record": str(new), "readings": len(found.state.readings), "events": found.entries}
    lists = {"missing": list(found.missing), "left_out": list(found.left)}
    readings = counted("{count} reading", "{count} readings", len(found.state.readings))
    events = counted("{count} event", "{count} events", found.entries)
    lines = [said("{new} holds {readings}, from {events} that stand whole.", new=new, readings=readings, events=events)]
    lines += [said("Missing: {words}.", words=words) for words in found.missing] or [said("Nothing is missing.")]
    lines += [said("Left out: {words}.", words=words) for words in found.left]
    if found.missing:
        lines.append(said("A missing event may have taken a reading back: look at those before it."))
    say_either("axiscal-repair/1", document | lists, lines)


def sign(record: Path) -> None:
    """Sign a record with your key."""
    make_key()
    with opened_to_write(record) as campaign:
        campaign.log.sign()
        found = campaign.log.signed()
        assert found is not None
        by = {name: getattr(found, name) for name in ("person", "computer", "key", "signature", "holds")}
        document = {"record": str(record), "event": found.number, **by}
        words = f"{record}: {signed_text(campaign.log)}. Public key: {found.key}. Keep {key_file()} to yourself."
        say_either("axiscal-signature/1", document, [words])
