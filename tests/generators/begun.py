"""Records that commands have begun, each made once: a test that goes on from there takes a copy and plans nothing."""

import os
import shutil
import tempfile
from collections.abc import Mapping
from contextlib import chdir, redirect_stderr, redirect_stdout
from functools import cache
from pathlib import Path

from axiscal.cli import app

Words = tuple[str, ...]


def begun(folder: Path, files: Mapping[str, str], *commands: Words) -> None:
    """Put into a folder what there is after these commands beside these files; a command that is refused is a fault.

    files : their texts by name
    """
    shutil.copytree(_made(tuple(files.items()), commands).name, folder, dirs_exist_ok=True)


@cache
def _made(files: tuple[tuple[str, str], ...], commands: tuple[Words, ...]) -> tempfile.TemporaryDirectory[str]:
    """Return the folder after these commands; those that begin alike share what the first of them did."""
    made = tempfile.TemporaryDirectory()
    if not commands:
        for name, text in files:
            Path(made.name, name).write_text(text)
        return made
    *before, words = commands
    shutil.copytree(_made(files, tuple(before)).name, made.name, dirs_exist_ok=True)
    with open(os.devnull, "w") as nowhere, chdir(made.name), redirect_stdout(nowhere), redirect_stderr(nowhere):
        assert app.run(words) == 0, words
    return made
