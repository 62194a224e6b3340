"""What a person who loads tables into a SINUMERIK has to set first, with the numbers that these tables need."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from axiscal.compensation.controllers.sinumerik.writing import CEC, TableBlock
from axiscal.compensation.table import CompensationTable
from axiscal.units import to_unit

_ROUNDING = 1e-6
"""Of the last decimal of a limit: what lies over it through rounding alone raises it by no digit."""
_SMALL = (8, 200)
"""Tables, and points of each, that an 828D has."""


def notes(
    own: Sequence[CompensationTable], blocks: Sequence[TableBlock], names: Mapping[str, str], encoder: int
) -> tuple[str, ...]:
    """Return the sentences; arguments as for `write`."""
    sizes = ", ".join(f"[{encoder},{names[table.axis]}] {len(table.positions)}" for table in own)
    memory = (
        f"Before loading: MD38000 MM_ENC_COMP_MAX_POINTS must be at least {sizes}; setting it clears the memory: save "
        "it first.",
        f"ENC_COMP is for measuring system {encoder + 1} of each axis (index {encoder}), the one that was active while "
        "measuring; --measuring-system chooses the other.",
        "To load ENC_COMP: MD32700 ENC_COMP_ENABLE = 0, load, set it to 1, NCK reset, and reference the axis.",
        "ENC_COMP: a positive value moves the axis in its negative direction (Siemens).",
    )
    return (memory if own else ()) + (_cec(blocks, names) if blocks else ()) + _modulo(own, names)


def _cec(blocks: Sequence[TableBlock], names: Mapping[str, str]) -> tuple[str, ...]:
    counts = [len(block.table.positions) for block in blocks]
    points = ", ".join(f"[{number}] {count}" for number, count in enumerate(counts))
    over = len(blocks) > _SMALL[0] or max(counts) > _SMALL[1]
    small = (f"An 828D has {_SMALL[0]} tables of {_SMALL[1]} points: {CEC} does not fit there.",) if over else ()
    return (
        f"Before loading {CEC}: MD18342 MM_CEC_MAX_POINTS must be at least {points}; setting it clears the memory.",
        *small,
        *_together(blocks),
        "To load CEC: MD32710 CEC_ENABLE = 0, load, set it to 1 and SD41300 CEC_TABLE_ENABLE = 1 for each table. CEC "
        "is a licensed option.",
        f"MD32720 CEC_MAX_SUM limits what all CEC tables of an axis add: it must be above {_sums(blocks, names)}.",
        "MD32730 CEC_MAX_VELO limits how fast that changes, in per cent of MD32000 of the axis: it must be above "
        f"{_slopes(blocks, names)}. A reversal is spread over the time that this allows.",
        "CEC: no Siemens text that we know states the sign; here it is that of ENC_COMP. Check one point with a dial "
        "gauge, and export with --flip if the axis goes the wrong way.",
    )


def _together(blocks: Sequence[TableBlock]) -> tuple[str, ...]:
    """Return what to know of tables that are multiplied by each other; nothing where none are."""
    twins = [number for number, block in enumerate(blocks) if block.times is not None or block.factor]
    if not twins:
        return ()
    largest = max(float(np.max(np.abs(blocks[number].values))) for number in twins)
    return (
        f"Tables {twins[0]} to {twins[-1]} are what two axes do together, as products: each table comes with its "
        "negative, so that they cancel where a control adds the factors themselves as well (Siemens' texts differ), "
        "and the products are left. Load and enable all of them or none: one alone moves its axis by up to "
        f"{to_unit(largest, 'mm'):.3f} mm.",
    )


def _by_axis(blocks: Sequence[TableBlock], sizes: Sequence[float]) -> dict[str, float]:
    """Return the sum over the tables of each axis that act at once: those of the two directions do not."""
    found: dict[str, float] = {}
    for direction in (1, -1):
        one: dict[str, float] = {}
        for block, size in zip(blocks, sizes, strict=True):
            if block.direction in (0, direction):
                one[block.table.axis] = one.get(block.table.axis, 0.0) + size
        found |= {axis: max(size, found.get(axis, 0.0)) for axis, size in one.items()}
    return found


def _sums(blocks: Sequence[TableBlock], names: Mapping[str, str]) -> str:
    sums = _by_axis(blocks, [block.size for block in blocks])
    units = {block.table.axis: "deg" if block.table.rotary else "mm" for block in blocks}
    shown = {axis: _above(to_unit(size, units[axis]), 4) for axis, size in sums.items()}
    return ", ".join(f"{size} {units[axis]} ({names[axis]})" for axis, size in shown.items())


def _slopes(blocks: Sequence[TableBlock], names: Mapping[str, str]) -> str:
    steepest = [block.slope for block in blocks]
    return ", ".join(
        f"{_above(100 * slope, 3)} % ({names[axis]})" for axis, slope in _by_axis(blocks, steepest).items()
    )


def _above(value: float, decimals: int) -> str:
    """Return the least number of so many decimals that is not below a value, and is above nought: a limit to set."""
    last = 10**decimals
    return f"{max(1, math.ceil(value * last - _ROUNDING)) / last:.{decimals}f}"


def _modulo(own: Sequence[CompensationTable], names: Mapping[str, str]) -> tuple[str, ...]:
    turning = [names[t.axis] for t in own if t.rotary and abs(np.ptp(t.positions) - 2 * np.pi) < 1e-9]
    if not turning:
        return ()
    return (
        f"The tables of {', '.join(turning)} have IS_MODULO = 1: they repeat after each turn, whether MD30310 "
        "ROT_IS_MODULO lets the axis count on or not.",
    )
