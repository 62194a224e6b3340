"""An INI file of LinuxCNC as sections of keys, each with the line it stands in."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from axiscal.document.file import number_or_none
from axiscal.exceptions import DescriptionError
from axiscal.measurement.readers.text_file import read_text
from axiscal.units import shortened

_SECTION = re.compile(r"\[\s*(\w+)\s*\].*")
_KEY = re.compile(r"([^=\s]+)\s*=\s*(.*)")
_HEEDED = re.compile(r"|EMC|EMCMOT|TRAJ|KINS|HAL|(?:AXIS|JOINT)_\w+")
"""Sections that say something of the machine: LinuxCNC itself passes over lines of the others that mean nothing."""
_REMARK = re.compile(r"\s[#;].*")
_INCLUDE = re.compile(r"#INCLUDE[ \t]+(\S.*)")
"""In capitals, and in the file itself: what an included file includes LinuxCNC takes for a remark."""


@dataclass(frozen=True, slots=True)
class IniValue:
    """The value of a key, and the place where it stands."""

    text: str
    file: Path
    line: int

    def fail(self, what: str, remedy: str, **values: object) -> DescriptionError:
        """Return the error that places a fault here."""
        quoted = {name: shortened(value) if isinstance(value, str) else value for name, value in values.items()}
        return DescriptionError(what, remedy, self.file, self.line, **quoted)

    def number(self, key: str) -> float:
        """Return it as a finite number; raises DescriptionError.  key : that it stands behind"""
        value = number_or_none(self.text)
        if value is None:
            remedy = "Write digits with a decimal point"
            raise self.fail("{key} = {text} is not a number", remedy, key=key, text=self.text)
        return value


@dataclass(frozen=True, slots=True)
class IniFile:
    """An INI file.  values : of each key of each section in their order; LinuxCNC heeds the first of them"""

    path: Path
    values: dict[tuple[str, str], list[IniValue]] = field(default_factory=dict)

    def all(self, section: str, key: str) -> list[IniValue]:
        """Return every value of a key, in order."""
        return self.values.get((section, key), [])

    def get(self, section: str, key: str) -> IniValue | None:
        """Return the value that counts, None where there is none."""
        return next(iter(self.all(section, key)), None)

    def first(self, sections: Sequence[str], key: str) -> IniValue | None:
        """Return the value that counts in the first of these sections that has the key."""
        return next((found for section in sections if (found := self.get(section, key)) is not None), None)

    def place(self, *sections: str) -> tuple[Path, int | None]:
        """Return where the first of these sections that is there begins to say something; else the file."""
        first = (values[0] for (section, _), values in self.values.items() if section in sections)
        return next(((value.file, value.line) for value in first), (self.path, None))

    def needed(self, section: str, key: str, example: str) -> IniValue:
        """Return the value that counts; raises DescriptionError where there is none."""
        found = self.get(section, key)
        if found is None or not found.text:
            what, remedy = "[{section}] says no {key}", "Write it into the file, as in {key} = {example}"
            raise DescriptionError(what, remedy, *self.place(section), section=section, key=key, example=example)
        return found


def read_ini(path: Path) -> IniFile:
    """Return an INI file of LinuxCNC; raises ReadingError for no file, DescriptionError with the line that is none."""
    read = IniFile(path)
    section = ""
    for file, number, line in _lines(path):
        if found := _SECTION.fullmatch(line):
            section = found[1].upper()
        elif (key := _KEY.match(line)) is not None and section:
            value = IniValue(_REMARK.sub("", f" {key[2]}").strip(), file, number)
            read.values.setdefault((section, key[1].upper()), []).append(value)
        elif _HEEDED.fullmatch(section):
            shown = line if len(line) <= 40 else line[:37] + "..."
            what = "{shown!r} is neither a [SECTION] nor KEY = VALUE of a section"
            raise DescriptionError(what, "Give the INI file with which LinuxCNC starts", file, number, shown=shown)
    if not read.values:
        raise DescriptionError("No section of an INI file stands here", "Give the INI file of your LinuxCNC", path)
    return read


def _lines(path: Path, including: bool = True) -> Iterator[tuple[Path, int, str]]:
    """Yield file, number and text of every line that says something; lines that end in a backslash go on."""
    begun, first = "", 0
    for number, raw in enumerate(read_text(path).lines, start=1):
        line = raw.strip()
        if including and not begun and (included := _INCLUDE.fullmatch(line)):
            if not (other := path.parent / included[1]).is_file():
                what, remedy = "The file {name!r} that is included here is not there", "Copy it beside this one"
                raise DescriptionError(what, remedy, path, number, name=included[1])
            yield from _lines(other, including=False)
        elif line.endswith("\\") and not line.startswith(("#", ";")):
            begun, first = begun + line[:-1], first or number
        elif begun or (line and not line.startswith(("#", ";"))):
            yield path, first or number, begun + line
            begun, first = "", 0
