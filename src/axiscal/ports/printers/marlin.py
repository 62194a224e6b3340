"""Marlin: G-code with `M852` (skew), `M425` (backlash) and `M421` (bed mesh), saved by `M500`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.measurement.readers.bed_map import is_nodes, nodes
from axiscal.measurement.readers.csv_readings import Around
from axiscal.measurement.readers.text_file import TextFile
from axiscal.ports.printers.contents import STEP, PrinterFiles, PrinterFormat, commands_of, play_text
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import Loaded, OldFile, lost_motion
from axiscal.tables.surface import mesh_of_nodes
from axiscal.units import from_unit, to_unit
from axiscal_core.machine import Machine

_FILE = "axiscal.gcode"
_SKEW = {"XY": "I", "XZ": "J", "YZ": "K"}
_PLANES = {letter: plane for plane, letter in _SKEW.items()}


class Marlin(PrinterFormat):
    """Commands for the height, the skew, and one backlash of each axis."""

    template = "marlin.jinja"

    def printed(self, content: Loaded, machine: Machine) -> PrinterFiles:
        """Return the G-code; the firmware has to be built with the points of its map."""
        skew, play, lines, back = content.skew, play_text(content), list[str](), list[str]()
        needs = ["SKEW_CORRECTION_FOR_Z"] if {"XZ", "YZ"} & skew.keys() else []
        if play:
            lines, back, needs = [f"M425 {play} F1 S0"], ["M425 F0"], ["BACKLASH_COMPENSATION", *needs]
        if skew:
            lines.insert(0, "M852 " + " ".join(f"{_SKEW[plane]}{tangent:.7f}" for plane, tangent in skew.items()))
            back, needs = [*back, "M852 I0 J0 K0"], ["SKEW_CORRECTION", *needs]
        for mesh in content.meshes:
            x, y = (to_unit(places[[0, -1]], "mm").tolist() for places in (mesh.x, mesh.y))
            lines.append(f"; mesh from X {x[0]!r} to {x[1]!r} and Y {y[0]!r} to {y[1]!r}")
            heights = np.round(np.asarray(to_unit(mesh.added, "mm")), 4) + 0.0
            lines += [f"M421 I{i} J{j} Z{value:.4f}" for j, row in enumerate(heights) for i, value in enumerate(row)]
            back.append("M420 S0")
        reach = max(abs(end) for axis in machine.axes for end in axis.travel)  # by seven decimals of a skew
        steps = {"X": STEP + 2e-7 * reach, "Y": STEP + 2e-7 * reach, "Z": 2 * STEP}
        files = {_FILE: "\n".join([*lines, "M500"]) + "\n"} if lines else {}
        return files, steps, {"needs": needs, "back": back, "file": _FILE}

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what Marlin makes of the commands, mm; raises ReadingError for a map that is not whole.

        Where the nodes of a map are is built into the firmware: an export says it, and else they span the travels.
        """
        found, text = commands_of(files), "\n".join(file.text for file in files)
        skew = {_PLANES[letter]: value for letter, value in found.get("M852", {}).items()}
        lost = found.get("M425", {})
        play = {a: float(from_unit(v * lost.get("F", 1.0), "mm")) for a, v in lost.items() if a in "XYZ"}
        file, travel = TextFile("", tuple(text.splitlines())), {axis.name: axis.travel for axis in machine.axes}
        around = Around(ends=(travel["X"], travel["Y"]) if {"X", "Y"} <= travel.keys() else None)
        meshes = (mesh_of_nodes(nodes(file, around, zeros=True).readings),) if is_nodes(file) else ()
        return Loaded(lost_motion(machine, play), meshes, skew)
