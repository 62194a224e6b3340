"""The campaigns: a folder each, with the files a person would write and the commands a person would give."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path

CAMPAIGNS = Path(__file__).parent / "campaigns"
COMMANDS = "commands.txt"


@dataclass(frozen=True, slots=True)
class Command:
    """The words behind `axiscal`, and whether they are to be refused (a line that begins with `!`)."""

    words: tuple[str, ...]
    refused: bool = False

    @property
    def looks_at_the_clock(self) -> bool:
        """A person's readings and those of a program are taken when the clock says so."""
        return self.words[0] == "record" or any(word.startswith("exec:") for word in self.words)


@dataclass(frozen=True, slots=True)
class Scenario:
    """One campaign: its folder, and what is done there in turn."""

    folder: Path
    commands: tuple[Command, ...]

    @property
    def name(self) -> str:
        """The name of its folder."""
        return self.folder.name

    @property
    def inputs(self) -> frozenset[str]:
        """The names of the files that are there before the first command."""
        return frozenset(path.relative_to(self.folder).as_posix() for path in self.folder.rglob("*"))


def scenario(name: str) -> Scenario:
    """Return the campaign of that name; raises FileNotFoundError."""
    folder = CAMPAIGNS / name
    lines = [line.strip() for line in (folder / COMMANDS).read_text(encoding="utf-8").splitlines()]
    return Scenario(folder, tuple(_command(line) for line in lines if line and not line.startswith("#")))


def names() -> list[str]:
    """Return the names of all campaigns."""
    return sorted(path.parent.name for path in CAMPAIGNS.glob(f"*/{COMMANDS}"))


def _command(line: str) -> Command:
    return Command(tuple(shlex.split(line.removeprefix("!"))), refused=line.startswith("!"))
