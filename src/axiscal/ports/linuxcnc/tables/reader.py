"""How LinuxCNC itself reads a `COMP_FILE`, and what it then adds to the command.

A model of three functions, which checks nothing that LinuxCNC does not check:

- usrmotLoadComp: fgets of 254 bytes, sscanf "%lf %lf %lf"; the first line that does not match ends the file
- EMCMOT_SET_JOINT_COMP: rows must increase, 256 of them
- compute_screw_comp: linear between, constant outside, trims and slopes in 32 bits
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from axiscal.numerics import Array

ROWS = 256
"""By LinuxCNC's source (usrmotintf.cc): rows that are kept."""
_CHUNK = 254
"""By LinuxCNC's source (usrmotintf.cc): characters that fgets takes at once."""
_FLOAT = rb"""(?>[ \t\n\v\f\r]*)(?P<%b>(?>[+-]?(?:
    0[xX](?:[0-9a-fA-F]+\.?[0-9a-fA-F]*|\.[0-9a-fA-F]*)(?:[pP][+-]?[0-9]*)?
    | (?!0[xX])(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]*)?
    | [iI][nN][fF](?:[iI][nN][iI][tT][yY]|(?![iI]))
    | [nN][aA][nN])))"""
_TRIPLET = re.compile(b"".join(_FLOAT % name for name in (b"nominal", b"forward", b"reverse")), re.VERBOSE)


@dataclass(frozen=True, slots=True, eq=False)
class LinuxcncTable:
    """A file as LinuxCNC keeps it, in machine units.

    nominal : (n,); forward, reverse : (n,) trims, nominal minus actual, that are added to the command
    errors : what it reports to the operator; unread : the line at which it stopped in silence, None at the end
    """

    nominal: Array
    forward: Array
    reverse: Array
    errors: tuple[str, ...]
    unread: int | None


def parse(text: str, joint: int = 0, file_type: int = 0) -> LinuxcncTable:
    """Read a file as LinuxCNC does; whatever the text is, LinuxCNC starts with some table, and so it is given here.

    file_type : COMP_FILE_TYPE; 0 holds actual positions, any other number the trims themselves
    """
    rows: list[tuple[float, float, float]] = []
    errors: list[str] = []
    unread = None
    for line, chunk in _chunks(text.encode("utf-8", "surrogatepass")):
        found = _TRIPLET.match(chunk)
        if found is None:
            unread = line
            break
        nominal, forward, reverse = map(_number, found.groups())
        if len(rows) >= ROWS:
            errors.append(f"joint {joint}: too many compensation entries")
        elif nominal <= (rows[-1][0] if rows else -np.finfo(np.float64).max):
            errors.append(f"joint {joint}: compensation values must increase")
        else:
            rows.append((nominal, forward, reverse) if file_type else (nominal, nominal - forward, nominal - reverse))
    columns = np.array(rows, dtype=np.float64).reshape(-1, 3).T
    with np.errstate(over="ignore"):
        trims = columns[1:].astype(np.float32).astype(np.float64)
    return LinuxcncTable(columns[0], trims[0], trims[1], tuple(errors), unread)


def correction(table: LinuxcncTable, position: Array, direction: int) -> Array:
    """Return what is added to the command at joint positions (m,), moving in direction +1 or -1, machine units."""
    trims = (table.forward if direction > 0 else table.reverse).astype(np.float32)
    if trims.size == 0:
        return np.zeros(np.shape(position))
    slopes = np.append((np.diff(trims) / np.diff(table.nominal)).astype(np.float32), np.float32(0))
    at = np.searchsorted(table.nominal, position, side="right") - 1
    within = np.maximum(at, 0)
    inside = trims[within] + slopes[within].astype(np.float64) * (position - table.nominal[within])
    return np.where(at < 0, np.float64(trims[0]), inside)


def _chunks(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield line number and bytes of each fgets, cut at a zero byte as C strings are."""
    for number, line in enumerate(re.findall(rb"[^\n]*\n|[^\n]+", data), 1):
        for start in range(0, len(line), _CHUNK):
            yield number, line[start : start + _CHUNK].partition(b"\0")[0]


def _number(text: bytes) -> float:
    """Return what strtod makes of a text that scanf took: a mantissa, and an exponent that may be cut off."""
    plain = text.decode("ascii").lower()
    hexadecimal = "0x" in plain
    mantissa, _, exponent = plain.partition("p" if hexadecimal else "e")
    if not hexadecimal:
        return float(plain if exponent.strip("+-") else mantissa)
    if not mantissa.strip("+-0x."):
        return -0.0 if mantissa.startswith("-") else 0.0
    try:
        return float.fromhex(plain if exponent.strip("+-") else mantissa)
    except OverflowError:
        return -math.inf if mantissa.startswith("-") else math.inf
