"""Where a printer finds the zero of Z, as its own files say. A mesh is zero there, for the printer homes without it."""

from __future__ import annotations

import re
from math import floor, hypot
from pathlib import Path

from axiscal.exceptions import ReadingError
from axiscal.measurement.readers.probe_offset import Beside, Sections, offset_in, offset_of, pair_of, sections_in
from axiscal.measurement.readers.text_file import read_text
from axiscal.units import parse_quantity

_MOST, _ROUNDING = 1000, 1e-9
"""Nodes along a side; m or steps, which is none."""
Place = Beside
"""X and Y, m."""
_WORD = re.compile(r"([XY])(-?[\d.]+|\S*)")
_HOMES = re.compile(r"G28\b(?!.*[XY])|G28\b.*Z|G30\b(?!.*[PS])")
"""What homes Z: G28 of every axis or of Z, and G30 of RepRapFirmware that neither levels (P) nor reports (S)."""
_DEFINED = re.compile(r"^[^\S\n]*+#define\s+Z_SAFE_HOMING_([XY])_POINT\s+([^\s/]+)", re.MULTILINE)
_BY_PROBE = "probe:z_virtual_endstop"
_MARKS = str.maketrans("", "", "[]'\" ")
"""Around the numbers of a place in an answer of Moonraker."""


def zero_by(text: str, aside: Place = (0.0, 0.0)) -> Place:
    """Return the place that somebody states, such as "150 mm, 150 mm", or a file; raises ReadingError, UnitError.

    aside : of the probe from the nozzle, m, where the file does not say it
    """
    if Path(text).is_file():
        found = zero_in("\n".join(read_text(text).lines), aside)
        if found is None:
            raise ReadingError("this file states no place where Z is homed", 'write --zero "150 mm, 150 mm"', text)
        return found
    x, _, y = text.partition(",")
    return parse_quantity(x.strip(), "length"), parse_quantity(y.strip(), "length")


def zero_in(text: str, aside: Place = (0.0, 0.0)) -> Place | None:
    """Return the place that a printer.cfg, a homez.g or a Configuration.h of Marlin states, None where none does."""
    if defined := dict(_DEFINED.findall(text)):
        return pair_of(defined.get(side) for side in "XY")
    sections = sections_in(text)
    return homed_at(text, offset_in(text) or aside) if sections is None else zero_of(sections)


def zero_of(sections: Sections) -> Place | None:
    """Return where a Klipper of this configuration has its zero: the stated place, or where its probe homes Z.

    The probe stands beside the nozzle by its offset. A switch that homes Z says nothing of a place on the bed.
    """
    stated = _pair(sections, "bed_mesh", "zero_reference_position") or _of_index(sections)
    if stated is not None or _option(sections, "stepper_z", "endstop_pin").translate(_MARKS) != _BY_PROBE:
        return stated
    aside = offset_of(sections) or (0.0, 0.0)
    home = _pair(sections, "safe_z_home", "home_xy_position")
    if home is not None:
        return home[0] + aside[0], home[1] + aside[1]
    return homed_at(_option(sections, "homing_override", "gcode"), aside)


def _of_index(sections: Sections) -> Place | None:
    """Return the node of a mesh that an older Klipper makes zero: nodes are counted along X, there and back.

    As in its bed_mesh.py, distances of nodes are cut to 0.01 mm, and on a round bed those beyond its radius left out.
    """
    index, radius = (_option(sections, "bed_mesh", key) for key in ("relative_reference_index", "mesh_radius"))
    if not index.isdecimal():
        return None
    origin = (_pair(sections, "bed_mesh", "mesh_origin") if radius else None) or (0.0, 0.0)
    low, high = (_pair(sections, "bed_mesh", f"mesh_{end}") for end in ("min", "max"))
    if far := pair_of((radius, radius)):
        low, high = (-far[0], -far[1]), far
    said = _option(sections, "bed_mesh", "round_probe_count" if radius else "probe_count") or ("5" if radius else "3")
    counts = [int(each) for each in said.translate(_MARKS).split(",") if each.isdecimal() and 1 < int(each) <= _MOST]
    if low is None or high is None or not counts:
        return None
    nodes = list[Place]()
    steps = [floor((high[k] - low[k]) * 1e5 / (counts[k % len(counts)] - 1) + _ROUNDING) / 1e5 for k in (0, 1)]
    if far:
        low = -(counts[0] // 2) * steps[0], -(counts[0] // 2) * steps[0]
    for row in range(counts[-1]):
        along = range(counts[0]) if row % 2 == 0 else reversed(range(counts[0]))
        places = ((low[0] + column * steps[0], low[1] + row * steps[1]) for column in along)
        nodes += [place for place in places if not far or hypot(*place) <= far[0] + _ROUNDING]
    at = int(index)
    return (origin[0] + nodes[at][0], origin[1] + nodes[at][1]) if at < len(nodes) else None


def homed_at(code: str, aside: Place) -> Place | None:
    """Return where G-code homes Z, None where it does not say.  aside : of the probe from the nozzle, m"""
    at, relative = {"X": "", "Y": ""}, False
    for line in (each.partition(";")[0].strip().upper() for each in code.splitlines()):
        if _HOMES.match(line):
            at |= dict(_WORD.findall(line))
            home = pair_of(at.values())
            return None if home is None else (home[0] + aside[0], home[1] + aside[1])
        relative = line.startswith("G91") or (relative and not line.startswith("G90"))
        if re.match(r"G[01]\b", line):
            at |= {side: "" if relative else value for side, value in _WORD.findall(line)}
    return None


def _pair(sections: Sections, section: str, key: str) -> Place | None:
    return pair_of(_option(sections, section, key).translate(_MARKS).split(","))


def _option(sections: Sections, section: str, key: str) -> str:
    return str(sections[section].get(key) or "") if section in sections else ""
