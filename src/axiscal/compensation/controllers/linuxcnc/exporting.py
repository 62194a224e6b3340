"""All files for a LinuxCNC: a `COMP_FILE` for each axis, HAL text for the axes over other axes, and notes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from axiscal.belief import Belief
from axiscal.compensation.controllers.linuxcnc import cross, pivots
from axiscal.compensation.controllers.linuxcnc.hal import Hal
from axiscal.compensation.controllers.linuxcnc.reader import ROWS, LinuxcncTable, correction, parse
from axiscal.compensation.controllers.linuxcnc.turns import one_turn, over_turns
from axiscal.compensation.controllers.linuxcnc.writer import offer, resolution
from axiscal.compensation.effect import Control, table_control
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.offer import Draft
from axiscal.compensation.sampling import axis_tables, cross_tables
from axiscal.compensation.surface import sum_of
from axiscal.compensation.table import CompensationTable
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.units import from_unit, to_unit

_HAL_FILE = "axiscal-cross.hal"
_PIVOT_FILE = "axiscal-pivots.hal"
_PIVOT_NOTE = (
    "axiscal-pivots.hal sets where the rotary axes lie for {}: {} are in it and not in the tables. The values count "
    "from the machine's zero, with the spindle nose at its origin; shift them if your configuration counts otherwise."
)
_HOLDS = (
    "one COMP_FILE for each axis (its own positions, both directions) and HAL text that moves linear axes over the "
    "positions of other linear axes."
)
_LEFT = (
    "errors that depend on two axes at once (angular errors times a lever that changes), the orientation of the tool, "
    "and the reversal of straightness."
)


def make(estimate: Estimate, options: ExportOptions) -> Draft:
    """Return the files; raises TableError."""
    machine = estimate.machine
    joints = options.joints(machine)
    lies = _pivots(estimate) if options.pivots else None
    estimate = _without(estimate, pivots.names(machine)) if lies else estimate
    new = tuple(one_turn(estimate, t) for t in axis_tables(estimate, options.spacing, ROWS))
    own = tuple(over_turns(t, machine) for t in options.old.within().under_tables(new, machine, ROWS))
    across = cross_tables(estimate, most=cross.POINTS, uneven=options.spacing is None)
    across = options.old.across().under_tables(across, machine, cross.POINTS, even=True)
    over = tuple(t.averaged() for t in across)  # a lincurve has no direction
    offers = [
        offer(t, unit=_unit(t, options), joints=joints[t.axis], acceleration=machine.axis(t.axis).acceleration)
        for t in own
    ]
    files = {file.name: file.text for file in offers}
    wiring = cross.Wiring(joints, {axis.name: axis.speed for axis in machine.axes}, options.unit)
    files |= {_HAL_FILE: cross.write(over, wiring)} if over else {}
    notes = tuple(dict.fromkeys(note for file in offers for note in file.notes)) + _hal_notes(machine, over)
    wanted = table_control(machine, (*own, *over))
    held = control(machine, files, wiring)
    steps = _resolution(own, over, options)
    if lies:
        files[_PIVOT_FILE] = pivots.write(lies, options.unit)
        nominal = pivots.pivots(machine, {})
        wanted = sum_of(wanted, pivots.control(machine, nominal, lies))
        held = sum_of(held, pivots.control(machine, nominal, pivots.read(files[_PIVOT_FILE], options.unit)))
        steps |= {name: steps.get(name, 0.0) + float(from_unit(4e-7, options.unit)) for name in "XYZ"}
        notes += (_PIVOT_NOTE.format(lies.kinematics, ", ".join(pivots.names(machine))),)
    return Draft(files, held, wanted, steps, (*own, *over), _HOLDS, _LEFT, notes, tried=True)


def _pivots(estimate: Estimate) -> pivots.Pivots:
    model = estimate.model
    known = {
        name: float(estimate.mean[model.names[name].columns][0])
        for name in pivots.names(estimate.machine)
        if name in model.names
    }
    return pivots.pivots(estimate.machine, known)


def _without(estimate: Estimate, names: Sequence[str]) -> Estimate:
    """Return the estimate of a machine that has not these errors."""
    mean = estimate.belief.mean.copy()
    for name in names:
        if name in estimate.model.names:
            mean[estimate.model.names[name].columns] = 0.0
    return replace(estimate, belief=Belief(mean, estimate.belief.covariance))


def control(machine: Machine, files: Mapping[str, str], wiring: cross.Wiring) -> Control:
    """Return what LinuxCNC does with the files once all joints are homed."""
    own = {axis.name: parse(files[f"{axis.name}.comp"]) for axis in machine.axes if f"{axis.name}.comp" in files}
    hal = Hal.load(files.get(_HAL_FILE, ""))
    units = ["deg" if axis.rotary else wiring.unit for axis in machine.axes]

    def added(poses: Array, approaches: Array) -> Array:
        shown = np.stack([to_unit(column, u) for column, u in zip(poses.T, units, strict=True)], axis=1)
        motors = np.stack([_motor(own.get(a.name), shown[:, k], approaches[:, k]) for k, a in enumerate(machine.axes)])
        driven = _through(hal, machine, wiring, shown.T, motors)
        return np.stack([from_unit(t - s, u) for t, s, u in zip(driven, shown.T, units, strict=True)], axis=1)

    return added


def _motor(table: LinuxcncTable | None, shown: Array, approach: Array) -> Array:
    if table is None:
        return shown
    sides = [correction(table, shown, side) for side in (1, -1)]
    return shown + np.where(approach > 0, *sides)


def _through(hal: Hal, machine: Machine, wiring: cross.Wiring, shown: Array, motors: Array) -> Array:
    """Return where the drives are sent, (q, m), after HAL has added its part.

    Raises TableError when the joints of one axis would not go together.
    """
    given: dict[str, Array] = {"motion.is-all-homed": np.ones(1)}
    for k, axis in enumerate(machine.axes):
        for joint in wiring.joints[axis.name]:
            given |= {f"joint.{joint}.pos-cmd": shown[k], f"joint.{joint}.motor-pos-cmd": motors[k]}
    signals = hal.run(given)
    driven = np.empty_like(motors)
    for k, axis in enumerate(machine.axes):
        labels = wiring.labels(axis.name).values()
        each = np.stack([signals.get(f"axiscal-{label}-motor", motors[k]) for label in labels])
        if not np.all(each == each[0]):
            raise TableError(f"the joints of {axis.name} would not go together", "this is a defect of axiscal")
        driven[k] = each[0]
    return driven


def _unit(table: CompensationTable, options: ExportOptions) -> str:
    return "deg" if table.rotary else options.unit


def _resolution(
    own: Sequence[CompensationTable], over: Sequence[CompensationTable], options: ExportOptions
) -> dict[str, float]:
    steps: dict[str, float] = {}
    for table in own:
        steps[table.axis] = resolution(table, _unit(table, options))
    for table in over:
        rounding = float(from_unit(1e-7, options.unit)) + _steepest(table) * float(from_unit(1e-6, options.unit))
        steps[table.axis] = steps.get(table.axis, 0.0) + rounding
    return steps


def _steepest(table: CompensationTable) -> float:
    return float(np.max(np.abs(np.diff(table.forward) / np.diff(table.positions))))


def _hal_notes(machine: Machine, over: Sequence[CompensationTable]) -> tuple[str, ...]:
    notes = []
    if over:
        notes.append(
            f"{_HAL_FILE} corrects axes over other axes: its first lines say how to wire it. Without it the COMP_FILEs "
            "work alone. It acts once all joints are homed, within a second, and stops acting while one is not."
        )
    if any(axis.rotary for axis in machine.axes):
        notes.append(
            "COMP_FILEs act on joints: with xyzac-trt-kins and its kin they are right as well, the HAL text too."
        )
    return tuple(notes)
