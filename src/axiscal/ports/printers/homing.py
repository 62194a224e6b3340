"""Where a printer finds the zero of Z, as its own files say. A mesh is zero there, for the printer homes without it."""

from __future__ import annotations

import configparser
import re
from collections.abc import Iterable, Mapping

from axiscal.document.file import number_or_none
from axiscal.units import from_unit

Place = tuple[float, float]
"""X and Y, m."""
Sections = Mapping[str, Mapping[str, str]]
_WORD = re.compile(r"([XY])(-?[\d.]+|\S*)")
_HOMES = re.compile(r"G28\b(?!.*[XY])|G28\b.*Z|G30\b")
"""What homes Z: G28 of every axis or of Z, and G30 of RepRapFirmware."""
_DEFINED = re.compile(r"^\s*#define\s+Z_SAFE_HOMING_([XY])_POINT\s+([^\s/]+)", re.MULTILINE)
_PROBE = re.compile(r"^\s*G31\b([^;\n]*)", re.MULTILINE)
_BY_PROBE = "probe:z_virtual_endstop"


def zero_in(text: str) -> Place | None:
    """Return the place that a printer.cfg, a homez.g or a Configuration.h of Marlin states, None where none does."""
    if defined := dict(_DEFINED.findall(text)):
        return _pair(defined.get(side, "") for side in "XY")
    config = configparser.RawConfigParser(strict=False, inline_comment_prefixes=("#", ";"), allow_no_value=True)
    try:
        config.read_string(text.replace("#*#", ""))
    except configparser.Error:  # G-code has no sections
        beside = dict(_WORD.findall("".join(_PROBE.findall(text)[:1])))
        return homed_at(text, _pair(beside.get(side, "0") for side in "XY") or (0.0, 0.0))
    return zero_of(config)


def zero_of(sections: Sections) -> Place | None:
    """Return where a Klipper of this configuration has its zero: the stated place, or where it homes Z.

    A probe that homes Z stands beside the nozzle by its offset.
    """
    stated = _pair(_option(sections, "bed_mesh", "zero_reference_position").split(","))
    if stated is not None:
        return stated
    probes = [keys for keys in sections.values() if "x_offset" in keys or "y_offset" in keys]
    by_probe = probes and _option(sections, "stepper_z", "endstop_pin") == _BY_PROBE
    aside = _pair(probes[0].get(f"{side}_offset", "0") for side in "xy") if by_probe else None
    home, aside = _pair(_option(sections, "safe_z_home", "home_xy_position").split(",")), aside or (0.0, 0.0)
    if home is not None:
        return home[0] + aside[0], home[1] + aside[1]
    return homed_at(_option(sections, "homing_override", "gcode"), aside)


def homed_at(code: str, aside: Place) -> Place | None:
    """Return where G-code homes Z, None where it does not say.  aside : of the probe from the nozzle, m"""
    at = {"X": "", "Y": ""}
    for line in (each.partition(";")[0].strip().upper() for each in code.splitlines()):
        if _HOMES.match(line):
            at |= dict(_WORD.findall(line))
            home = _pair(at.values())
            return None if home is None else (home[0] + aside[0], home[1] + aside[1])
        if re.match(r"G[01]\b", line):
            at |= dict(_WORD.findall(line))
    return None


def _option(sections: Sections, section: str, key: str) -> str:
    return str(sections[section].get(key) or "") if section in sections else ""


def _pair(texts: Iterable[str]) -> Place | None:
    values = [number_or_none(text.strip()) for text in texts]
    found = [from_unit(value, "mm") for value in values if value is not None]
    return (found[0], found[1]) if len(values) == len(found) == 2 else None
