"""What a shell offers when Tab is pressed: commands, options, and the records that are here."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.long
@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("axiscal mea", ["measure"]),
        ("axiscal measure --la", ["--language"]),
        ("axiscal measure m", ["mill.axiscal"]),
        ("axiscal status ", ["lathe.axiscal", "mill.axiscal"]),
        ("axiscal machine ", ["list", "show", "check"]),
    ],
)
def test_it_completes(tmp_path: Path, typed: str, offered: list[str]) -> None:
    for name in ("lathe.axiscal", "mill.axiscal", "notes.txt"):
        (tmp_path / name).touch()
    asking = {"_AXISCAL_COMPLETE": "complete_bash", "COMP_WORDS": typed, "COMP_CWORD": str(len(typed.split(" ")) - 1)}
    done = subprocess.run(
        [sys.executable, "-m", "axiscal.cli"],
        cwd=tmp_path,
        env={**os.environ, **asking},
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stdout.split(), done.stderr) == (0, offered, "")
