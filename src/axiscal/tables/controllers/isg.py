"""All files for the ISG kernel and Beckhoff TwinCAT CNC (TF5280): error motions and location errors.

Every error motion is a table over its own axis, and the kernel, which knows the chain, moves the TCP back. An error of
two axes together is in the motion of the later one: a table over both.

ISG_CSV, written and read back by the documentation's rules (TF5280), and the list file. Columns stand under a header,
`#` begins a new one, `//` a comment; mm, deg and rad.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.error_names import error_named, side_name
from axiscal.numerics import Array
from axiscal.tables.exporter import Exporter, ExportOptions, Written, paragraphs, sign_said
from axiscal.tables.loaded import Loaded, OldFile
from axiscal.tables.sampling import backlash, hats_along, points
from axiscal.tables.surface import Control, Mesh, by_linear_axes, spanning_axes
from axiscal.units import format_quantity, from_unit, to_unit
from axiscal_core.machine import Machine
from axiscal_core.terms import Term

NAMES = re.compile(r"E[XYZABC][XYZABC]|[XYZABC]0[XYZABC]|P[XYZ][ABC]|P0[XYZ]")
_POINTS_PER_INTERVAL, _LINES = 4, 4000
"""Of a table over two axes: points as of one over one axis, as far as so many lines last."""
_NOTHING = 1e-12
"""m or rad: rounding."""
_RECORDS = 1000
"""Points of an axis that a table of the kernel may have; four an interval are rarely more than a hundred."""
_MULTIPLE = (1e-6, float(np.radians(1e-4)))
"""The grid of positions, m and rad: the decimals that are written."""
_FILE, _LIST = "volcomp.csv", "volcomp.lis"
_SIGN = "FCT-C26 and P-VOLC-00009 (negate) state how values are turned and not which sign they have"


@dataclass(frozen=True, eq=False, slots=True)
class SampledError:
    """One error at positions (n,) of its axis, m or rad; a constant has one position.

    over, across : another axis that it depends on as well, and positions (k,) of that; values are (k, n) then
    """

    positions: Array
    values: Array
    over: str = ""
    across: Array = field(default_factory=lambda: np.zeros(0))

    def at(self, position: Array, other: Array) -> Array:
        """Return it at positions (m,) of its axis and of the other one: linear between points, constant outside."""
        if self.over:
            return Mesh(self.positions, self.across, self.values).at(position, other)
        return np.interp(position, self.positions, self.values)


class Isg(Exporter):
    """ISG_CSV and the list file."""

    takes = frozenset({"--spacing", "--number"})
    unstated = "own"
    left_out = "reversals, and the orientation of the tool."

    def make(self, estimate: Estimate, options: ExportOptions) -> Written:
        """Return the files; raises TableError."""
        machine, found = estimate.machine, curves(estimate, options)
        if other := next((name for name in found if not NAMES.fullmatch(name)), None):
            remedy = "it has axes X Y Z A B C only"
            raise TableError("{name} is not an error that the ISG kernel knows", remedy, name=other)
        places = {"P0{}": (0.0, 0.0, -machine.tool_length)}  # of the tool at zero, and of rotary axes
        places |= {"P{}" + axis.name: axis.origin for axis in machine.axes if axis.rotary}
        found = anchored(machine, found)
        for name, place in places.items():
            for direction, value in zip("XYZ", place, strict=True):
                found[name.format(direction)] = SampledError(np.zeros(1), np.array([value]))
        units = {axis.name: "arcsec" if axis.rotary else "um" for axis in machine.axes}
        lost = {name: format_quantity(step, units[name], 3) for name, step in backlash(estimate).items() if step}
        values = {"file": _FILE, "flip": options.flip, "chain": machine.chain, "lost": lost}
        against = [axis.name for axis in machine.axes if axis.reversed]
        records = sum(curve.values.size for curve in found.values())
        notes = paragraphs("axiscal.tables", "isg.jinja", records=records, against=against, **values)
        both = "; what two axes do together as a table of the later one over both"
        holds = "every error motion as a table over its axis, and every location error: the control knows the chain{}."
        steps = {axis.name: 1e-8 for axis in machine.axes if not axis.rotary}
        files, first = {_FILE: write_csv(found, machine), _LIST: _list(machine, options)}, sign_said(options, _SIGN)
        holds = holds.format(both * any(curve.over for curve in found.values()))
        written = Written(files, steps, notes, holds, first=first)
        return self.draft(written, tip_control(machine, found), machine, options)

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what the kernel makes of files; raises TableError.

        The list file says where the other is and nothing else. Where the tool and rotary axes lie is no compensation.
        """
        read = (read_csv(file.text, machine) for file in files if "file_format[0]" not in file.text)
        errors = {name: error for each in read for name, error in each.items() if not name.startswith("P")}
        return Loaded(others=(tip_control(machine, errors),) if errors else ())


def curves(estimate: Estimate, options: ExportOptions) -> dict[str, SampledError]:
    """Return the error motions and location errors by name; raises TableError where there is none.

    What repeats with a period and what steps is part of its error motion. Reversal values have no place among them.
    A motion may depend on a second axis, so that it holds an error of two axes, the first that there is.
    """
    model, found, grids = estimate.model, dict[str, SampledError](), dict[int, Array]()
    for k, axis in enumerate(model.axes):
        grids[k] = points(model, k, options.spacing, _RECORDS, _MULTIPLE[axis.rotary])
    for function in model.curves:
        control, at = estimate.mean[function.columns], grids[function.axis]
        if function.kind == "location":
            found[function.name] = SampledError(np.zeros(1), control)
        elif function.kind == "motion":
            hats = hats_along(estimate, function.axis, at)
            values, name = hats.best(function.spline.rows(hats.nodes) @ control), _name(model, function)
            found[name] = SampledError(at, values + found[name].values if name in found else values)
    for plane in model.planes:
        _take_in(estimate, plane, grids, found)
    if not found:
        raise TableError("there is no deviation that these files could hold", "take readings first")
    return found


def _take_in(estimate: Estimate, plane: Term, grids: Mapping[int, Array], found: dict[str, SampledError]) -> None:
    """Add what two axes do together to the motion of the later one, where that depends on no other axis yet."""
    name, own, at = _name(estimate.model, plane), plane.axis, grids[plane.axis]
    ((other, intervals),) = ((side.axis, len(side.spline.knots) - 1) for side in plane.sides if side.axis != own)
    fit = max(min(_POINTS_PER_INTERVAL * intervals, _LINES // len(at) - 1), intervals)
    across = np.linspace(*estimate.machine.axes[other].travel, fit + 1)
    sides = [hats_along(estimate, axis, places) for axis, places in ((other, across), (own, at))]
    nodes = np.meshgrid(sides[0].nodes, sides[1].nodes, indexing="ij")
    places = {other: nodes[0].ravel(), own: nodes[1].ravel()}
    seen = plane.rows(*(places[axis] for axis in plane.axes)) @ estimate.mean[plane.columns]
    values = sides[1].best(sides[0].best(seen.reshape(nodes[0].shape)).T).T
    before = found.get(name, SampledError(at, np.zeros(len(at))))
    if not before.over and np.max(np.abs(values)) >= _NOTHING:
        found[name] = SampledError(at, before.values + values, estimate.machine.axes[other].name, across)


def anchored(model: Machine, found: Mapping[str, SampledError]) -> dict[str, SampledError]:
    """Return the errors with constants taken off so that the tool stays where it is at machine zero.

    With rotary axes the place of the rotor matters and nothing is taken off. A constant goes into a displacement along
    its direction, the positioning of an axis first; where the machine has none it stays.
    """
    result, zero = dict(found), np.array([model.zero])
    at_zero = _deviation(model, found, zero)[0] * (not any(axis.rotary for axis in model.axes))
    for direction, constant in enumerate(at_zero):
        own = [f for f in model.curves if f.kind == "motion" and f.component == direction and _name(model, f) in found]
        for function in sorted(own, key=lambda f: f.name != model.axes[f.axis].positioning_error)[:1]:
            sign, name = model.axes[function.axis].sign, _name(model, function)
            result[name] = replace(found[name], values=found[name].values - sign * constant)
    return result


def tip_control(model: Machine, found: Mapping[str, SampledError]) -> Control:
    """Return the control that takes the TCP deviation of these errors away with its linear axes.

    Raises TableError when the machine has not three linear axes that span space.
    """
    taken = by_linear_axes(model, spanning_axes(model, fewest=3))
    return lambda poses, approaches: taken(poses, _deviation(model, found, poses))


def _deviation(model: Machine, found: Mapping[str, SampledError], poses: Array) -> Array:
    """Return what the errors do to the TCP, (m, 3), m."""
    named = {_name(model, term): i for i, term in reversed([*enumerate(model.terms)]) if term.kind != "reversal"}
    chosen = {name: named[name] for name in found if name in named}
    values = []
    for name, index in chosen.items():
        other = model.index(found[name].over) if found[name].over else model.terms[index].axis
        values.append(found[name].at(poses[:, model.terms[index].axis], poses[:, other]))
    deviation: Array = np.einsum("fmc,fm->mc", model.levers(poses)[list(chosen.values())], np.stack(values))
    return deviation


def _name(model: Machine, term: Term) -> str:
    """Return the name of the error motion that a term is, or is part of: of two axes that of the later one."""
    own = side_name(term.component, model.axes[term.axis].name)
    return own if term.kind == "motion" else term.name


def _list(machine: Machine, options: ExportOptions) -> str:
    """Return the configuration of one compensation, as TF5280 has it."""
    workpiece = sum(axis.workpiece_side for axis in machine.axes)
    negate = "".join(axis.name for axis in machine.axes if not axis.rotary) if options.flip else ""
    lines = [f"{axis} {number}" for axis, number in options.numbered(machine).items()]
    lines += [f"chain {''.join(axis.name for axis in machine.axes)}", f"workpiece_axes {workpiece}"]
    lines += [f"negate {negate}"] if negate else []
    return "\n".join([*lines, "interpolation GRID", f"file[0] {_FILE}", "file_format[0] ISG_CSV", ""])


def write_csv(found: Mapping[str, SampledError], machine: Machine) -> str:
    """Return the ISG_CSV text: constants, errors over each axis, and each that depends on two axes at all pairs."""
    groups = dict[tuple[str, ...], dict[str, SampledError]]()
    for name, curve in found.items():
        own = error_named(name).axis if len(curve.positions) > 1 else ""
        groups.setdefault((name, curve.over, own) if curve.over else (own,), {})[name] = curve
    order = ["", *(axis.name for axis in machine.axes)]
    blocks = []
    for key, errors in sorted(
        groups.items(), key=lambda group: order.index(group[0][-1]) if len(group[0]) == 1 else 99
    ):
        first, names = next(iter(errors.values())), [name for name in key[-2:] if name]
        at = np.meshgrid(first.across, first.positions, indexing="ij") if first.over else [first.positions]
        places = zip(names, at, strict=False)
        columns = [[f"{place:.6f}" for place in to_unit(each.ravel(), machine.axis(k).unit)] for k, each in places]
        for name, curve in errors.items():
            columns.append([f"{value + 0.0:.9e}" for value in to_unit(curve.values.ravel(), _unit(name))])
        lines = [[*names, *errors], *zip(*columns, strict=True)]
        blocks.append("".join(" ".join(words) + "\n" for words in lines))
    return "// mm, deg and rad\n" + "#\n".join(blocks)


def read_csv(text: str, machine: Machine) -> dict[str, SampledError]:
    """Return the errors of an ISG_CSV text; raises TableError where the kernel would report 70468 or 70469."""
    found, axes = dict[str, SampledError](), {axis.name: axis for axis in machine.axes}
    for block in re.split(r"^#\s*$", re.sub(r"//.*", "", text), flags=re.MULTILINE):
        header, *lines = (line.split() for line in block.splitlines() if line.strip())
        columns = dict(zip(header, np.array(lines, dtype=float).T, strict=True))
        at = {name: from_unit(columns.pop(name), axes[name].unit) for name in header if name in axes}
        if wrong := next((name for name in columns if not NAMES.fullmatch(name) or name in found), ""):
            remedy = "this is a defect of axiscal"
            raise TableError("the kernel would refuse the column {name!r}", remedy, name=wrong[:20])
        for name, each in columns.items():
            found[name] = SampledError(next(iter(at.values()), np.zeros(1)), from_unit(each, _unit(name)))
            if len(at) == 2:  # the later axis and another one
                own = error_named(name).axis
                (other,) = (axis for axis in at if axis != own)
                (positions, inner), (across, outer) = (np.unique(at[k], return_inverse=True) for k in (own, other))
                grid = np.full((len(across), len(positions)), np.nan)
                grid[outer, inner] = found[name].values
                found[name] = SampledError(positions, grid, other, across)
    return found


def _unit(name: str) -> str:
    """Return the unit of an error, mm or rad; of places of the chain mm."""
    return "rad" if not name.startswith("P") and error_named(name).angular else "mm"
