"""Which computer writes to a record: a file beside it, made by O_EXCL, since locks do not reach over every share.

It names computer, process, time and person. Processes of one computer share it; locks of that computer order them. Each
entry renews it. Another computer may take it once it is old by the clock of the disk, or gone.
"""

from __future__ import annotations

import contextlib
import os
import time
import uuid
from datetime import UTC, datetime
from pathlib import Path

from axiscal.document.durable import draft_of, is_running
from axiscal.exceptions import RecordError
from axiscal.record.signing import own_hand

OLD = 60.0
"""Seconds without an entry after which another computer may write; a writer that is alive renews it with each entry."""
_MAKING = 2.0
"""Seconds in which whoever makes a lease writes into it; a kill may have come between."""
_TRIES, _NAP = 60, 0.05
"""Looks, and seconds between two of them while a lease is made: a little more than that takes."""


def lease_of(path: Path) -> Path:
    """Return the file that says which computer writes to a record."""
    return path.with_name(f".{path.name}.writer")


def take(path: Path) -> bool:
    """Let this computer write to a record, and return whether that is new; raises RecordError, OSError."""
    lease, mine = lease_of(path), _computer()
    for _ in range(_TRIES):
        try:
            handle = os.open(lease, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
        except FileExistsError:
            with contextlib.suppress(FileNotFoundError):
                if (held := _held(lease)) is None and _age(path) < _MAKING:
                    time.sleep(_NAP)
                    continue
                computer, process, since, person = held or ("", 0, "", "")
                if computer == mine and (process == os.getpid() or is_running(process)):
                    os.utime(lease)
                    return False
                if held is not None and computer != mine and _age(path) < OLD:
                    what = "{person} on {computer} has been writing to this record since {since}"
                    remedy = "Wait until that computer is done"
                    shown = computer.rpartition(" ")[0]
                    raise RecordError(what, remedy, path, person=person, computer=shown, since=since) from None
                aside = draft_of(path).with_suffix(".old")  # which the next writer clears away after a kill
                os.rename(lease, aside)  # of several only one can
                aside.unlink(missing_ok=True)
        else:
            with open(handle, "w", encoding="utf-8") as file:
                file.write(f"{mine}\n{os.getpid()}\n{datetime.now(UTC):%Y-%m-%d %H:%M} UTC\n{own_hand().person}\n")
            return True
    raise RecordError("Several computers begin to write to this record at once", "Give the command again", path)


def leave(path: Path) -> None:
    """Let other computers write, where this process has the lease."""
    with contextlib.suppress(OSError):
        held = _held(lease_of(path))
        if held is not None and held[:2] == (_computer(), os.getpid()):
            lease_of(path).unlink(missing_ok=True)


def _computer() -> str:
    """Return a name that no other computer has: its own, and the number of a network card."""
    return f"{own_hand().computer} {uuid.getnode():012x}"


def _held(lease: Path) -> tuple[str, int, str, str] | None:
    """Return computer, process, time and person; None of one that is being made."""
    lines = lease.read_text(encoding="utf-8", errors="replace").split("\n")
    if len(lines) < 5 or not lines[1].isdecimal():
        return None
    return lines[0], int(lines[1][:9]), lines[2], lines[3]


def _age(path: Path) -> float:
    """Return the seconds since the lease of a record was renewed, by the clock of the disk."""
    probe = draft_of(path)
    probe.write_bytes(b"")
    now = probe.stat().st_mtime
    probe.unlink(missing_ok=True)
    return now - lease_of(path).stat().st_mtime
