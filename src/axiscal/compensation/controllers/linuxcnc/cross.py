"""Straightness, sag and squareness for LinuxCNC: HAL text that moves an axis by the position of another.

`COMP_FILE` knows one axis only. Between motion and drives HAL can add any function of one position: a `lincurve` of 16
points and a `sum2` for each pair, and the same taken off the feedback, so that LinuxCNC does not see it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from axiscal.compensation.table import CompensationTable
from axiscal.exceptions import TableError
from axiscal.units import to_unit

POINTS = 16
_HEAD = """# Made by axiscal: moves {moved} by the positions of other axes (straightness, sag, squareness).
# Source this file after motion has been loaded and its functions added. Then send the drive of each axis here what
# axiscal-<axis>-motor holds instead of its motor-pos-cmd, and net its position feedback to axiscal-<axis>-encoder
# instead of joint.N.motor-pos-fb. If your files load lincurve or sum2 already, join the names into one loadrt.
"""


def write(tables: Sequence[CompensationTable], joints: Mapping[str, int], unit: str = "mm") -> str:
    """Return the HAL text.

    tables : over other axes, 16 points at most; joints : number of the joint of each axis; unit : of the machine
    Raises TableError.
    """
    if not tables:
        return ""
    for table in tables:
        _refuse_what_it_cannot_hold(table, joints)
    moved = list(dict.fromkeys(table.axis for table in tables))
    names = [_name(table) for table in tables]
    lines = [_HEAD.format(moved=", ".join(moved)).rstrip()]
    lines.append(f"loadrt lincurve names={','.join(f'cross-{n}' for n in names)} personality={_sizes(tables)}")
    lines.append(f"loadrt sum2 names={','.join(f'{end}-{n}' for end in ('cmd', 'fb') for n in names)}")
    for table in tables:
        lines += _curve(table, unit)
    for over in dict.fromkeys(table.over for table in tables):
        curves = " ".join(f"cross-{_name(t)}.in" for t in tables if t.over == over)
        lines.append(f"net axiscal-{over.lower()}-position joint.{joints[over]}.pos-cmd => {curves}")
    for axis in moved:
        lines += _chain(axis, joints[axis], [_name(t) for t in tables if t.axis == axis])
    return "\n".join(lines) + "\n"


def _refuse_what_it_cannot_hold(table: CompensationTable, joints: Mapping[str, int]) -> None:
    name = f"{table.axis} over {table.over}"
    if len(table.positions) > POINTS:
        raise TableError(f"the table of {name} has {len(table.positions)} points, a lincurve holds {POINTS}", _FITS)
    for axis in (table.axis, table.over):
        if axis not in joints or len(axis) != 1:
            raise TableError(f"{axis} has no joint in LinuxCNC", f"Give its number; known are {', '.join(joints)}")


_FITS = f"{POINTS} points fit: set them further apart"


def _sizes(tables: Sequence[CompensationTable]) -> str:
    return ",".join(str(len(table.positions)) for table in tables)


def _name(table: CompensationTable) -> str:
    return f"{table.axis.lower()}-{table.over.lower()}"


def _curve(table: CompensationTable, unit: str) -> list[str]:
    """Return the lines that fill a lincurve: minus the deviation, both directions alike."""
    name = f"cross-{_name(table)}"
    added = -np.asarray(to_unit((table.forward + table.reverse) / 2, "deg" if table.rotary else unit))
    rows = enumerate(zip(to_unit(table.positions, unit), added + 0.0, strict=True))
    lines = [f"addf {name} servo-thread"]
    for i, (x, y) in rows:
        lines += [f"setp {name}.x-val-{i:02d} {x:.6f}", f"setp {name}.y-val-{i:02d} {y:.7f}"]
    return lines


def _chain(axis: str, joint: int, names: list[str]) -> list[str]:
    """Return the lines that add every curve to the command of a joint, and take it off the feedback."""
    low = axis.lower()
    lines = []
    ends = (("cmd", f"joint.{joint}.motor-pos-cmd", f"axiscal-{low}-motor"), ("fb", "", f"axiscal-{low}-seen"))
    for end, source, last in ends:
        signal = f"axiscal-{low}-start" if end == "cmd" else f"axiscal-{low}-encoder"
        lines.append(f"net {signal} {source + ' => ' if source else ''}{end}-{names[0]}.in0")
        for i, name in enumerate(names):
            following = f" => {end}-{names[i + 1]}.in0" if i + 1 < len(names) else ""
            signal = f"axiscal-{low}-{end}-{i}" if following else last
            lines += [f"addf {end}-{name} servo-thread", f"net {signal} {end}-{name}.out{following}"]
            lines += [f"setp {end}-{name}.gain1 -1"] if end == "fb" else []
    lines += [f"net axiscal-{name} cross-{name}.out => cmd-{name}.in1 fb-{name}.in1" for name in names]
    lines.append(f"net axiscal-{low}-seen => joint.{joint}.motor-pos-fb")
    return lines
