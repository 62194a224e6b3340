"""All tables for a SINUMERIK 840D sl, ONE or 828D.

`$AA_ENC_COMP` has no direction: it holds the mean of both. Two `$AN_CEC` tables, one for each direction, hold the
difference to it; their input is their output. CEC tables with another input hold straightness, sag and squareness.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.tables.controllers.sinumerik.read_back import read
from axiscal.tables.controllers.sinumerik.writing import CEC, TableBlock, blocks_of, write
from axiscal.tables.controllers.sinumerik.writing import POINTS as CEC_POINTS
from axiscal.tables.export_options import ExportOptions
from axiscal.tables.exporter import TableFormat, Written
from axiscal.tables.loaded import Loaded
from axiscal.tables.offer import Draft
from axiscal.tables.old_files import OldFile
from axiscal.tables.table import CompensationTable
from axiscal.units import from_unit, to_unit

_ROUNDING = 1e-6
"""Of the last decimal of a limit: what lies over it through rounding alone raises it by no digit."""
_SMALL = (8, 200)
"""Tables, and points of each, that an 828D has."""

_STEP = 1e-6
"""The grid of positions, m: the decimals that are written."""


class Sinumerik(TableFormat):
    """Encoder compensation and CEC tables."""

    holds = (
        "encoder compensation for every axis (the mean of both directions), and CEC tables for what the directions are "
        "apart, for straightness, sag and squareness."
    )
    left_out = "errors that depend on two axes at once, the orientation of the tool, and the reversal of straightness."
    points = 200  # what an 828D holds for an axis
    on_top = CEC_POINTS
    grid = (_STEP, float(np.radians(1e-3)))

    def make(self, estimate: Estimate, options: ExportOptions) -> Draft:
        """Return the files with their tables; raises TableError."""
        if options.unit != "mm":
            what = "tables for SINUMERIK are written in mm and deg"
            raise TableError(what, "leave --unit out, and load them in metric")
        return super().make(estimate, options)

    def write(self, tables: Sequence[CompensationTable], machine: Machine, options: ExportOptions) -> Written:
        """Return the files that are needed."""
        names, encoder = _names(machine, options), options.encoder - 1
        own, over = ([t for t in tables if (t.axis == t.over) is itself] for itself in (True, False))
        blocks = blocks_of(own, over)
        files = write(own, blocks, names, -1.0 if options.flip else 1.0, encoder)
        steps = {axis.name: float(from_unit(4e-6, axis.unit)) for axis in machine.axes}
        return Written(files, steps, notes(own, blocks, names, encoder))

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what tables did of the chosen measuring system; raises TableError."""
        names, lookups = _names(machine, options), []
        for file in files:
            try:
                lookups += read([file.text], names, machine, options.flip, options.encoder - 1)
            except TableError as fault:
                remedy = "give AX_EEC.INI and NC_CEC.INI as the control saved them"
                raise TableError(fault.what, remedy, file.name) from None
        return Loaded(tuple(lookups))


def _names(machine: Machine, options: ExportOptions) -> dict[str, str]:
    """Return the machine axis identifier of each axis: AX1, AX2, …; raises TableError as `numbered`."""
    return {name: f"AX{number}" for name, number in options.numbered(machine).items()}


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
        "To load CEC: MD32710 CEC_ENABLE = 0, load, set it to 1 and SD41300 CEC_TABLE_ENABLE = 1 for each table. CEC "
        "is a licensed option.",
        f"MD32720 CEC_MAX_SUM limits what all CEC tables of an axis add: it must be above {_sums(blocks, names)}.",
        "MD32730 CEC_MAX_VELO limits how fast that changes, in per cent of MD32000 of the axis: it must be above "
        f"{_slopes(blocks, names)}. A reversal is spread over the time that this allows.",
        "CEC: no Siemens text that we know states the sign; here it is that of ENC_COMP. Check one point with a dial "
        "gauge, and export with --flip if the axis goes the wrong way.",
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
    """Return the least positive number of `decimals` decimals that is not below a value: a limit to set."""
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
