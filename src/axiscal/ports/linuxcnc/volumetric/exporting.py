"""All files for the component: the machine's errors, the HAL text, the source, and notes.

What the component makes of a file: errors, chain and joints once more, over many poses at a time.

It shares no line with the writer and no kinematics with the machine's model: a sign that is wrong on one side shows.

What a control does that knows the chain and every error: rotary axes turn their own error back, linear ones the tip.

    Δ_k = -s_k ε_kk of a rotary axis;  [u_x u_y u_z] Δ = -δp without these for the linear axes

and the same once more at the positions to which the axes are sent.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import resources

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.estimation.accuracy.other_tool import other_tool
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.numerics.rigid import about
from axiscal.ports.linuxcnc.volumetric import vcomp_reading, vcomp_writing
from axiscal.ports.linuxcnc.volumetric.content import (
    FADE_DEG,
    FADE_MM,
    LEAST_DETERMINANT,
    MOTIONS,
    VcompAxis,
    VcompFile,
)
from axiscal.ports.linuxcnc.volumetric.patching import FILE, HAL_FILE, hal_text
from axiscal.tables.effect import Control, by_linear_axes
from axiscal.tables.export_options import ExportOptions
from axiscal.tables.exporter import Exporter, Written
from axiscal.tables.loaded import Loaded
from axiscal.tables.offer import Draft, spread_poses
from axiscal.tables.old_files import OldFile
from axiscal.units import format_quantity, from_unit, to_unit

_INCH = 25.4
"""By definition: mm of an inch."""

SOURCES = ("axiscal_vcomp.comp", "axiscal_vcomp_core.h")
_NOTHING = 1e-12
"""m or rad: rounding."""
_MARGIN, _LEAST = 1.5, 5e-6
"""Share and m or rad beyond the largest correction over the volume at which the component says fault 1."""
_SHARE, _QUICKEST, _SLOWEST = 0.2, 5e-3, 5.0
"""Of a joint's acceleration that a reversal may take, and how many s it takes at least and at most."""
_EVERY = 5
"""Of the poses at which files are tried, for a time that may be a few percent off."""
_AWAY = 1e-9
"""m or rad: what twelve digits may leave."""


class LinuxcncVolumetric(Exporter):
    """One file of every error for the realtime component, with the component itself."""

    holds = (
        "every error motion, squareness, location error and reversal of the machine as one realtime correction of all "
        "joints, between motion and drives: axiscal.vcomp is read by the component axiscal_vcomp when LinuxCNC starts."
    )
    left_out = (
        "the orientation of the tool beyond what rotary axes turn too far about themselves, what no spline follows, "
        "and errors that one tool length cannot show."
    )
    tried = True

    def make(self, estimate: Estimate, options: ExportOptions) -> Draft:
        """Return the files; raises TableError."""
        _refuse(options)
        wanted, machine = whole_control(estimate.model, estimate.mean), estimate.machine
        poses, _ = spread_poses(estimate)
        sides = [wanted(poses, way * np.ones_like(poses)) for way in (1.0, -1.0)]
        largest = np.max(np.abs(sides), axis=(0, 1))
        if np.max(largest) <= _NOTHING:
            return Draft({}, wanted, wanted, {}, (), self.holds, self.left_out, (), tried=True)
        file = _content(estimate, options, largest)
        joints = [n for axis in file.axes for n in axis.joints]
        source = resources.files(__package__)
        files = {FILE: vcomp_writing.text_of(file), HAL_FILE: hal_text(joints)}
        files |= {name: source.joinpath(name).read_text(encoding="ascii") for name in SOURCES}
        notes, steps = _notes(estimate, file), {axis.name: _AWAY for axis in machine.axes}
        held = self.held(Written(files, steps, notes), machine, options)
        said = (self.holds, self.left_out, notes)
        return Draft(files, held, wanted, steps, (), *said, tried=True, first=_first(file))

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what the component makes of its files; raises TableError."""
        own = [file for file in files if file.name.lower().endswith(".vcomp")]
        if not own:
            names = ", ".join(dict.fromkeys(file.name for file in files))
            raise TableError(f"{names} is no file of the component", "give axiscal.vcomp")
        read = (component_control(vcomp_reading.read(file.text, file.name), machine) for file in own)
        return Loaded(others=tuple(read))


def _refuse(options: ExportOptions) -> None:
    """Raise TableError for choices that the whole correction has no use for."""
    if options.pivots:
        what = "--pivots puts location errors into the kinematics, and this file holds them already"
        raise TableError(what, "leave --pivots out: the kinematics keep the origins of machine.toml")
    if options.old_files:
        what = "the whole correction cannot go on top of another one"
        raise TableError(what, "measure with axiscal-vcomp.active false and without COMP_FILE and BACKLASH")
    if options.spacing is not None:
        raise TableError("the file holds the curves themselves, and --spacing says points", "leave --spacing out")


def _content(estimate: Estimate, options: ExportOptions, largest: Array) -> VcompFile:
    model, unit = estimate.model, options.unit
    axes = model.machine.axes
    joints = vcomp_writing.joints_of(options.joints(model.machine), axes)
    linear = [k for k, axis in enumerate(axes) if not axis.rotary]
    turning = [k for k, axis in enumerate(axes) if axis.rotary]
    own = [
        vcomp_writing.axis_content(model, estimate.mean, k, joints[axis.name], unit, seconds)
        for k, (axis, seconds) in enumerate(zip(axes, reversal_times(model, estimate.mean, estimate), strict=True))
    ]
    if not turning:
        own = list(vcomp_writing.anchored(own, to_unit(1.0, unit) * at_zero(model, estimate.mean)))
    furthest = max(_MARGIN * float(np.max(largest[linear])), _LEAST)
    turned = max(_MARGIN * float(np.max(largest[turning], initial=0.0)), _LEAST)
    tool = np.array([0.0, 0.0, -to_unit(model.machine.tool, unit)])
    name = {"mm": "mm", "in": "inch"}[unit]
    limits = float(to_unit(furthest, unit)), float(to_unit(turned, "deg"))
    return VcompFile(options.origin[:16] or "none", name, *limits, tool, tuple(own))


def reversal_times(model: ErrorModel, mean: Array, estimate: Estimate) -> list[float]:
    """Return for each axis how long its reversal takes, s: T = sqrt(4 J / (0.2 a)), J the step of a joint at any pose.

    a : the acceleration of that joint; a reversal then takes a fifth of it.
    """
    control = whole_control(model, mean)
    poses = spread_poses(estimate)[0][::_EVERY]
    accelerations = np.array([axis.acceleration for axis in model.machine.axes])
    times = []
    for k in range(len(accelerations)):
        way = np.zeros_like(poses)
        way[:, k] = 1.0
        step = np.max(np.abs(control(poses, way) - control(poses, -way)), axis=0)
        time = float(np.max(np.sqrt(4 * step / (_SHARE * accelerations))))
        times.append(min(max(time, _QUICKEST), _SLOWEST))
    return times


def _first(file: VcompFile) -> tuple[str, ...]:
    unit = file.unit
    turned = f" and {file.limit_deg:.4g} deg" if any(axis.rotary for axis in file.axes) else ""
    limit = f"{file.limit:.4g} {unit}{turned}"
    return (
        f"THIS MOVES YOUR DRIVES BEHIND LINUXCNC'S BACK by up to {limit}. {vcomp_writing.STATEMENT}",
        "First run: spindle stopped, tool clear, axiscal-vcomp.enable off. Compare the pin axiscal-vcomp.largest with "
        f"{file.limit:.4g} {unit}. Switch on: the machine moves by that much within a second. At three places check "
        "with a dial gauge that the deviation of the report became smaller; if it doubled, switch off: a sign or a "
        "joint is wrong. COMP_FILE and BACKLASH must be out of the INI.",
    )


def _notes(estimate: Estimate, file: VcompFile) -> tuple[str, ...]:
    lies = "; ".join(
        f"{axis.name} at x {axis.origin[0]:.6g}, y {axis.origin[1]:.6g}, z {axis.origin[2]:.6g} {file.unit}"
        for axis in file.axes
        if axis.rotary
    )
    longer = other_tool(estimate.model, estimate.belief, estimate.box, counted=estimate.counted)
    notes = [
        "Once on every machine (Debian: linuxcnc-uspace-dev and gcc): sudo halcompile --install axiscal_vcomp.comp, in "
        "the folder of these files. A campaign brings a new axiscal.vcomp only. uspace only.",
        f"Put {FILE} and {HAL_FILE} beside the INI file; the first lines of {HAL_FILE} say how to "
        "wire it. LinuxCNC does not start, and one sentence says why, where unit, joints or axes differ from the INI "
        "file, or a character of the file was changed.",
        "Soft limits, positions shown and the following error are those without the correction: keep "
        f"{file.limit:.4g} {file.unit} to the switches. Give the drives 1.2 times MAX_ACCELERATION.",
        "A campaign is measured with axiscal-vcomp.active false, its verification with active true.",
        *([longer.words] if longer.costs else []),
        "Faults: 1 over the limit, 2 not finite, 3 COMP_FILE or BACKLASH works as well, 4 the linear axes do not span "
        "space. The correction then goes within ramp-time; enable off, reset, and find out why.",
        *_reversals(estimate, file),
    ]
    if lies:
        notes.insert(
            3,
            f"The location errors of rotary axes stand in the file: the kinematics keep the origins of machine.toml, "
            f"{lies} (machine zero, spindle nose). Compare them with your pivot pins, and load no axiscal-pivots.hal.",
        )
    return tuple(notes)


def _reversals(estimate: Estimate, file: VcompFile) -> list[str]:
    several = [axis for axis in file.axes if axis.reversals.shape[1]]
    if not several:
        return []
    said = ", ".join(f"{axis.name} {format_quantity(axis.seconds, 's', 3)}" for axis in several)
    return [
        f"A reversal is carried out after 0.5 um or 0.0005 deg the other way, within {said} (from the accelerations "
        "in machine.toml); after homing, before an axis has moved, the mean of both sides is applied."
    ]


def component_control(file: VcompFile, machine: Machine) -> Control:
    """Return what the component adds to the joints; raises TableError when its axes are not those of the machine."""
    names = [axis.name for axis in machine.axes]
    if [axis.name for axis in file.axes] != names:
        raise TableError(f"the file has axes {' '.join(a.name for a in file.axes)}", f"{' '.join(names)} are expected")
    units = ["deg" if axis.rotary else {"mm": "mm", "inch": "in"}[file.unit] for axis in file.axes]

    def added(poses: Array, approaches: Array) -> Array:
        joints = np.stack([to_unit(column, u) for column, u in zip(poses.T, units, strict=True)], axis=1)
        further = correction(file, joints, approaches)
        return np.stack([from_unit(column, u) for column, u in zip(further.T, units, strict=True)], axis=1)

    return added


def correction(file: VcompFile, joints: Array, ways: Array, tool: Array | None = None) -> Array:
    """Return what is added to the joints of each axis, (m, q), units of the file.

    joints : (m, q) in chain order; ways : (m, q) from -1 to 1; tool : (3,) where it is not that of the campaign
    Raises TableError where the linear axes do not span space.
    """
    sense = np.array([axis.sense for axis in file.axes])
    tip = file.tool if tool is None else tool
    first = _once(file, sense * joints, sense * ways, tip)
    return sense * _once(file, sense * joints + first, sense * ways, tip)


def joint_errors(axis: VcompAxis, at: Array, ways: Array, unit: str) -> Array:
    """Return the errors of an axis (m, 6) at positions by ISO 841 (m,): motion + way reversal / 2 + location."""
    low, high = axis.knots[[0, -1]]
    fade = FADE_DEG if axis.rotary else FADE_MM if unit == "mm" else FADE_MM / _INCH
    inside = low + np.mod(at - low, high - low) if axis.cyclic else np.clip(at, low, high)
    beyond = np.zeros_like(at) if axis.cyclic else at - inside
    far = np.minimum(np.abs(beyond), fade)
    faded = np.sign(beyond) * (far - far**2 / (2 * fade))
    found = np.clip(np.searchsorted(axis.knots, inside, side="right") - 1, 0, len(axis.knots) - 2)
    x = (inside - axis.knots[found])[:, None]

    def value(curves: Array) -> Array:
        a, b, c, d = np.moveaxis(curves[found], 2, 0)
        straight: Array = a + x * (b + x * (c + x * d)) + faded[:, None] * (b + x * (2 * c + 3 * x * d))
        return straight

    total: Array = value(axis.motions) + axis.place
    if axis.reversals.shape[1] == MOTIONS:
        total = total + 0.5 * ways[:, None] * value(axis.reversals)
    return total


def _once(file: VcompFile, at: Array, ways: Array, tool: Array) -> Array:
    """Return what the axes are to be sent further, (m, q), walking from the tool to the workpiece."""
    count = len(at)
    point, off, out = np.tile(tool, (count, 1)), np.zeros((count, 3)), np.zeros_like(at)
    moves: dict[int, Array] = {}
    for k in reversed(range(len(file.axes))):
        axis = file.axes[k]
        found, e = joint_errors(axis, at[:, k], ways[:, k], file.unit), np.eye(3)[axis.along]
        if axis.rotary:
            angle = np.radians(at[:, k])
            own = found[:, 3 + axis.along].copy()
            out[:, k] = np.degrees(-axis.side * own)
            turn = found[:, 3:] - own[:, None] * e
            point = point - axis.origin
            if axis.side > 0:
                point, off = about(axis.along, point, angle), about(axis.along, off, angle)
            off = off + axis.side * (found[:, :3] + np.cross(turn, point))
            if axis.side < 0:
                point, off = about(axis.along, point, angle), about(axis.along, off, angle)
            moves = {i: about(axis.along, u, angle) for i, u in moves.items()}
            point = point + axis.origin
            continue
        way = at[:, k, None] * e
        carried = point if axis.side > 0 else point + way
        off = off + axis.side * (found[:, :3] + np.cross(found[:, 3:], carried)) + np.cross(axis.tilt, way)
        point, moves[k] = point + way, np.tile(e, (count, 1))
    directions = np.stack(list(moves.values()), axis=2)
    if np.any(np.abs(np.linalg.det(directions)) < LEAST_DETERMINANT):
        raise TableError("the linear axes do not span space at some poses", "keep the volume away from there")
    out[:, list(moves)] = -np.linalg.solve(directions, off[:, :, None])[:, :, 0]
    return out


def whole_control(model: ErrorModel, mean: Array) -> Control:
    """Return the control that takes the deviation of these errors away.  mean : (size,) control values

    Without rotary axes it adds nothing at machine zero, the mean of both directions: a constant is a matter of the
    workpiece's zero. Errors of two axes together are left. Raises TableError when the machine has not three linear axes
    that span space.
    """
    axes = model.machine.axes
    taken, constant = by_linear_axes(model.machine), at_zero(model, mean)

    def once(poses: Array, approaches: Array) -> Array:
        values = _values(model, mean, poses, approaches)
        levers, turned = model.levers(poses)[: len(model.functions)], np.zeros_like(poses)
        for k, own in _own(model).items():
            turned[:, k] = -axes[k].sign * np.sum(axes[k].direction) * values[own].sum(axis=0)
            levers[own] = 0.0
        return turned + taken(poses, np.einsum("fmc,fm->mc", levers, values) - constant)

    return lambda poses, approaches: once(poses + once(poses, approaches), approaches)


def at_zero(model: ErrorModel, mean: Array) -> Array:
    """Return the constant deviation that is not corrected, (3,) m: that at machine zero, none where axes turn."""
    if any(axis.rotary for axis in model.machine.axes):
        return np.zeros(3)
    zero = np.array([model.machine.zero])
    values = _values(model, mean, zero, np.zeros_like(zero))
    deviation: Array = np.einsum("fmc,fm->mc", model.levers(zero)[: len(model.functions)], values)[0]
    return deviation


def _values(model: ErrorModel, mean: Array, poses: Array, approaches: Array) -> Array:
    """Return what every error of one axis is at poses, (functions, m), a reversal by its side."""
    found = []
    for function in model.functions:
        value = function.rows(poses[:, function.axis]) @ mean[function.columns]
        found.append(value * (0.5 * approaches[:, function.axis]) if function.kind == "reversal" else value)
    return np.array(found).reshape(len(model.functions), len(poses))


def _own(model: ErrorModel) -> dict[int, list[int]]:
    """Return the errors by which each rotary axis turns too far about itself."""
    return {
        k: [
            i
            for i, f in enumerate(model.functions)
            if f.axis == k and f.angular and abs(axis.direction[f.component % 3]) > 0.5
        ]
        for k, axis in enumerate(model.machine.axes)
        if axis.rotary
    }
