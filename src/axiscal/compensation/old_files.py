"""Files of the compensation that was active while measuring, as a person names them: files, folders, an INI file."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from axiscal.exceptions import TableError
from axiscal.measurement.readers.text import read_text

_SECTION = re.compile(r"\[(\w+)\]")
_KEY = re.compile(r"(\w+)\s*=\s*([^#;]*)")
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
        if path.suffix.lower() == ".ini" and any(_SECTION.match(line.strip()) for line in text.splitlines()):
            yield from _joints(path, text)
        else:  # of a SINUMERIK, too, whose tables are called .INI
            yield OldFile(str(path), text)


def _text(path: Path) -> str:
    return "\n".join(read_text(path).lines)


def _joints(path: Path, text: str) -> Iterator[OldFile]:
    """Yield the tables and backlashes that an INI file of LinuxCNC makes active; a table goes before a backlash."""
    sections: dict[int, dict[str, str]] = {}
    joint: int | None = None
    for line in text.splitlines():
        plain = line.strip()
        if section := _SECTION.match(plain):
            number = _JOINT.fullmatch(section[1])
            joint = int(number[1]) if number else None
        elif joint is not None and (key := _KEY.match(plain)):
            sections.setdefault(joint, {})[key[1]] = key[2].strip()
    found = [_joint(path, number, keys) for number, keys in sections.items()]
    if not any(found):
        raise TableError("no joint of this INI file has a COMP_FILE or BACKLASH", "leave --on-top-of out", path)
    yield from (file for file in found if file is not None)


def _joint(path: Path, joint: int, keys: dict[str, str]) -> OldFile | None:
    if name := keys.get("COMP_FILE"):
        at = path.parent / name
        return OldFile(str(at), _text(at), joint=joint, file_type=int(_number(path, keys, "COMP_FILE_TYPE")))
    backlash = _number(path, keys, "BACKLASH")
    return OldFile(f"{path} [JOINT_{joint}]", "", joint=joint, backlash=backlash) if backlash else None


def _number(path: Path, keys: dict[str, str], key: str) -> float:
    """Return the number behind a key, 0 where there is none; raises TableError."""
    try:
        number = float(keys.get(key) or 0)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise TableError(f"{key} = {keys[key][:40]!r} is no number", f"Write one, as in {key} = 0", path)
    return number
