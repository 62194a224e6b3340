"""Where the probe of a 3D printer stands beside its nozzle, as the printer's own files say.

Klipper: `x_offset` and `y_offset` of [probe], [bltouch] and their kin, in answers of Moonraker, too. Marlin: `M851`.
RepRapFirmware: `G31`. All count from the nozzle to the probe.
"""

from __future__ import annotations

import configparser
import re
from collections.abc import Iterable, Mapping
from typing import Any

from axiscal.document.file import number_or_none
from axiscal.measurement.readers.text_file import objects_in
from axiscal.units import from_unit

Beside = tuple[float, float]
"""X and Y, m."""
Sections = Mapping[str, Mapping[str, str]]
UNTWISTED = ("z_compensations", "zy_compensations")
"""By these keys of [axis_twist_compensation] Klipper makes heights those that the nozzle itself would touch."""
_COMMAND = re.compile(r"^[^;\n]*?\b(?:M851|G31)\b([^;\n]*)", re.MULTILINE)
_WORD = re.compile(r"\b([XY])(-?[\d.]+)")


def sections_in(text: str) -> Sections | None:
    """Return the sections of a printer.cfg, those that Klipper saved among them; None where the text has none."""
    if answered := objects_in(text):
        return _in_answer(answered)
    config = configparser.RawConfigParser(strict=False, inline_comment_prefixes=("#", ";"), allow_no_value=True)
    try:
        config.read_string(text.replace("#*# ", "").replace("#*#", ""))
    except (configparser.Error, AttributeError):  # G-code has no sections; Python fails at lines behind a bare key
        return None
    return {name: {key: value or "" for key, value in config[name].items()} for name in config.sections()}


def _in_answer(answered: Iterable[dict[str, Any]]) -> Sections:
    """Return the sections in an answer of Moonraker: those of `configfile`, or the offsets of `dump_mesh`."""
    found = dict[str, dict[str, str]]()
    for each in answered:
        if isinstance(aside := each.get("probe_offsets"), list):
            found["probe"] = dict(zip(("x_offset", "y_offset"), aside, strict=False))
        if isinstance(settings := each.get("settings"), dict):
            own = {name: keys for name, keys in settings.items() if isinstance(keys, dict)}
            found |= {name: {key: str(value or "") for key, value in keys.items()} for name, keys in own.items()}
    return found


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
