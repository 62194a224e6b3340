"""A reader costs as much as its file is long: whatever stands in a line of 105,000 letters, no reader hangs at it."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from axiscal.description.ini_file import read_ini
from axiscal.description.printer_file import is_printer_file, of_printer
from axiscal.exceptions import InputError
from axiscal.measurement.readers.csv_readings import read_poses
from axiscal.measurement.readers.files import FORMATS, Format, recognised
from axiscal.measurement.readers.probe_offset import offset_in, sections_in, zero_of
from axiscal.measurement.readers.text_file import read_text
from axiscal.measurement.readers.touch_log import read_touch_log

LONG = 105_000
AGAIN = [
    " ",
    "\t",
    "\n",
    "1",
    "1 ",
    '"',
    "'",
    "(",
    "[",
    "{",
    ",",
    ", ",
    ";",
    "-",
    ".",
    "a ",
    "\0",
    "_",
    "\N{NO-BREAK SPACE}",
]
AGAIN += ["X1 ", "N1", "(1,", "[ ", "a/"]
AMONG = ["{}", "x{}x", "target_mm,{}deviation_um\n1,2\n", "a{}b,c\n1,2\n", "Axis{}X\nPos,1+\n1,2\n", "[bed_mesh{}x\n"]
AMONG += [
    "[include{}x",
    "HEADER::\nunits:x{}y\nFile type : x{}y\n",
    "#define{}Z_SAFE_HOMING_X_POINT 1",
]
PATIENCE = 400
"""s: in which it is through on a computer that others use; a reader that tries again what cannot help takes hours."""


def doors(file: Path) -> Iterator[Callable[[], object]]:
    """Yield what reads files: every format, whether it knows the file or not, and what else is read as text."""
    yield lambda: recognised(file)
    yield lambda: read_poses(file)
    yield lambda: read_ini(file)
    yield lambda: is_printer_file(file) and of_printer(file)
    yield lambda: read_touch_log(file)
    yield from (partial(_known, each, file) for each in FORMATS)
    yield lambda: zero_of(sections_in(file.read_text()) or {})
    yield lambda: offset_in(file.read_text())


def _known(each: Format, file: Path) -> bool:
    return each.knows(read_text(file))


def all_read(again: str) -> None:
    """Read all that is nasty in one way."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "readings.csv"
        for text in AMONG:
            file.write_text(text.replace("{}", (again * LONG)[:LONG]))
            for door in doors(file):
                try:
                    door()
                except InputError:
                    continue


@pytest.mark.parametrize(
    "again", [pytest.param(each, id=repr(each), marks=[pytest.mark.long] if each != " " else []) for each in AGAIN]
)
def test_no_line_hangs_a_reader(again: str) -> None:
    words = [sys.executable, "-c", f"from tests.measurement.test_nasty_lines import all_read; all_read({again!r})"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert (done.returncode, done.stderr) == (0, "")
