"""What a SINUMERIK makes of `$AA_ENC_COMP` and `$AN_CEC`, by its manuals."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

import numpy as np

from axiscal.compensation.lookup import Lookup
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.units import from_unit

_VALUE = re.compile(r"\$A([AN])_(ENC_COMP|CEC)(?:_([A-Z_]+))?\[(\d+)(?:,(\w+))?(?:,(\w+))?\]\s*=\s*\(?([^)\s;]+)\)?")


def read(texts: Iterable[str], names: Mapping[str, str], machine: Machine, flip: bool = False) -> list[Lookup]:
    """Return what a SINUMERIK makes of the files, by its manuals: one assignment after the other.

    flip : CEC values are added as they are, instead of taken away as encoder compensation is
    Raises TableError for a line that is none, and for tables that are not whole.
    """
    axes = {identifier: name for name, identifier in names.items()}
    tables: dict[tuple[str, ...], dict[str, str]] = {}
    for text in texts:
        for line in (each.split(";")[0].strip() for each in text.splitlines()):
            if not line or line.startswith("%_N_") or line in ("CHANDATA(1)", "M17"):
                continue
            found = _VALUE.fullmatch(line)
            if found is None:
                raise TableError(f"SINUMERIK would not understand {line[:60]!r}", "this is a defect of axiscal")
            _, kind, key, first, second, third, value = found.groups()
            place = (kind, first) if kind == "CEC" else (kind, first, (third or second or ""))
            index = key or f"#{second}"
            tables.setdefault(place, {})[index] = value
    return [_understood(place, values, axes, machine, flip) for place, values in tables.items()]


def _understood(
    place: tuple[str, ...], values: Mapping[str, str], axes: Mapping[str, str], machine: Machine, flip: bool
) -> Lookup:
    enc = place[0] == "ENC_COMP"
    over, moved = (axes[place[2]],) * 2 if enc else (axes[values["INPUT_AXIS"]], axes[values["OUTPUT_AXIS"]])
    low, high, step = (float(values[key]) for key in ("MIN", "MAX", "STEP"))
    count = (high - low) / step + 1
    entries = [float(values.get(f"#{i}", "0")) for i in range(round(count))]
    if abs(count - round(count)) > 1e-6 or f"#{round(count)}" in values:
        raise TableError(f"the table of {moved} has {count:g} points between its ends", "this is a defect of axiscal")
    units = [machine.axis(name).unit for name in (over, moved)]
    positions: Array = from_unit(np.array([low + step * i for i in range(len(entries))]), units[0])
    sign = 1.0 if flip and not enc else -1.0
    added: Array = sign * from_unit(np.array(entries), units[1])
    return Lookup(moved, over, positions, added, 0 if enc else int(values["DIRECTION"]))
