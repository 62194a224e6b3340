"""What each file of a trade is read as, reviewed as text beside it in `trade_files.toml`."""

import json
import tempfile
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

from axiscal.measurement.readers.csv_readings import Around, RawReading
from axiscal.measurement.readers.files import recognised

HERE = Path(__file__).with_name("trade_files.toml")
ENDS = (0.0, 0.1), (0.0, 0.2)
"""m: where maps lie that do not say it."""


class TradeFile(NamedTuple):
    """A file.  title : begins with the page of codes in which it is saved, where that is not UTF-8"""

    title: str
    unit: str
    says: str
    text: str

    def read(self, folder: Path) -> str:
        """Return what it is read as."""
        page = self.title.partition(":")[0]
        path = folder / "file.txt"
        path.write_bytes(self.text.encode(page if page.startswith("cp") else "utf-8"))
        found = recognised(path, Around(ends=ENDS), self.unit)
        return "; ".join([found.sentence().partition(": ")[2], *map(_told, found.readings)])


FILES = [TradeFile(*row) for row in tomllib.loads(HERE.read_text(encoding="utf-8"))["files"]]


def _told(reading: RawReading) -> str:
    return " ".join(_words(reading))


def _words(reading: RawReading) -> Iterator[str]:
    """Yield line, place, sides, values and whatever else a reading says, in SI units."""
    yield f"{reading.line}:"
    rounding = {axis: f"~{half:.3g}" for axis, half in reading.rounding.items()}
    yield from (f"{axis}{at:.9g}{rounding.get(axis, '')}" for axis, at in reading.position.items())
    yield from (f"{axis}{side:+d}" for axis, side in reading.approach.items())
    yield f"= {' '.join(f'{value:.9g}' for value in (reading.value, *reading.others))} {reading.dimension}"
    for name in _BESIDE:
        if (value := getattr(reading, name)) or (name == "time" and value == 0.0):
            yield f"{name} {value}"


_BESIDE = ["std", "setup", "test", "run", "axis", "time", "number", "form", "error", "beside", "zero", "check"]


@pytest.mark.parametrize("file", FILES, ids=[file.title for file in FILES])
def test_a_file_of_a_trade_is_read_as_it_is_meant(tmp_path: Path, file: TradeFile) -> None:
    assert file.read(tmp_path) == file.says


if __name__ == "__main__":
    above = HERE.read_text(encoding="utf-8").partition("files = [\n")[0]
    with tempfile.TemporaryDirectory() as folder:
        rows = [file._replace(says=file.read(Path(folder))) for file in FILES]
    quoted = ([json.dumps(each, ensure_ascii=False) for each in row] for row in rows)
    told = "".join(f"  [{', '.join(before)},\n    {text}],\n" for *before, text in quoted)
    HERE.write_text(f"{above}files = [\n{told}]\n", encoding="utf-8")
