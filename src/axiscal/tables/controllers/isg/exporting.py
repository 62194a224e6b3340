"""All files for the ISG kernel and Beckhoff TwinCAT CNC (TF5280): error motions and location errors, and reversal.

The volumetric compensation has no direction; a bilateral leadscrew table of each axis holds what its directions are
apart, half to each side.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.tables.controllers.isg import leadscrew
from axiscal.tables.controllers.isg.formats import (
    NAMES,
    list_file,
    read_csv,
    write_csv,
)
from axiscal.tables.effect import table_control
from axiscal.tables.export_options import ExportOptions
from axiscal.tables.exporter import Exporter, Written, summed
from axiscal.tables.loaded import Loaded, Lookup
from axiscal.tables.offer import Draft
from axiscal.tables.old_files import OldFile
from axiscal.tables.sampling import axis_tables, points
from axiscal.tables.surface import sum_of
from axiscal.tables.table import CompensationTable
from axiscal.tables.volumetric import SampledError, anchored, curves, tip_control, together

_HOLDS = "every error motion as a table over its axis, and every location error: the control knows the chain{}."
_BOTH = "; what two axes do together as a table of the later one over both"
_APART = "; and what each axis is apart between its directions"
_RECORDS = 1000
"""Points of an axis that a table of the kernel may have; four an interval are rarely more than a hundred."""
_REMEDY = "give the files that the kernel loads: ISG_CSV, and leadscrew lists (kw.ssfk)"
_FILE = "volcomp.csv"
_MULTIPLE = (1e-6, float(np.radians(1e-4)))
"""The grid of positions, m and rad: the decimals that are written."""


class Isg(Exporter):
    """ISG_CSV, the list file, and leadscrew tables of axes with a reversal."""

    left_out = "the reversal of straightness and of angles, and the orientation of the tool."

    def make(self, estimate: Estimate, options: ExportOptions) -> Draft:
        """Return the files; raises TableError."""
        machine, found = estimate.machine, self._errors(estimate, options)
        halves = options.old.within().under_tables(apart(estimate, options), machine, _RECORDS, even=True)
        lists = leadscrew_files(machine, halves, options)
        listed = list_file(machine, options, _FILE)
        files = {_FILE: write_csv(found, machine), "volcomp.lis": listed, **lists}
        apart_by = [(t.axis, 0.5 * leadscrew.unit(machine.axis(t.axis).unit) + 1e-12) for t in halves]
        steps = summed([*((axis.name, 1e-8) for axis in machine.axes if not axis.rotary), *apart_by])
        notes = _notes(machine, found, options.flip) + _leadscrew_notes(lists)
        holds = _HOLDS.format(_BOTH * any(curve.over for curve in found.values()) + (_APART if lists else ""))
        held = self.held(Written(files, steps, notes), machine, options)
        wanted = sum_of(tip_control(estimate.model, found), table_control(machine, halves))
        return Draft(files, held, wanted, steps, halves, holds, self.left_out, notes, tried=False)

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what the kernel makes of files of either kind; raises TableError.

        The list file says where the others are and nothing else. Where the tool and rotary axes lie is no compensation.
        """
        errors, lookups = dict[str, SampledError](), list[Lookup]()
        for file in files:
            try:
                if "kw.ssfk." in file.text:
                    lookups += leadscrew.read(file.text, machine)
                elif "file_format[0]" not in file.text:
                    errors |= {n: e for n, e in read_csv(file.text, machine).items() if not n.startswith("P")}
            except (TableError, ValueError, LookupError) as fault:
                what = fault.what if isinstance(fault, TableError) else "this is no table of the ISG kernel"
                raise TableError(what, _REMEDY, file.name) from None
        if not errors and not lookups:
            raise TableError("no error and no leadscrew table is in these files", _REMEDY, files[0].name)
        return Loaded(tuple(lookups), errors=errors)

    def _errors(self, estimate: Estimate, options: ExportOptions) -> dict[str, SampledError]:
        """Return what the files are to hold, that of the old ones added; raises TableError."""
        grids = {
            k: points(estimate.model, k, options.spacing, _RECORDS, _MULTIPLE[axis.rotary])
            for k, axis in enumerate(estimate.machine.axes)
        }
        found = curves(estimate, grids, together=True)
        _refuse_names(found)
        if not found:
            raise TableError("there is no deviation that these files could hold", "take readings first")
        return together(anchored(estimate.model, found), options.old.errors) | nominal(estimate.machine)


def apart(estimate: Estimate, options: ExportOptions) -> tuple[CompensationTable, ...]:
    """Return what each direction of an axis is off by beside the mean of both, for axes with a reversal."""
    tables = axis_tables(estimate, options.spacing, _RECORDS, _MULTIPLE)
    halves = (replace(t, forward=(t.forward - t.reverse) / 2, reverse=(t.reverse - t.forward) / 2) for t in tables)
    units = {axis.name: leadscrew.unit(axis.unit) for axis in estimate.machine.axes}
    return tuple(half for half in halves if np.max(np.abs(half.forward)) >= units[half.axis] / 2)


def leadscrew_files(machine: Machine, halves: Sequence[CompensationTable], options: ExportOptions) -> dict[str, str]:
    """Return the bilateral tables by the names of their files."""
    numbers = options.numbered(machine)
    return {
        f"ssfk_{half.axis}.lis": leadscrew.write(half, numbers[half.axis], machine.axis(half.axis).cyclic)
        for half in halves
    }


def nominal(machine: Machine) -> dict[str, SampledError]:
    """Return what the kernel has to know of the chain: where the tool is at zero, and where rotary axes lie."""
    places = {"P0{}": (0.0, 0.0, -machine.tool)}
    places |= {"P{}" + axis.name: axis.origin for axis in machine.axes if axis.rotary}
    return {
        name.format(direction): SampledError(np.zeros(1), np.array([value]))
        for name, place in places.items()
        for direction, value in zip("XYZ", place, strict=True)
    }


def _refuse_names(found: Mapping[str, SampledError]) -> None:
    for name in found:
        if not NAMES.fullmatch(name):
            remedy = "it has axes X Y Z A B C only"
            raise TableError("{name} is not an error that the ISG kernel knows", remedy, name=name)


def _notes(machine: Machine, found: Mapping[str, SampledError], flip: bool) -> tuple[str, ...]:
    records = sum(curve.values.size for curve in found.values())
    negated = " The list file negates them, as --flip asks." if flip else ""
    return (
        f"Put volcomp.lis and {_FILE} where the start-up list names them: vol_comp[0].file_name volcomp.lis and "
        f"vol_comp[0].max_records {records} or more.",
        "In the NC program: #VOLCOMP OFF [ID0], #VOLCOMP [ID0 UPDATE], #VOLCOMP ON [ID0].",
        "Errors say what the moving component does in machine directions, also where it carries the workpiece; "
        "rotations turn about the axis frames of axiscal's conventions: that of a linear axis is at the origin of the "
        f"machine when all axes are at zero. Check one point with a dial gauge; use --flip if it goes wrong.{negated}",
        f"The chain {machine.chain} has to be the control's own. P0X to P0Z give the tool at zero, PXA and so on where "
        "rotary axes lie, both from the machine's origin.",
        "The kernel corrects the position of the tool, not its orientation.",
    )


def _leadscrew_notes(lists: Mapping[str, str]) -> tuple[str, ...]:
    if not lists:
        return ()
    return (
        f"{', '.join(lists)}: bilateral leadscrew tables (kw.ssfk) that hold what the directions are apart, half to "
        "each side, beside the volumetric compensation, which has no direction. Give each as the compensation value "
        "list of its axis, set lr_param.ssfk 1, and leave no backlash compensation active on these axes.",
        "Their values are actual position less setpoint, 0.1 um and 1e-4 deg (TF5200); the kernel takes them away, and "
        "--flip leaves them as they are.",
    )
