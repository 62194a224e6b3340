"""Where a printer finds the zero of Z, as its own files say. A mesh is zero there, for the printer homes without it."""

from __future__ import annotations

import re

from axiscal.measurement.readers.probe_offset import Beside, Sections, offset_in, offset_of, pair_of, sections_in

Place = Beside
"""X and Y, m."""
_WORD = re.compile(r"([XY])(-?[\d.]+|\S*)")
_HOMES = re.compile(r"G28\b(?!.*[XY])|G28\b.*Z|G30\b")
"""What homes Z: G28 of every axis or of Z, and G30 of RepRapFirmware."""
_DEFINED = re.compile(r"^\s*#define\s+Z_SAFE_HOMING_([XY])_POINT\s+([^\s/]+)", re.MULTILINE)
_BY_PROBE = "probe:z_virtual_endstop"


def zero_in(text: str) -> Place | None:
    """Return the place that a printer.cfg, a homez.g or a Configuration.h of Marlin states, None where none does."""
    if defined := dict(_DEFINED.findall(text)):
        return pair_of(defined.get(side) for side in "XY")
    sections = sections_in(text)
    return homed_at(text, offset_in(text) or (0.0, 0.0)) if sections is None else zero_of(sections)


def zero_of(sections: Sections) -> Place | None:
    """Return where a Klipper of this configuration has its zero: the stated place, or where it homes Z.

    A probe that homes Z stands beside the nozzle by its offset.
    """
    stated = pair_of(_option(sections, "bed_mesh", "zero_reference_position").split(","))
    if stated is not None:
        return stated
    by_probe = _option(sections, "stepper_z", "endstop_pin") == _BY_PROBE
    aside = (offset_of(sections) if by_probe else None) or (0.0, 0.0)
    home = pair_of(_option(sections, "safe_z_home", "home_xy_position").split(","))
    if home is not None:
        return home[0] + aside[0], home[1] + aside[1]
    return homed_at(_option(sections, "homing_override", "gcode"), aside)


def homed_at(code: str, aside: Place) -> Place | None:
    """Return where G-code homes Z, None where it does not say.  aside : of the probe from the nozzle, m"""
    at = {"X": "", "Y": ""}
    for line in (each.partition(";")[0].strip().upper() for each in code.splitlines()):
        if _HOMES.match(line):
            at |= dict(_WORD.findall(line))
            home = pair_of(at.values())
            return None if home is None else (home[0] + aside[0], home[1] + aside[1])
        if re.match(r"G[01]\b", line):
            at |= dict(_WORD.findall(line))
    return None


def _option(sections: Sections, section: str, key: str) -> str:
    return str(sections[section].get(key) or "") if section in sections else ""
