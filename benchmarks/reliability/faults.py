"""Faults at every call that changes a disk: the process is killed there, or the call fails, or writes a part.

Work is done in a forked process, in which the functions of `os` that change files count their calls.
"""

from __future__ import annotations

import builtins
import errno
import io
import os
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from axiscal.exceptions import AxiscalError
from benchmarks.reliability.trial import Say, forked

CALLS = ("write", "fsync", "fdatasync", "replace", "rename", "link", "unlink", "mkdir", "rmdir", "ftruncate")
KILLED = 77


@dataclass(frozen=True, slots=True)
class Fault:
    """At which call, from 1, and how: kill, part (half is written, then a kill), full (ENOSPC) or broken (EIO)."""

    at: int
    how: str


HOWS = ("kill", "part", "full", "broken")


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of the work: what it said before its end, and whether the fault was met."""

    said: tuple[str, ...]
    met: bool


def faults(
    before: Path, folder: Path, work: Callable[[Path, Say], None], every: int = 1, hows: Sequence[str] = HOWS
) -> Iterator[tuple[Fault, Outcome]]:
    """Do the work in `folder`, each time begun as a copy of `before`, once for each fault; yield what it left there.

    every : only at each so manieth call, another one for each kind of fault
    """
    for begin, how in enumerate(hows):
        at, met = 1 - every + begin % every, True
        while met:
            at += every
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(before, folder)
            outcome = _worked(folder, work, Fault(at, how))
            met = outcome.met
            if met:
                yield Fault(at, how), outcome


def _worked(folder: Path, work: Callable[[Path, Say], None], fault: Fault) -> Outcome:
    said = forked(partial(_tried, folder, work, fault)).lines()
    return Outcome(tuple(line for line in said if line != "met"), "met" in said)


def _tried(folder: Path, work: Callable[[Path, Say], None], fault: Fault, say: Say) -> None:
    try:
        with _faulty(fault, say):
            work(folder, say)
    except (OSError, AxiscalError) as failure:
        say(f"raised {type(failure).__name__}: {failure}")


@contextmanager
def _faulty(fault: Fault, say: Say) -> Iterator[None]:
    count = 0

    def counted(name: str, call: Callable[..., Any]) -> Callable[..., Any]:
        def called(*arguments: Any, **options: Any) -> Any:
            nonlocal count
            count += 1
            if count != fault.at:
                return call(*arguments, **options)
            say("met")
            if fault.how in ("full", "broken"):
                code = errno.ENOSPC if fault.how == "full" else errno.EIO
                raise OSError(code, os.strerror(code))
            if fault.how == "part" and name == "write":
                call(arguments[0], bytes(arguments[1])[: len(arguments[1]) // 2])
            os._exit(KILLED)

        return called

    def opened(file: Any, mode: str = "r", *arguments: Any, **options: Any) -> Any:
        changes = not isinstance(file, int) and set(mode) & set("wax+")  # a handle is of what is open already
        return (open_to_write if changes else open_as_it_is)(file, mode, *arguments, **options)

    open_as_it_is, open_to_write = io.open, counted("open", io.open)
    io.open = builtins.open = opened
    for name in CALLS:
        setattr(os, name, counted(name, getattr(os, name)))
    yield
