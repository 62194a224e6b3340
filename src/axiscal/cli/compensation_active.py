"""Whether a compensation is active while measuring: said by campaign.toml, an option, or somebody at a terminal."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from axiscal.cli.printing import tell
from axiscal.description.campaign import CampaignDescription, with_compensation
from axiscal.exceptions import DescriptionError, InputError
from axiscal.tables.old_files import read_old
from axiscal.tables.on_top import unasked

Active = Annotated[
    list[str] | None,
    typer.Option(
        "--compensation-active",
        metavar="WHAT",
        help="Whether a compensation is active on the control while it is measured: false, true, or its files; "
        "repeatable. For a campaign.toml that does not say.",
    ),
]
_WORDS = {"false": False, "no": False, "n": False, "true": True, "yes": True, "y": True}


def answered(description: CampaignDescription, said: Sequence[str] | None, *, asking: bool) -> CampaignDescription:
    """Return the campaign with the statement of an active compensation; the record then carries it.

    asking : somebody may be asked, where a terminal is there and nothing was said
    Raises DescriptionError where two things are said, TableError or ReadingError for files that cannot be read.
    """
    if said:
        meant, written = _meant(said), description.compensation_active
        if written is None:
            return with_compensation(description, meant)
        if meant != (written if isinstance(written, bool) else _beside(written, description)):
            what = "compensation_active is in campaign.toml and on the command line, and they do not say the same"
            raise DescriptionError(what, "Leave one of them out")
        return description
    question = unasked(description)
    if question and asking and sys.stdin.isatty() and sys.stderr.isatty():
        return _asked(description, question)
    return description


def _asked(description: CampaignDescription, question: str) -> CampaignDescription:
    """Return the campaign with the answer of somebody at a terminal; an empty line leaves it open."""
    tell(question)
    while True:
        tell("Write false, true, or the names of its files; an empty line where nobody knows:")
        words = sys.stdin.readline().split()
        if not words:
            return description
        try:
            return with_compensation(description, _meant(words))
        except InputError as failure:
            tell(str(failure))


def _meant(words: Sequence[str]) -> bool | tuple[str, ...]:
    """Return what is meant by words: no, yes, or files, which are looked at now and named from the root on."""
    if len(words) == 1 and words[0].casefold() in _WORDS:
        return _WORDS[words[0].casefold()]
    read_old(words)
    return tuple(_whole(word) for word in words)


def _beside(written: Sequence[str], description: CampaignDescription) -> tuple[str, ...]:
    """Return the files that campaign.toml names, from the root on."""
    return tuple(_whole(word, Path(description.source).parent) for word in written)


def _whole(word: str, folder: Path = Path()) -> str:
    """Return a name, or AXIS=FILE, with the file as it is found from anywhere.  folder : where names begin"""
    if (folder / word).exists():
        return str((folder / word).resolve())
    axis, _, file = word.partition("=")
    return f"{axis}={(folder / file).resolve()}"
