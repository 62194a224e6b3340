"""A campaign played in a folder of its own, each command in a process of its own.

Loading the package takes longer than most commands do: a worker loads it once, and each command is a fork of it.
"""

import os
import pkgutil
import platform
import shutil
import sys
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta, tzinfo
from importlib import import_module
from io import FileIO, TextIOWrapper
from pathlib import Path
from tempfile import TemporaryFile
from types import ModuleType
from typing import IO, NoReturn

from tests.golden.given import Command, Given

FIXED: Mapping[str, str] = {
    "COLUMNS": "120",
    "NO_COLOR": "1",
    "TERM": "dumb",
    "TZ": "UTC",
    "AXISCAL_PROGRESS": "off",
} | {
    "AXISCAL_PERSON": "Anna",
    "AXISCAL_KEY": f"{os.devnull}/none",
}
"""One width of the page, nothing that hangs on how fast the computer is, and nobody's key."""
_BEGUN = datetime(2026, 1, 5, 8, tzinfo=UTC)
"""When each campaign begins: a zero that wanders does so by the clock."""
_ALIKE = {
    "OPENBLAS_NUM_THREADS": "1",
    "OPENBLAS_CORETYPE": "Prescott",
    "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL AVX512_SPR",
}
"""A process with one thread can be forked; sums in the order that every processor can do, so that none breaks a tie."""
_LATE = ("scipy.linalg.lapack", "scipy.optimize", "scipy.sparse", "scipy.special", "typst")
"""What the package loads when it is used."""
_PYTHON = "3.11.0"
"""The version that records name: their chains hold it, and are the same with every other."""
_BROKEN = 70
"""Exit status of a command that did not come to its end."""


@dataclass(frozen=True, slots=True)
class Said:
    """What a command answered: its exit status and both streams."""

    command: Command
    status: int
    out: str
    err: str

    @property
    def as_expected(self) -> bool:
        """Whether it was done or refused as the campaign's page says."""
        return (self.status != 0) == self.command.refused and self.status in (0, 1, 2)


class _Clock(datetime):
    """A clock that stands still during a command, and shows a minute more at the next."""

    shown = _BEGUN

    @classmethod
    def now(cls, tz: tzinfo | None = None) -> datetime:  # type: ignore[override]
        return cls.shown.astimezone(tz)


def load() -> None:
    """Load all of the package, for commands to come; only what an optional package is for may be missing."""
    os.environ.update(_ALIKE)
    own = pkgutil.walk_packages(import_module("axiscal").__path__, "axiscal.")
    for name in [*(module.name for module in own if not module.name.endswith("__main__")), *_LATE]:
        with suppress(ImportError):
            import_module(name)


def played(campaign: Given, language: str, folder: Path) -> tuple[Said, ...]:
    """Return what the commands of a campaign answer; their files are in the folder, which is made.

    A document is the same in every language: commands that only print one are played in English.
    """
    shutil.copytree(campaign.folder, folder)
    commands = [each for each in campaign.commands if language == "en" or not each.only_prints_a_document]
    return tuple(_answer(command, number, language, folder) for number, command in enumerate(commands))


def _answer(command: Command, minutes: int, language: str, folder: Path) -> Said:
    with TemporaryFile() as out, TemporaryFile() as err:
        sys.stdout.flush()
        child = os.fork()
        if child == 0:
            _Clock.shown = _BEGUN + timedelta(minutes=minutes)
            _become(command, language, folder, out, err)
        _, status = os.waitpid(child, 0)
        return Said(command, os.waitstatus_to_exitcode(status), _text(out), _text(err))


def _become(command: Command, language: str, folder: Path, out: IO[bytes], err: IO[bytes]) -> NoReturn:
    """Be the process of a command, to its end."""
    status = _BROKEN
    try:
        os.chdir(folder)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.dup2(out.fileno(), 1)
        os.dup2(err.fileno(), 2)
        sys.stdin, sys.stdout, sys.stderr = (TextIOWrapper(FileIO(n, "rww"[n]), encoding="utf-8") for n in range(3))
        os.environ.update(FIXED, AXISCAL_LANGUAGE=language)
        os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", os.defpath)])
        time.tzset()
        platform.python_version = lambda: _PYTHON
        platform.node = lambda: "workshop"  # each entry names it
        for module in [each for name, each in sys.modules.items() if name.startswith("axiscal.")]:
            _wind(module)
        sys.argv = ["axiscal", *command.words]
        status = import_module("axiscal.cli").main()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def _wind(module: ModuleType) -> None:
    if getattr(module, "datetime", None) is datetime:
        module.datetime = _Clock  # type: ignore[attr-defined]


def _text(stream: IO[bytes]) -> str:
    stream.seek(0)
    return stream.read().decode("utf-8")
