"""Files of the compensation that was active while measuring, as a person names them: files, folders, an INI file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from axiscal.description.ini_file import IniFile, IniValue, read_ini
from axiscal.exceptions import TableError
from axiscal.measurement.readers.text import read_text

_SECTION = re.compile(r"^\s*\[\w+\]", re.MULTILINE)
_JOINT = re.compile(r"(?:JOINT|AXIS)_(\d+)")
_NAMED = re.compile(r"([A-Z][0-9]?)=(.+)")
_OTHERS = re.compile(r"README\.txt|manifest.*\.json")
"""Files of an export that no control loads."""


@dataclass(frozen=True, slots=True)
class OldFile:
    """One file, or what an INI file says of one joint.

    axis : that it is for, "" where its name has to say; joint : its number, None where nobody said
    file_type : COMP_FILE_TYPE, None where nobody said; backlash : of the joint, in the units of the machine
    """

    name: str
    text: str
    axis: str = ""
    joint: int | None = None
    file_type: int | None = None
    backlash: float | None = None

    @property
    def stem(self) -> str:
        """The name of the file without folder and ending."""
        return Path(self.name).stem


def read_old(names: Iterable[str], folder: Path = Path()) -> tuple[OldFile, ...]:
    """Return the files that were named: a file, AXIS=FILE, a folder of them, or the INI file of a LinuxCNC.

    folder : that relative names begin at.  Raises TableError, ReadingError.
    """
    return tuple(file for name in names for file in _named(name, folder))


def _named(name: str, folder: Path) -> Iterator[OldFile]:
    path = folder / name
    given = _NAMED.fullmatch(name)
    if given and not path.exists():
        yield OldFile(given[2], _text(folder / given[2]), given[1])
    elif path.is_dir():
        found = sorted(each for each in path.iterdir() if each.is_file() and not _OTHERS.fullmatch(each.name))
        if not found:
            raise TableError("there is no file in this folder", "name the old compensation", path)
        yield from (OldFile(str(each), _text(each)) for each in found)
    else:
        text = _text(path)
        if path.suffix.lower() == ".ini" and _SECTION.search(text):
            yield from _joints(path)
        else:  # of a SINUMERIK, too, whose tables are called .INI
            yield OldFile(str(path), text)


def _text(path: Path) -> str:
    return "\n".join(read_text(path).lines)


def _joints(path: Path) -> Iterator[OldFile]:
    """Yield the tables and backlashes that an INI file of LinuxCNC makes active; a table goes before a backlash."""
    ini = read_ini(path)
    named = (_JOINT.fullmatch(section) for section, _ in ini.values)
    found = [_joint(ini, number) for number in dict.fromkeys(int(name[1]) for name in named if name)]
    if not any(found):
        raise TableError("no joint of this INI file has a COMP_FILE or BACKLASH", "leave --on-top-of out", path)
    yield from (file for file in found if file is not None)


def _joint(ini: IniFile, joint: int) -> OldFile | None:
    def stated(key: str) -> IniValue | None:
        value = ini.first((f"JOINT_{joint}", f"AXIS_{joint}"), key)
        return value if value is not None and value.text else None

    if (name := stated("COMP_FILE")) is not None:
        at, kind = ini.path.parent / name.text, stated("COMP_FILE_TYPE")
        file_type = 0 if kind is None else int(kind.number("COMP_FILE_TYPE"))
        return OldFile(str(at), _text(at), joint=joint, file_type=file_type)
    backlash = stated("BACKLASH")
    step = 0.0 if backlash is None else backlash.number("BACKLASH")
    return OldFile(f"{ini.path} [JOINT_{joint}]", "", joint=joint, backlash=step) if step else None
