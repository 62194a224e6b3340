"""Marlin: G-code with `M852` (skew), `M425` (backlash) and `M421` (bed mesh), saved by `M500`."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from axiscal.measurement.readers.bed_map import is_nodes, nodes
from axiscal.measurement.readers.csv_readings import Around
from axiscal.measurement.readers.text_file import TextFile
from axiscal.ports.printers.contents import STEP, PrinterFormat, play_of
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import Loaded, OldFile, lost_motion
from axiscal.tables.surface import mesh_of_nodes
from axiscal.units import from_unit, to_unit
from axiscal_core.machine import Machine

_FILE = "axiscal.gcode"
_COMMAND = re.compile(r"(M425|M852) ([^;\n]*)")
_WORD = re.compile(r"(?<!\S)([A-Z])(-?[\d.]+)(?!\S)")
_SKEW = {"XY": "I", "XZ": "J", "YZ": "K"}
_PLANES = {letter: plane for plane, letter in _SKEW.items()}


class Marlin(PrinterFormat):
    """Commands for the height, the skew, and one backlash of each axis."""

    template = "marlin.jinja"

    def files(self, content: Loaded) -> dict[str, str]:
        """Return the G-code, mm; the firmware has to be built with the points of its map."""
        tangents = " ".join(f"{_SKEW[plane]}{tangent:.7f}" for plane, tangent in content.skew.items())
        lost = " ".join(f"{axis}{to_unit(value, 'mm'):.4f}" for axis, value in play_of(content).items())
        lines = [*([f"M852 {tangents}"] if tangents else []), *([f"M425 {lost} F1 S0"] if lost else [])]
        for mesh in content.meshes:
            x, y = (to_unit(places[[0, -1]], "mm").tolist() for places in (mesh.x, mesh.y))
            lines.append(f"; mesh from X {x[0]!r} to {x[1]!r} and Y {y[0]!r} to {y[1]!r}")
            heights = np.round(np.asarray(to_unit(mesh.added, "mm")), 4) + 0.0
            lines += [f"M421 I{i} J{j} Z{value:.4f}" for j, row in enumerate(heights) for i, value in enumerate(row)]
        return {_FILE: "\n".join([*lines, "M500"]) + "\n"} if lines else {}

    def steps(self, content: Loaded, machine: Machine) -> dict[str, float]:
        """Return what seven decimals of a skew, and four of a height, leave."""
        reach = max(abs(end) for axis in machine.axes for end in axis.travel)
        return {"X": STEP + 2e-7 * reach, "Y": STEP + 2e-7 * reach, "Z": 2 * STEP}

    def known(self, content: Loaded) -> Mapping[str, Any]:
        """Return what the firmware needs."""
        skew, play, mesh = content.skew, play_of(content), bool(content.meshes)
        needs = [name for name, used in (("SKEW_CORRECTION", skew), ("BACKLASH_COMPENSATION", play)) if used]
        needs += ["SKEW_CORRECTION_FOR_Z"] if {"XZ", "YZ"} & skew.keys() else []
        back = [code for code, used in (("M425 F0", play), ("M852 I0 J0 K0", skew), ("M420 S0", mesh)) if used]
        return {"needs": needs, "back": back, "file": _FILE}

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what Marlin makes of the commands, mm; raises ReadingError for a map that is not whole.

        Where the nodes of a map are is built into the firmware: an export says it, and else they span the travels.
        """
        text, skew, play = "\n".join(file.text for file in files), dict[str, float](), dict[str, float]()
        for code, words in _COMMAND.findall(text):
            values = {letter: float(number) for letter, number in _WORD.findall(words)}
            if code == "M852":
                skew = {_PLANES[letter]: value for letter, value in values.items()}
            else:
                share = values.pop("F", 1.0)
                play = {axis: share * float(from_unit(v, "mm")) for axis, v in values.items() if axis in "XYZ"}
        file, travel = TextFile("", tuple(text.splitlines())), {axis.name: axis.travel for axis in machine.axes}
        around = Around(ends=(travel["X"], travel["Y"]) if {"X", "Y"} <= travel.keys() else None)
        meshes = (mesh_of_nodes(nodes(file, around, zeros=True).readings),) if is_nodes(file) else ()
        return Loaded(lost_motion(machine, play), meshes, skew)
