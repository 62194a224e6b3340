"""The corrections that a SINUMERIK makes of `$AA_ENC_COMP` and `$AN_CEC`, by its manuals."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

import numpy as np

from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.tables.loaded import Lookup
from axiscal.units import from_unit

_PLAIN = re.compile(r"^\s*N\d+\s+")
_VALUE = re.compile(r"\$A([AN])_(ENC_COMP|CEC)(?:_([A-Z_]+))?\[(\d+)(?:,(\w+))?(?:,(\w+))?\]\s*=\s*\(?([^)\s;]+)\)?")

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,2})?", re.ASCII)
_MOST_POINTS = 100_000
"""Of a table; controls hold a few thousand."""


def read(
    texts: Iterable[str], names: Mapping[str, str], machine: Machine, flip: bool = False, encoder: int | None = None
) -> list[Lookup]:
    """Return what a SINUMERIK makes of the files, by its manuals: one assignment after the other.

    flip : CEC values are added as they are, instead of taken away as encoder compensation is
    encoder : 0 or 1, the measuring system that is looked at; None for the one that there is
    Raises TableError for a line that is none, for tables that are not whole, and for one that is multiplied by another.
    """
    own = {f"{name}1": name for name in names} | {name: name for name in names}
    axes = own | {identifier: name for name, identifier in names.items()}
    tables: dict[tuple[str, ...], dict[str, str]] = {}
    for text in texts:
        for line in (_PLAIN.sub("", each.split(";")[0]).strip() for each in text.splitlines()):
            if not line or line.startswith(("%_N_", "CHANDATA(")) or line in ("M17", "M30"):
                continue
            found = _VALUE.fullmatch(line)
            if found is None:
                remedy = "this is a defect of axiscal"
                raise TableError("SINUMERIK would not understand {text!r}", remedy, text=line[:60])
            _, kind, key, first, second, third, value = found.groups()
            if kind == "ENC_COMP" and encoder not in (None, int(first)):
                continue
            place = (kind, first) if kind == "CEC" else (kind, first, (third or second or ""))
            index = key or f"#{second}"
            tables.setdefault(place, {})[index] = value
    lookups = (_understood(place, values, axes, machine, flip) for place, values in tables.items())
    return [lookup for lookup in lookups if lookup is not None]


def _understood(
    place: tuple[str, ...], values: Mapping[str, str], axes: Mapping[str, str], machine: Machine, flip: bool
) -> Lookup | None:
    """Return a table, None for one that is not in use: without a step, or for axes that the machine has not."""
    enc = place[0] == "ENC_COMP"
    over, moved = (axes.get(name) for name in ((place[2],) * 2 if enc else _ends(values)))
    low, high, step = (_number(values.get(key, "0")) for key in ("MIN", "MAX", "STEP"))
    if over is None or moved is None or step <= 0:
        return None
    count = (high - low) / step + 1
    if count > _MOST_POINTS:
        remedy = "write a larger STEP"
        raise TableError("the table of {moved} has {count:g} points between its ends", remedy, moved=moved, count=count)
    if int(values.get("MULT_BY_TABLE", "0")):
        what = "a CEC table of {axis} is multiplied by another one"
        raise TableError(what, "leave MULT_BY_TABLE at 0", axis=moved)
    entries = [_number(values.get(f"#{i}", "0")) for i in range(round(count))]
    if abs(count - round(count)) > 1e-6 or _number(values.get(f"#{round(count)}", "0")):
        remedy = "this is a defect of axiscal"
        raise TableError("the table of {moved} has {count:g} points between its ends", remedy, moved=moved, count=count)
    units = [machine.axis(name).unit for name in (over, moved)]
    positions: Array = from_unit(np.array([low + step * i for i in range(len(entries))]), units[0])
    sign = 1.0 if flip and not enc else -1.0
    added: Array = sign * from_unit(np.array(entries), units[1])
    return Lookup(moved, over, positions, added, 0 if enc else int(values.get("DIRECTION", "0")))


def _number(text: str) -> float:
    """Return a finite number; raises TableError."""
    if not _NUMBER.fullmatch(text):
        raise TableError("{text!r} is no number", "write digits with a decimal point", text=text[:40])
    return float(text)


def _ends(values: Mapping[str, str]) -> tuple[str, str]:
    """Return the axis that is looked up and the one that is moved."""
    return values.get("INPUT_AXIS", ""), values.get("OUTPUT_AXIS", "")
