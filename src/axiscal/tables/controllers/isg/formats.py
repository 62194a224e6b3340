"""ISG_CSV, written and read back by the documentation's rules (TF5280), and the list file.

Columns under a header, `#` begins a new one, `//` a comment; mm, deg and rad.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

import numpy as np

from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.machine.names import parse_error_name
from axiscal.numerics import Array
from axiscal.tables.export_options import ExportOptions
from axiscal.tables.volumetric import SampledError
from axiscal.units import from_unit, to_unit

NAMES = re.compile(r"E[XYZABC][XYZABC]|[XYZABC]0[XYZABC]|P[XYZ][ABC]|P0[XYZ]")


def write_csv(found: Mapping[str, SampledError], machine: Machine) -> str:
    """Return the ISG_CSV text."""
    constants = {name: curve for name, curve in found.items() if len(curve.positions) == 1}
    blocks = []
    if constants:
        values = [_shown(name, curve.values)[0] for name, curve in constants.items()]
        blocks.append(_row(constants) + _row(f"{value:.9e}" for value in values))
    for axis in machine.axes:
        own = {
            n: c for n, c in found.items() if not (n in constants or c.over) and parse_error_name(n).axis == axis.name
        }
        if own:
            at = to_unit(next(iter(own.values())).positions, axis.unit)
            columns = [_shown(name, curve.values) for name, curve in own.items()]
            rows = zip(at, *columns, strict=True)
            lines = (_row([f"{p:.6f}", *(f"{value:.9e}" for value in values)]) for p, *values in rows)
            blocks.append(_row([axis.name, *own]) + "".join(lines))
    blocks += [_over_both(name, curve, machine) for name, curve in found.items() if curve.over]
    return "// mm, deg and rad\n" + "#\n".join(blocks)


def _over_both(name: str, curve: SampledError, machine: Machine) -> str:
    """Return the block of an error that depends on two axes: all positions of its axis at each of the other one."""
    own, other = machine.axis(parse_error_name(name).axis), machine.axis(curve.over)
    lines = [_row([other.name, own.name, name])]
    for across, values in zip(to_unit(curve.across, other.unit), curve.values, strict=True):
        rows = zip(to_unit(curve.positions, own.unit), _shown(name, values), strict=True)
        lines += [_row([f"{across:.6f}", f"{at:.6f}", f"{value:.9e}"]) for at, value in rows]
    return "".join(lines)


def read_csv(text: str, machine: Machine) -> dict[str, SampledError]:
    """Return the errors of an ISG_CSV text; raises TableError where the kernel would report 70468 or 70469."""
    found: dict[str, SampledError] = {}
    rows: list[list[str]] = []
    for line in [*text.splitlines(), "#"]:
        words = line.split("//")[0].split()
        if words != ["#"]:
            rows += [words] if words else []
            continue
        if rows:
            _take_block(rows, machine, found)
        rows = []
    return found


def _take_block(rows: list[list[str]], machine: Machine, found: dict[str, SampledError]) -> None:
    header, *lines = rows
    arguments = [name for name in header if name in {axis.name for axis in machine.axes}]
    table = np.array([[float(word) for word in line] for line in lines]).reshape(len(lines), len(header))
    at = {n: from_unit(np.asarray(table[:, header.index(n)]), machine.axis(n).unit) for n in arguments}
    for column, name in enumerate(header):
        if name in arguments:
            continue
        if not NAMES.fullmatch(name) or name in found:
            remedy = "this is a defect of axiscal"
            raise TableError("the kernel would refuse the column {name!r}", remedy, name=name[:20])
        found[name] = _sampled(name, at, _inside(name, np.asarray(table[:, column])))


def _sampled(name: str, at: Mapping[str, Array], values: Array) -> SampledError:
    """Return a column over one axis, over two, or of a constant; raises TableError for a grid that is none."""
    if len(at) < 2:
        return SampledError(next(iter(at.values()), np.zeros(1)), values)
    own = parse_error_name(name).axis
    others = [axis for axis in at if axis != own]
    if own not in at or len(others) > 1:
        remedy = "give it over its own axis and one other"
        raise TableError("{name} over {axes} is not read", remedy, name=name, axes=", ".join(at))
    (positions, inner), (across, outer) = (np.unique(at[axis], return_inverse=True) for axis in (own, others[0]))
    grid = np.full((len(across), len(positions)), np.nan)
    grid[outer, inner] = values
    if len(values) != grid.size or np.any(np.isnan(grid)):
        what = "{name} is not there at every pair of {other} and {own}"
        raise TableError(what, "give the whole grid", name=name, other=others[0], own=own)
    return SampledError(positions, grid, others[0], across)


def list_file(machine: Machine, options: ExportOptions, name: str) -> str:
    """Return the configuration of one compensation, as TF5280 has it."""
    workpiece = sum(axis.workpiece_side for axis in machine.axes)
    chain = "".join(axis.name for axis in machine.axes)
    negate = "".join(axis.name for axis in machine.axes if not axis.rotary) if options.flip else ""
    lines = [f"{axis} {number}" for axis, number in options.numbered(machine).items()]
    lines += [f"chain {chain}", f"workpiece_axes {workpiece}", *([f"negate {negate}"] if negate else [])]
    lines += ["interpolation GRID", f"file[0] {name}", "file_format[0] ISG_CSV"]
    return "\n".join(lines) + "\n"


def _row(words: Iterable[str]) -> str:
    return " ".join(words) + "\n"


def _shown(name: str, values: Array) -> Array:
    return 0.0 + (values if _angular(name) else np.asarray(to_unit(values, "mm"), dtype=float))


def _inside(name: str, values: Array) -> Array:
    return values if _angular(name) else np.asarray(from_unit(values, "mm"), dtype=float)


def _angular(name: str) -> bool:
    return not name.startswith("P") and parse_error_name(name).angular
