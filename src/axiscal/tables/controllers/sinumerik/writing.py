"""The text: encoder compensation holds the mean of both directions, CEC tables what they are apart, and other axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.exceptions import TableError
from axiscal.numerics import Array
from axiscal.tables.table import CompensationTable
from axiscal.units import to_unit

TABLES = 128
"""By SIEMENS' manual: CEC tables that a control holds."""
POINTS = 2000
"""Points that MD18342 allows for a CEC table."""
ENC, CEC = "AX_EEC.INI", "NC_CEC.INI"


@dataclass(frozen=True, eq=False, slots=True)
class TableBlock:
    """One CEC table: values (n,) m or rad, taken away after moving in a direction, 0 for both."""

    table: CompensationTable
    values: Array
    direction: int

    @property
    def size(self) -> float:
        """The most that it adds to an axis, m or rad."""
        return float(np.max(np.abs(self.values)))

    @property
    def slope(self) -> float:
        """How fast that changes at most along the axis that is looked up."""
        return float(np.max(np.abs(np.diff(self.values) / np.diff(self.table.positions))))


def blocks_of(own: Sequence[CompensationTable], over: Sequence[CompensationTable]) -> tuple[TableBlock, ...]:
    """Return the CEC tables, in the order of their numbers; raises TableError for more than there can be."""
    apart = [block for table in own for block in _directions(table)]
    blocks = (*apart, *(TableBlock(table, table.forward, 0) for table in over))
    if len(blocks) > TABLES:
        remedy = "leave axes out of the description"
        raise TableError("{count} CEC tables are needed, {most} fit", remedy, count=len(blocks), most=TABLES)
    for block in blocks:
        if len(block.values) > POINTS:
            what = "the CEC table of {axis} has {count} points, MD18342 allows {most}"
            remedy = "export without --on-top-of, or give coarser tables to it"
            raise TableError(what, remedy, axis=block.table.axis, count=len(block.values), most=POINTS)
    return blocks


def write(
    own: Sequence[CompensationTable],
    blocks: Sequence[TableBlock],
    names: Mapping[str, str],
    cec_sign: float = 1.0,
    encoder: int = 0,
) -> dict[str, str]:
    """Return the files by name.  names : machine axis identifiers; encoder : 0 or 1, index of the measuring system."""
    enc = "".join(_enc(table, names[table.axis], encoder) for table in own)
    files = {ENC: f"%_N_AX_EEC_INI\nCHANDATA(1)\n{enc}M17\n"} if enc else {}
    cec = "".join(_cec(number, block, cec_sign, names) for number, block in enumerate(blocks))
    return files | ({CEC: f"%_N_NC_CEC_INI\nCHANDATA(1)\n{cec}M17\n"} if cec else {})


def _directions(table: CompensationTable) -> list[TableBlock]:
    half = (table.forward - table.reverse) / 2
    seen = np.round(np.asarray(to_unit(half, _unit(table))), 6)
    return [] if not np.any(seen) else [TableBlock(table, half, 1), TableBlock(table, -half, -1)]


def _enc(table: CompensationTable, name: str, encoder: int) -> str:
    values = np.asarray(to_unit((table.forward + table.reverse) / 2, _unit(table)))
    lines = [f"$AA_ENC_COMP[{encoder},{i},{name}]={value:.6f}" for i, value in enumerate(np.round(values, 6) + 0.0)]
    lines += [f"$AA_ENC_COMP_{key}[{encoder},{name}]={value}" for key, value in _span(table)]
    return "\n".join(lines) + "\n"


def _cec(number: int, block: TableBlock, sign: float, names: Mapping[str, str]) -> str:
    table = block.table
    shown = np.asarray(to_unit(sign * block.values, _unit(table)))
    lines = [f"$AN_CEC[{number},{i}]={value:.6f}" for i, value in enumerate(np.round(shown, 6) + 0.0)]
    lines.append(f"$AN_CEC_INPUT_AXIS[{number}]=({names[table.over]})")
    lines.append(f"$AN_CEC_OUTPUT_AXIS[{number}]=({names[table.axis]})")
    *span, modulo = _span(table)
    lines += [f"$AN_CEC_{key}[{number}]={value}" for key, value in span]
    lines += [f"$AN_CEC_DIRECTION[{number}]={block.direction}", f"$AN_CEC_MULT_BY_TABLE[{number}]=0"]
    lines.append(f"$AN_CEC_{modulo[0]}[{number}]={modulo[1]}")
    return "\n".join(lines) + "\n"


def _span(table: CompensationTable) -> list[tuple[str, str]]:
    shown = np.round(np.asarray(to_unit(table.positions, table.unit)), 3) + 0.0
    step = np.round(shown[1] - shown[0], 3)
    if np.max(np.abs(np.diff(shown) - step)) > 2e-3 * len(shown):
        remedy = "SINUMERIK has one distance for a table"
        raise TableError("the points of {axis} are not evenly spaced", remedy, axis=table.axis)
    modulo = int(table.rotary and abs(shown[-1] - shown[0] - 360) < 1e-6)
    last = shown[0] + step * (len(shown) - 1)
    return [("STEP", f"{step:.3f}"), ("MIN", f"{shown[0]:.3f}"), ("MAX", f"{last:.3f}"), ("IS_MODULO", str(modulo))]


def _unit(table: CompensationTable) -> str:
    return "deg" if table.rotary else "mm"
