"""Where the probe of a 3D printer stands beside its nozzle, and where its mesh is zero, as its own files say.

Klipper: `x_offset` and `y_offset` of [probe], [bltouch] and their kin, in answers of Moonraker, too. Marlin: `M851`.
RepRapFirmware: `G31`. All count from the nozzle to the probe. A mesh is
zero where the printer homes Z, for it homes without the mesh.
"""

from __future__ import annotations

import configparser
import json
import re
from collections.abc import Iterable, Mapping
from contextlib import suppress
from math import floor, hypot
from typing import Any

from axiscal.document.file import number_or_none
from axiscal.units import from_unit, parse_quantity

Beside = tuple[float, float]
"""X and Y, m."""
_BY_PROBE = "probe:z_virtual_endstop"
_MARKS = str.maketrans("", "", "[]'\" ")
"""Around the numbers of a place in an answer of Moonraker."""
_MOST, _ROUNDING = 1000, 1e-9
"""Nodes along a side; m or steps, which is none."""
Sections = Mapping[str, Mapping[str, str]]
UNTWISTED = ("z_compensations", "zy_compensations")
"""By these keys of [axis_twist_compensation] Klipper makes heights those that the nozzle itself would touch."""
_COMMAND = re.compile(r"^[^;\n]*?\b(?:M851|G31)\b([^;\n]*)", re.MULTILINE)
_WORD = re.compile(r"\b([XY])(-?[\d.]+)")


def objects_in(text: str) -> list[dict[str, Any]]:
    """Return every object of a JSON text, inner ones last, with numbers as texts; none of another text."""
    found = list[dict[str, Any]]()

    def collected(held: dict[str, Any]) -> dict[str, Any]:
        found.append(held)
        return held

    with suppress(ValueError, RecursionError):
        json.loads(text, object_hook=collected, parse_float=str, parse_int=str, parse_constant=str)
        return found[::-1]
    return []


def sections_in(text: str) -> Sections | None:
    """Return the sections of a printer.cfg, those that Klipper saved among them; None where the text has none.

    In an answer of Moonraker they are those of `configfile`, or the offsets of `dump_mesh`.
    """
    if answered := objects_in(text):
        found = dict[str, dict[str, str]]()
        for each in reversed(answered):
            if isinstance(aside := each.get("probe_offsets"), list):
                found["probe"] = dict(zip(("x_offset", "y_offset"), aside, strict=False))
            settings = each.get("settings")
            for name, keys in settings.items() if isinstance(settings, dict) else ():
                if isinstance(keys, dict):
                    found[name] = {key: str(value or "") for key, value in keys.items()}
        return found
    config = configparser.RawConfigParser(strict=False, inline_comment_prefixes=("#", ";"), allow_no_value=True)
    try:
        config.read_string(text.replace("#*# ", "").replace("#*#", ""))
    except (configparser.Error, AttributeError):  # G-code has no sections; Python fails at lines behind a bare key
        return None
    return {name: {key: value or "" for key, value in config[name].items()} for name in config.sections()}


def offset_of(sections: Sections) -> Beside | None:
    """Return how far the probe of a Klipper stands beside the nozzle; None where no section says it."""
    probes = [keys for name, keys in sections.items() if not name.startswith("display")]  # which has another x_offset
    stated = next((keys for keys in probes if "x_offset" in keys or "y_offset" in keys), None)
    return None if stated is None else pair_of(stated.get(f"{side}_offset", "0") for side in "xy")


def offset_in(text: str) -> Beside | None:
    """Return how far the probe reads beside the nozzle by a printer.cfg, a report of M503 or a config.g."""
    if (sections := sections_in(text)) is not None:
        twist = sections.get("axis_twist_compensation", {})
        return (0.0, 0.0) if any(map(twist.get, UNTWISTED)) else offset_of(sections)
    words = dict(_WORD.findall("".join(_COMMAND.findall(text)[:1])))
    return pair_of(words.get(side, "0") for side in "XY") if words else None


def pair_of(texts: Iterable[str | None]) -> Beside | None:
    """Return two lengths in mm, m; None where one of them is none."""
    values = [number_or_none((text or "").strip()) for text in texts]
    found = [float(from_unit(value, "mm")) for value in values if value is not None]
    return (found[0], found[1]) if len(values) == len(found) == 2 else None


def place_of(text: str) -> Beside:
    """Return the place that somebody states, such as "150 mm, 150 mm"; raises UnitError."""
    x, _, y = text.partition(",")
    return parse_quantity(x.strip(), "length"), parse_quantity(y.strip(), "length")


def zero_of(sections: Sections) -> Beside | None:
    """Return where a Klipper of this configuration has its zero: the stated place, or where its probe homes Z.

    The probe stands beside the nozzle by its offset. A switch that homes Z says nothing of a place on the bed.
    """
    stated = _pair(sections, "bed_mesh", "zero_reference_position") or _of_index(sections)
    if stated is not None or _option(sections, "stepper_z", "endstop_pin") != _BY_PROBE:
        return stated
    aside, home = offset_of(sections) or (0.0, 0.0), _pair(sections, "safe_z_home", "home_xy_position")
    return None if home is None else (home[0] + aside[0], home[1] + aside[1])


def _of_index(sections: Sections) -> Beside | None:
    """Return the node of a mesh that an older Klipper makes zero: nodes are counted along X, there and back.

    As in its bed_mesh.py, distances of nodes are cut to 0.01 mm, and on a round bed those beyond its radius left out.
    """
    index, radius = (_option(sections, "bed_mesh", key) for key in ("relative_reference_index", "mesh_radius"))
    low, high = (_pair(sections, "bed_mesh", f"mesh_{end}") for end in ("min", "max"))
    origin = (0.0, 0.0)
    if far := pair_of((radius, radius)):
        low, high, origin = (-far[0], -far[1]), far, _pair(sections, "bed_mesh", "mesh_origin") or origin
    stated = _option(sections, "bed_mesh", "round_probe_count" if far else "probe_count") or ("5" if far else "3")
    counts = [int(each) for each in stated.split(",") if each.isdecimal() and 1 < int(each) <= _MOST]
    if low is None or high is None or not counts or not index.isdecimal():
        return None
    steps = [floor((high[k] - low[k]) * 1e5 / (counts[k % len(counts)] - 1) + _ROUNDING) / 1e5 for k in (0, 1)]
    if far:
        low = -(counts[0] // 2) * steps[0], -(counts[0] // 2) * steps[0]
    nodes = list[Beside]()
    for row in range(counts[-1]):
        along = range(counts[0])[:: -1 if row % 2 else 1]
        places = ((low[0] + column * steps[0], low[1] + row * steps[1]) for column in along)
        nodes += [place for place in places if not far or hypot(*place) <= far[0] + _ROUNDING]
    at = int(index)
    return (origin[0] + nodes[at][0], origin[1] + nodes[at][1]) if at < len(nodes) else None


def _pair(sections: Sections, section: str, key: str) -> Beside | None:
    return pair_of(_option(sections, section, key).split(","))


def _option(sections: Sections, section: str, key: str) -> str:
    return str(sections.get(section, {}).get(key) or "").translate(_MARKS)
