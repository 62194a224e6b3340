"""The campaigns: a folder each, with the files a person would write and the commands a person would give."""

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
    def only_prints_a_document(self) -> bool:
        """Whether it says nothing in words and leaves nothing behind."""
        return self.words[0] in ("plan", "predict") and "--json" in self.words and "--out" not in self.words


@dataclass(frozen=True, slots=True)
class Given:
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


def given(name: str) -> Given:
    """Return the campaign of that name; raises FileNotFoundError."""
    folder = CAMPAIGNS / name
    lines = [line.strip() for line in (folder / COMMANDS).read_text(encoding="utf-8").splitlines()]
    return Given(folder, tuple(_command(line) for line in lines if line and not line.startswith("#")))


def names() -> list[str]:
    """Return the names of all campaigns."""
    return sorted(path.parent.name for path in CAMPAIGNS.glob(f"*/{COMMANDS}"))


def _command(line: str) -> Command:
    return Command(tuple(shlex.split(line.removeprefix("!"))), refused=line.startswith("!"))
