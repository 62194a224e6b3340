"""All files for the ISG kernel and Beckhoff TwinCAT CNC (TF5280): error motions and location errors, and reversal.

The volumetric compensation has no direction; a bilateral leadscrew table of each axis holds what its directions are
apart, half to each side.

ISG_CSV, written and read back by the documentation's rules (TF5280), and the list file.

Columns under a header, `#` begins a new one, `//` a comment; mm, deg and rad.

Bilateral leadscrew tables (`kw.ssfk`): what an axis is off by, for each direction, in tenths of a µm or 1e-4 deg.

A value is the actual position less the setpoint ("absolute position errors", TF5200 axis compensation), and the kernel
takes it away. Points are evenly spaced from kw_startpos on.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.error_names import error_named
from axiscal.numerics import Array
from axiscal.tables.exporter import Draft, Exporter, ExportOptions, Written, paragraphs, sign_said, summed
from axiscal.tables.loaded import Loaded, OldFile, table_control
from axiscal.tables.sampling import axis_tables, points
from axiscal.tables.surface import sum_of
from axiscal.tables.table import CompensationTable
from axiscal.tables.volumetric import SampledError, anchored, curves, tip_control
from axiscal.units import from_unit, to_unit
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine

_UNIT = 1e-4
"""One unit of a list in mm or deg."""
_LINE = re.compile(r"(kopf|kw\.ssfk)\.(\w+)(?:\[(\d+)\]\.(\w+))?\s+(\S+)")


def list_unit(axis_unit: str) -> float:
    """Return one unit of the file, m or rad."""
    return float(from_unit(_UNIT, axis_unit))


def write_list(table: CompensationTable, number: int, cyclic: bool) -> str:
    """Return the list of one axis; number : logical axis; cyclic : the table holds one turn and repeats."""
    columns = np.stack([table.positions, table.forward, table.reverse])
    at, forward, reverse = np.round(np.asarray(to_unit(columns, table.unit)) / _UNIT).astype(np.int64)
    steps = np.diff(at)
    if np.ptp(steps):
        raise TableError("the points of {axis} are not evenly spaced", "leave the spacing to axiscal", axis=table.axis)
    keys = {"interval": steps[0], "kw_startpos": at[0], "kw_nr_max": len(at), "unit": 1, "bilateral": 1}
    lines = [f"kopf.log_achs_nr {number}", f"kopf.log_achs_name {table.axis}"]
    lines += [f"kw.ssfk.{key} {value}" for key, value in {**keys, "modulo": int(cyclic)}.items()]
    for name, values in (("pos", forward), ("neg", reverse)):
        lines += [f"kw.ssfk.table[{i}].{name} {value}" for i, value in enumerate(values)]
    return "\n".join(lines) + "\n"


def read_list(text: str, machine: Machine) -> CompensationTable:
    """Return what the kernel makes of a list; raises TableError for a line that it would not know."""
    keys, sides = dict[str, str](), {"pos": dict[int, int](), "neg": dict[int, int]()}
    for line in text.splitlines():
        found = _LINE.fullmatch(line)
        if found is None or (found[4] is not None and found[4] not in sides):
            raise TableError("the kernel would not know {text!r}", "this is a defect of axiscal", text=line[:40])
        if found[4] is None:
            keys[found[2]] = found[5]
        else:
            sides[found[4]][int(found[3])] = int(found[5])
    axis, count = machine.axis(keys["log_achs_name"]), int(keys["kw_nr_max"])
    scale = list_unit(axis.unit)
    at: Array = scale * (int(keys["kw_startpos"]) + int(keys["interval"]) * np.arange(count, dtype=float))
    pos, neg = (scale * np.array([values[i] for i in range(count)]) for values in sides.values())
    return CompensationTable(axis.name, at, pos, neg)


NAMES = re.compile(r"E[XYZABC][XYZABC]|[XYZABC]0[XYZABC]|P[XYZ][ABC]|P0[XYZ]")


def write_csv(found: Mapping[str, SampledError], machine: Machine) -> str:
    """Return the ISG_CSV text: constants, errors over each axis, and each that depends on two axes at all pairs."""
    constants = {name: curve.values for name, curve in found.items() if len(curve.positions) == 1}
    blocks = [_block([], constants)] if constants else []
    alone = {name: curve for name, curve in found.items() if not (name in constants or curve.over)}
    for axis in machine.axes:
        own = {name: curve for name, curve in alone.items() if error_named(name).axis == axis.name}
        if own:
            at = next(iter(own.values())).positions
            blocks.append(_block([(axis, at)], {name: curve.values for name, curve in own.items()}))
    for name, curve in ((name, curve) for name, curve in found.items() if curve.over):
        across, at = np.meshgrid(curve.across, curve.positions, indexing="ij")
        over = (machine.axis(curve.over), across), (machine.axis(error_named(name).axis), at)
        blocks.append(_block(over, {name: curve.values}))
    return "// mm, deg and rad\n" + "#\n".join(blocks)


def _block(at: Sequence[tuple[Axis, Array]], errors: Mapping[str, Array]) -> str:
    """Return the header and the lines of errors, at positions of no axis, one, or two."""
    shown = [[f"{place:.6f}" for place in to_unit(places.ravel(), axis.unit)] for axis, places in at]
    for name, values in errors.items():
        shown.append([f"{value + 0.0:.9e}" for value in to_unit(values.ravel(), _unit(name))])
    header = [*(axis.name for axis, _ in at), *errors]
    return "".join(" ".join(words) + "\n" for words in [header, *zip(*shown, strict=True)])


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
        values = np.asarray(table[:, column])
        found[name] = _sampled(name, at, from_unit(values, _unit(name)))


def _sampled(name: str, at: Mapping[str, Array], values: Array) -> SampledError:
    """Return a column over one axis, over two, or of a constant."""
    if len(at) < 2:
        return SampledError(next(iter(at.values()), np.zeros(1)), values)
    own = error_named(name).axis
    (other,) = (axis for axis in at if axis != own)
    (positions, inner), (across, outer) = (np.unique(at[axis], return_inverse=True) for axis in (own, other))
    grid = np.full((len(across), len(positions)), np.nan)
    grid[outer, inner] = values
    return SampledError(positions, grid, other, across)


def list_file(machine: Machine, options: ExportOptions, name: str) -> str:
    """Return the configuration of one compensation, as TF5280 has it."""
    workpiece = sum(axis.workpiece_side for axis in machine.axes)
    chain = "".join(axis.name for axis in machine.axes)
    negate = "".join(axis.name for axis in machine.axes if not axis.rotary) if options.flip else ""
    lines = [f"{axis} {number}" for axis, number in options.numbered(machine).items()]
    lines += [f"chain {chain}", f"workpiece_axes {workpiece}", *([f"negate {negate}"] if negate else [])]
    lines += ["interpolation GRID", f"file[0] {name}", "file_format[0] ISG_CSV"]
    return "\n".join(lines) + "\n"


def _unit(name: str) -> str:
    """Return the unit of an error, mm or rad; of places of the chain mm."""
    return "rad" if not name.startswith("P") and error_named(name).angular else "mm"


_HOLDS = "every error motion as a table over its axis, and every location error: the control knows the chain{}."
_BOTH = "; what two axes do together as a table of the later one over both"
_APART = "; and what each axis is apart between its directions"
_RECORDS = 1000
"""Points of an axis that a table of the kernel may have; four an interval are rarely more than a hundred."""
_FILE = "volcomp.csv"
_SIGN = "FCT-C26 and P-VOLC-00009 (negate) state how values are turned and not which sign they have"
_MULTIPLE = (1e-6, float(np.radians(1e-4)))
"""The grid of positions, m and rad: the decimals that are written."""


class Isg(Exporter):
    """ISG_CSV, the list file, and leadscrew tables of axes with a reversal."""

    takes = frozenset({"--spacing", "--number"})
    unstated = "own"
    left_out = "the reversal of straightness and of angles, and the orientation of the tool."

    def make(self, estimate: Estimate, options: ExportOptions) -> Draft:
        """Return the files; raises TableError."""
        machine, found = estimate.machine, self._errors(estimate, options)
        halves, numbers = apart(estimate, options), options.numbered(machine)
        lists = {f"ssfk_{t.axis}.lis": write_list(t, numbers[t.axis], machine.axis(t.axis).cyclic) for t in halves}
        listed = list_file(machine, options, _FILE)
        files = {_FILE: write_csv(found, machine), "volcomp.lis": listed, **lists}
        apart_by = [(t.axis, 0.5 * list_unit(machine.axis(t.axis).unit) + 1e-12) for t in halves]
        steps = summed([*((axis.name, 1e-8) for axis in machine.axes if not axis.rotary), *apart_by])
        notes = paragraphs(
            "axiscal.tables",
            "isg.jinja",
            file=_FILE,
            records=sum(curve.values.size for curve in found.values()),
            flip=options.flip,
            against=[axis.name for axis in machine.axes if axis.reversed],
            chain=machine.chain,
            lists=lists,
        )
        holds = _HOLDS.format(_BOTH * any(curve.over for curve in found.values()) + (_APART if lists else ""))
        wanted = sum_of(tip_control(estimate.machine, found), table_control(machine, halves))
        written = Written(files, steps, notes, holds, first=sign_said(options, _SIGN))
        return self.draft(written, wanted, machine, options, halves)

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what the kernel makes of files of either kind; raises TableError.

        The list file says where the others are and nothing else. Where the tool and rotary axes lie is no compensation.
        """
        lists = tuple(read_list(file.text, machine) for file in files if "kw.ssfk." in file.text)
        texts = (file.text for file in files if "kw.ssfk." not in file.text and "file_format[0]" not in file.text)
        found = (pair for text in texts for pair in read_csv(text, machine).items())
        return Loaded(lists, errors={name: error for name, error in found if not name.startswith("P")})

    def _errors(self, estimate: Estimate, options: ExportOptions) -> dict[str, SampledError]:
        """Return what the files are to hold; raises TableError."""
        grids = {
            k: points(estimate.model, k, options.spacing, _RECORDS, _MULTIPLE[axis.rotary])
            for k, axis in enumerate(estimate.machine.axes)
        }
        found = curves(estimate, grids, together=True)
        if other := next((name for name in found if not NAMES.fullmatch(name)), None):
            remedy = "it has axes X Y Z A B C only"
            raise TableError("{name} is not an error that the ISG kernel knows", remedy, name=other)
        if not found:
            raise TableError("there is no deviation that these files could hold", "take readings first")
        return anchored(estimate.machine, found) | nominal(estimate.machine)


def apart(estimate: Estimate, options: ExportOptions) -> tuple[CompensationTable, ...]:
    """Return what each direction of an axis is off by beside the mean of both, for axes with a reversal."""
    tables = axis_tables(estimate, options.spacing, _RECORDS, _MULTIPLE)
    halves = (replace(t, forward=(t.forward - t.reverse) / 2, reverse=(t.reverse - t.forward) / 2) for t in tables)
    units = {axis.name: list_unit(axis.unit) for axis in estimate.machine.axes}
    return tuple(half for half in halves if np.max(np.abs(half.forward)) >= units[half.axis] / 2)


def nominal(machine: Machine) -> dict[str, SampledError]:
    """Return what the kernel has to know of the chain: where the tool is at zero, and where rotary axes lie."""
    places = {"P0{}": (0.0, 0.0, -machine.tool_length)}
    places |= {"P{}" + axis.name: axis.origin for axis in machine.axes if axis.rotary}
    return {
        name.format(direction): SampledError(np.zeros(1), np.array([value]))
        for name, place in places.items()
        for direction, value in zip("XYZ", place, strict=True)
    }
