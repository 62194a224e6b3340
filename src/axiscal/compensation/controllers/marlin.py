"""Marlin: G-code with `M852` (skew), `M425` (backlash) and `M421` (bed mesh), saved by `M500`."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from axiscal.compensation.effect import Control
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.offer import Draft
from axiscal.compensation.sampling import axis_tables
from axiscal.compensation.skew import Skew, skew_control, skew_of
from axiscal.compensation.surface import Mesh, mesh_control, mesh_of, sum_of
from axiscal.estimate.machine_estimate import Estimate
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.units import from_unit, to_unit

_FILE = "axiscal.gcode"
_WORD = re.compile(r"([A-Z])(-?[\d.]+)")
_HOLDS = "the skew of the three axes, one backlash for each, and height over the plane as a bed mesh."
_LEFT = (
    "positioning errors, straightness in the plane, reversal that changes along an axis or runs ahead, and what the "
    "height does over z."
)


def make(estimate: Estimate, options: ExportOptions) -> Draft:
    """Return the file; raises TableError."""
    machine, box = estimate.machine, estimate.box
    mesh, skew, play = mesh_of(estimate, options.mesh), skew_of(estimate), backlash(estimate)
    text = write(mesh, skew, play)
    spans = {name: machine.axis(name).travel for name in "XY"}
    held_mesh, held_skew, held_play = read(text, spans, options.mesh)
    held = sum_of(
        mesh_control(machine, held_mesh), skew_control(machine, held_skew), backlash_control(machine, held_play)
    )
    wanted = sum_of(mesh_control(machine, mesh), skew_control(machine, skew), backlash_control(machine, play))
    reach = max(abs(bound) for bounds in box for bound in bounds)
    step = float(from_unit(1e-4, "mm"))
    resolution = {"X": step + 2e-7 * reach, "Y": step + 2e-7 * reach, "Z": 2 * step}
    notes = (
        f"The firmware needs SKEW_CORRECTION, BACKLASH_COMPENSATION and a mesh of {options.mesh} points a side "
        f"(GRID_MAX_POINTS_X, _Y) from X{_mm(spans['X'])} and Y{_mm(spans['Y'])}; export with --mesh for another size.",
        f"Send {_FILE} once; it ends with M500. M420 S1 Z0 switches the mesh on, without fading.",
        "M425 F0, M852 I0 J0 K0 and M420 S0 take all of it off before measuring again.",
    )
    return Draft({_FILE: text}, held, wanted, resolution, (), _HOLDS, _LEFT, notes, tried=False)


def backlash(estimate: Estimate) -> dict[str, float]:
    """Return the lost motion of each axis, m: by how much it arrives short when it comes from the other side."""
    found = {}
    for table in axis_tables(estimate):
        low, high = estimate.box[estimate.machine.index(table.axis)]
        at = np.linspace(low, high, 1001)
        found[table.axis] = max(0.0, float(np.mean(table.deviation(at, -1) - table.deviation(at, 1))))
    return {axis: value for axis, value in found.items() if value > 0}


def backlash_control(machine: Machine, play: Mapping[str, float]) -> Control:
    """Return the control that goes further by the lost motion after each reversal, half of it to each side."""

    def control(poses: Array, approaches: Array) -> Array:
        added = np.zeros_like(poses)
        for axis, value in play.items():
            k = machine.index(axis)
            added[:, k] = np.sign(approaches[:, k]) * value / 2
        return added

    return control


def write(mesh: Mesh, skew: Skew, play: Mapping[str, float]) -> str:
    """Return the G-code, mm."""
    lines = [f"M852 I{skew.xy:.7f} J{skew.xz:.7f} K{skew.yz:.7f}"]
    if play:
        words = " ".join(f"{axis}{to_unit(value, 'mm'):.4f}" for axis, value in play.items())
        lines.append(f"M425 {words} F1 S0")
    heights = np.round(np.asarray(to_unit(mesh.added, "mm")), 4) + 0.0
    lines += [f"M421 I{i} J{j} Z{value:.4f}" for j, row in enumerate(heights) for i, value in enumerate(row)]
    return "\n".join([*lines, "M500"]) + "\n"


def read(text: str, spans: Mapping[str, tuple[float, float]], count: int) -> tuple[Mesh, Skew, dict[str, float]]:
    """Return what Marlin makes of the commands; spans : of the mesh that the firmware was built with."""
    heights = np.zeros((count, count))
    skew, play = Skew(0.0, 0.0, 0.0), dict[str, float]()
    for line in text.splitlines():
        command, *words = line.split()
        values = {m[1]: float(m[2]) for word in words if (m := _WORD.fullmatch(word))}
        if command == "M852":
            skew = Skew(values["I"], values["J"], values["K"])
        elif command == "M425":
            share = values.pop("F")
            play = {axis: share * float(from_unit(v, "mm")) for axis, v in values.items() if axis != "S"}
        elif command == "M421":
            heights[int(values["J"]), int(values["I"])] = values["Z"]
    x, y = (np.linspace(*spans[axis], count) for axis in "XY")
    return Mesh(x, y, from_unit(heights, "mm")), skew, play


def _mm(span: tuple[float, float]) -> str:
    low, high = (to_unit(bound, "mm") for bound in span)
    return f" {low:g} to {high:g}"
