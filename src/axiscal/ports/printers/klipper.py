"""Klipper: a `bed_mesh` profile with `SET_SKEW`."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np

from axiscal.measurement.readers.bed_map import is_mesh
from axiscal.measurement.readers.bed_map import mesh as saved_mesh
from axiscal.measurement.readers.csv_readings import ALONE
from axiscal.ports.printers.contents import PrinterFiles, PrinterFormat, texts_of
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import Loaded, OldFile
from axiscal.tables.surface import Mesh, mesh_of_nodes
from axiscal.units import from_unit, to_unit
from axiscal_core.machine import Machine

_HEADER = """
#*# <---------------------- SAVE_CONFIG ---------------------->
#*# DO NOT EDIT THIS BLOCK OR BELOW. The contents are auto-generated.
#*#
"""
"""Klipper looks for these lines, the line break before them too (configfile.py, AUTOSAVE_HEADER)."""
_SIDE = 1000.0
"""mm; the skew depends on the ratios of the lengths alone."""
_NAME, _MESH, _SKEW = "axiscal", "bed_mesh.cfg", "skew.gcode"
_PLANE = re.compile(r"(XY|XZ|YZ)=([\d.]+),([\d.]+),([\d.]+)")


class Klipper(PrinterFormat):
    """A mesh profile and a skew profile."""

    left_out = "positioning errors, straightness in the plane, reversal, and what the height does over z."
    tried = True
    template = "klipper.jinja"

    backlashes = False

    def printed(self, content: Loaded, machine: Machine) -> PrinterFiles:
        """Return a file for each of them; of the skew diagonals AC, BD and side AD of a square that leans by it."""
        files = {_MESH: _written(content.meshes[0])} if content.meshes else {}
        if content.skew:
            lean = {plane: math.sin(math.atan(tangent)) for plane, tangent in content.skew.items()}
            sides = {p: [_SIDE * math.sqrt(2 * (1 + sign * each)) for sign in (1, -1)] for p, each in lean.items()}
            words = (f"{plane}={ac:.9f},{bd:.9f},{_SIDE:.9f}" for plane, (ac, bd) in sides.items())
            files[_SKEW] = f"SET_SKEW {' '.join(words)}\nSKEW_PROFILE SAVE={_NAME}\n"
        steps = {"X": 1e-8, "Y": 1e-8, "Z": float(from_unit(2e-6, "mm"))}
        return files, steps, {"name": _NAME, "mesh_file": _MESH, "skew_file": _SKEW}

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what a saved block holds, and what G-code sets, as skew_correction.py makes it of `SET_SKEW`."""
        texts, skew = texts_of(files), dict[str, float]()
        for plane, *lengths in (found for file in files for found in _PLANE.findall(file.text)):
            ac, bd, ad = map(float, lengths)
            side = math.sqrt(2 * ac * ac + 2 * bd * bd - 4 * ad * ad) / 2
            skew[plane] = math.tan(math.pi / 2 - math.acos((ac * ac - side * side - ad * ad) / (2 * side * ad)))
        meshes = (mesh_of_nodes(saved_mesh(text, ALONE, whole=True).readings) for text in texts if is_mesh(text))
        return Loaded(meshes=tuple(meshes), skew=skew)


def _written(mesh: Mesh) -> str:
    """Return the saved block of the profile with the lines that Klipper knows it by; heights in mm, rows by y."""
    x, y, z = (to_unit(values, "mm") for values in (mesh.x, mesh.y, mesh.added))
    rows = ["\t  " + ", ".join(f"{value:.6f}" for value in row) for row in np.round(z, 6) + 0.0]
    keys = {"x_count": len(x), "y_count": len(y), "mesh_x_pps": 0, "mesh_y_pps": 0, "algo": "direct", "tension": 0.2}
    ends = {"min_x": x[0], "max_x": x[-1], "min_y": y[0], "max_y": y[-1]}
    keys |= {key: round(float(value), 6) for key, value in ends.items()}
    lines = [f"[bed_mesh {_NAME}]", "version = 1", "points =", *rows, *(f"{k} = {v}" for k, v in keys.items())]
    return _HEADER + "".join(f"#*# {line}\n" for line in lines)
