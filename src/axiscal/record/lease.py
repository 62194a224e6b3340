"""Which computer writes to a record: a file beside it, made by O_EXCL, since locks do not reach over every share.

It names computer, process, time and person. Processes of one computer share it; locks of that computer order them. Each
entry renews it. Another computer may take it once it is old by the clock of the disk, or gone.
"""

from __future__ import annotations

import contextlib
import os
import uuid
from datetime import UTC, datetime
from pathlib import Path

from axiscal.document.durable import is_running
from axiscal.exceptions import RecordError
from axiscal.record.signing import own_hand

OLD = 60.0
"""Seconds without an entry after which another computer may write; a writer that is alive renews it with each entry."""
_TRIES = 5


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
                computer, process, since, person = _held(lease)
                if computer == mine and (process == os.getpid() or is_running(process)):
                    os.utime(lease)
                    return False
                if computer != mine and _age(lease) < OLD:
                    what = "{person} on {computer} has been writing to this record since {since}"
                    remedy = "Wait until that computer is done, or copy the record and bring both together: shop adopt"
                    shown = computer.rpartition(" ")[0]
                    raise RecordError(what, remedy, path, person=person, computer=shown, since=since) from None
                aside = lease.with_name(f"{lease.name}.{os.getpid()}")
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
        computer, process, *_ = _held(lease_of(path))
        if (computer, process) == (_computer(), os.getpid()):
            lease_of(path).unlink(missing_ok=True)


def _computer() -> str:
    """Return a name that no other computer has: its own, and the number of a network card."""
    return f"{own_hand().computer} {uuid.getnode():012x}"


def _held(lease: Path) -> tuple[str, int, str, str]:
    """Return computer, process, time and person; one that is being made is somebody else's."""
    lines = lease.read_text(encoding="utf-8", errors="replace").split("\n")
    if len(lines) < 5 or not lines[1].isdecimal():
        return "another computer ", 0, "now", "somebody"
    return lines[0], int(lines[1][:9]), lines[2], lines[3]


def _age(lease: Path) -> float:
    """Return the seconds since a file was renewed, by the clock of its disk."""
    probe = lease.with_name(f"{lease.name}.{os.getpid()}.now")
    probe.write_bytes(b"")
    now = probe.stat().st_mtime
    probe.unlink(missing_ok=True)
    return now - lease.stat().st_mtime
