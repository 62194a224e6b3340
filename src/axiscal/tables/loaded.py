"""Compensation that was active on the control during the measurement, and new tables on top of it.

Readings with an active compensation show the residual error. So the full correction is the old one plus the new one.
The new one alone would bring back all that the old one took away.

Files of the compensation that was active while measuring, as a person names them: files, folders, an INI file.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from axiscal.description.ini_file import read_ini
from axiscal.description.ini_machine import unit_in
from axiscal.exceptions import InputError, TableError
from axiscal.measurement.readers.text_file import read_text
from axiscal.numerics import Array
from axiscal.tables.surface import PLANES, Control, Mesh, Skew, plane_axes
from axiscal.tables.table import CompensationTable
from axiscal_core.machine import Machine

_SECTION = re.compile(r"^\s*\[\w+\]", re.MULTILINE)
_JOINT = re.compile(r"(?:JOINT|AXIS)_(\d{1,2})")
_NAMED = re.compile(r"([A-Z][0-9]?)=(.+)")
_OTHERS = re.compile(r"README\.txt|manifest.*\.json")
"""Files of an export that no control loads."""
_TOO_LONG = re.compile(r"\d{61,}")
"""Digits in a row: a double has 17, and the zeros of a small one written out are fewer than the others."""


@dataclass(frozen=True, slots=True)
class OldFile:
    """One file, or what an INI file says of one joint.

    axis : that it is for, "" where its name has to say; joint : its number, None where nobody said
    file_type : COMP_FILE_TYPE, None where nobody said; backlash : of the joint, in the units of the machine
    unit : of lengths, as the INI file says, "" where none is named
    """

    name: str
    text: str
    axis: str = ""
    joint: int | None = None
    file_type: int | None = None
    backlash: float | None = None
    unit: str = ""


def refuse_long_numbers(text: str, name: str) -> None:
    """Raise TableError for the first line of a control's file with a number that is too long for any control."""
    found = _TOO_LONG.search(text)
    if found is not None:
        what, remedy = "a number of {count:,} digits is in no table", "give the file as the control saved it"
        raise TableError(what, remedy, name, text.count("\n", 0, found.start()) + 1, count=len(found[0]))


def read_old(names: Iterable[str], folder: Path = Path()) -> tuple[OldFile, ...]:
    """Return the files that were named: a file, AXIS=FILE, a folder of them, or the INI file of a LinuxCNC.

    folder : that relative names begin at.  Raises TableError, ReadingError.
    """
    found = list[OldFile]()
    for name in names:
        path, given = folder / name, _NAMED.fullmatch(name)
        if given and not path.exists():
            found.append(OldFile(given[2], _text(folder / given[2]), given[1]))
        elif path.is_dir():
            inside = sorted(each for each in path.iterdir() if each.is_file() and not _OTHERS.fullmatch(each.name))
            if not inside:
                raise TableError("there is no file in this folder", "name the old compensation", path)
            found += [OldFile(str(each), _text(each)) for each in inside]
        else:  # .INI may be of a SINUMERIK, too, whose tables are called so
            text = _text(path)
            of_joints = path.suffix.lower() == ".ini" and _SECTION.search(text)
            found += _joints(path) if of_joints else [OldFile(str(path), text)]
    return tuple(found)


def _text(path: Path) -> str:
    return "\n".join(read_text(path).lines)


def _joints(path: Path) -> Iterator[OldFile]:
    """Yield the tables and backlashes that an INI file of LinuxCNC makes active; a table goes before a backlash."""
    ini, active = read_ini(path), False
    unit, named = unit_in(ini, "LINEAR_UNITS"), (_JOINT.fullmatch(section) for section, _ in ini.values)
    for joint in dict.fromkeys(int(name[1]) for name in named if name):
        keys = "COMP_FILE", "COMP_FILE_TYPE", "BACKLASH"
        stated = [ini.first((f"JOINT_{joint}", f"AXIS_{joint}"), key) for key in keys]
        file, kind, backlash = (value if value is not None and value.text else None for value in stated)
        if file is not None:
            at, file_type = ini.path.parent / file.text, 0 if kind is None else int(kind.number("COMP_FILE_TYPE"))
            yield OldFile(str(at), _text(at), joint=joint, file_type=file_type, unit=unit)
        elif backlash is not None and (step := backlash.number("BACKLASH")):
            yield OldFile(f"{ini.path} [JOINT_{joint}]", "", joint=joint, backlash=step, unit=unit)
        else:
            continue
        active = True
    if not active:
        raise TableError("no joint of this INI file has a COMP_FILE or BACKLASH", "leave --on-top-of out", path)


_APART = 1e-9
"""m or rad: positions nearer than this are one, by their decimals."""


def lost_motion(machine: Machine, play: Mapping[str, float]) -> tuple[CompensationTable, ...]:
    """Return the tables that make up for what axes lose as they turn round, m or rad, half of it to each side."""
    travels = [(axis, np.array(machine.axis(axis).travel), np.full(2, lost / 2)) for axis, lost in play.items()]
    return tuple(CompensationTable(axis, ends, -half, half) for axis, ends, half in travels)


@dataclass(frozen=True, eq=False, slots=True)
class Loaded:
    """An old compensation as its control understood it.

    tables : what it takes away; meshes : height maps; skew : tangents by plane, as set; others : what does more
    untaken : entries that its reader has no use for, a failure each, with file and line
    """

    tables: tuple[CompensationTable, ...] = ()
    meshes: tuple[Mesh, ...] = ()
    skew: Skew = field(default_factory=dict)
    others: tuple[Control, ...] = ()
    untaken: tuple[InputError, ...] = ()

    def control(self, machine: Machine) -> Control:
        """Return what it adds to commands: away with what tables say and the skew, and heights."""
        known = [(machine.index(table.axis), machine.index(table.over), table) for table in self.tables]
        x, y, z = plane_axes(machine) if self.meshes or self.skew else (0, 0, 0)
        xy, xz, yz = (self.skew.get(plane, 0.0) for plane in PLANES)

        def control(poses: Array, approaches: Array) -> Array:
            added = np.zeros_like(poses)
            for axis, over, table in known:
                added[:, axis] -= table.deviation(poses[:, over], approaches[:, over])
            for mesh in self.meshes:
                added[:, z] += mesh.at(poses[:, x], poses[:, y])
            if self.skew:
                added[:, x] -= poses[:, y] * xy + poses[:, z] * (xz - xy * yz)
                added[:, y] -= poses[:, z] * yz
            for other in self.others:
                added += other(poses, approaches)
            return added

        return control

    def under_tables(
        self, tables: Sequence[CompensationTable], machine: Machine, most: int, *, even: bool = False
    ) -> tuple[CompensationTable, ...]:
        """Return tables with the old ones added; old ones of other axes follow as they are.

        most : points that fit; even : the points of a table stay evenly spaced
        """
        old, new = dict[tuple[str, str], list[CompensationTable]](), {(one.axis, one.over): one for one in tables}
        for one in self.tables:
            old.setdefault((one.axis, one.over), []).append(one)
        return tuple(_summed(new.get(kind), old.get(kind, []), machine, most, even) for kind in {**new, **old})


def _summed(
    table: CompensationTable | None, old: Sequence[CompensationTable], machine: Machine, most: int, even: bool
) -> CompensationTable:
    """Return a table with old ones added; where there is none, one that says nothing on the points of the finest."""
    if table is None:
        axis, over = old[0].axis, old[0].over
        at = max((one.positions for one in old), key=len)
        at = at if len(at) > 1 else np.array(machine.axis(over).travel)
        table = CompensationTable(axis, at, np.zeros(len(at)), np.zeros(len(at)), over=over)
    if not old:
        return table
    points = [one.positions for one in old if len(one.positions) > 1]
    at = np.unique(np.concatenate([table.positions, *points]))
    at = at[np.r_[True, np.diff(at) > _APART]]
    if len(at) > most or even or machine.axis(table.axis).cyclic:  # those of the finest that goes all the way
        ends = table.positions[0] + _APART, table.positions[-1] - _APART
        at = max([*(p for p in points if p[0] <= ends[0] and p[-1] >= ends[1]), table.positions], key=len)
        at = at if len(at) <= most else table.positions
    table = table.resampled(at)
    up, down = (np.sum([one.deviation(table.positions, side) for one in old], axis=0) for side in (1, -1))
    return replace(table, forward=table.forward + up, reverse=table.reverse + down)
