"""Klipper: a `bed_mesh` profile with `SET_SKEW`."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.measurement.readers.bed_map import is_mesh
from axiscal.measurement.readers.bed_map import mesh as saved_mesh
from axiscal.measurement.readers.csv_readings import ALONE
from axiscal.measurement.readers.text_file import TextFile
from axiscal.ports.printers.contents import TRIED, content_of, in_words, zero_note
from axiscal.tables.exporter import ExportOptions, MapFormat, Written, paragraphs
from axiscal.tables.loaded import Loaded, OldFile
from axiscal.tables.surface import Mesh, Skew, mesh_of_nodes
from axiscal.units import from_unit, to_unit
from axiscal_core.machine import Machine

_SAVED = "#*# "
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


class Klipper(MapFormat):
    """A mesh profile and a skew profile."""

    left_out = "positioning errors, straightness in the plane, reversal, and what the height does over z."
    tried = True

    def content(self, estimate: Estimate, options: ExportOptions) -> Loaded:
        """Return the map and the skew that were seen."""
        return replace(content_of(estimate, options, options.mesh), tables=())

    def write(self, content: Loaded, machine: Machine, options: ExportOptions) -> Written:
        """Return a file for each of them."""
        skew = content.skew
        files = dict[str, str]()
        for mesh in content.meshes:
            files[_MESH] = write_mesh(mesh)
        files |= {_SKEW: write_skew(skew)} if skew else {}
        notes = paragraphs(
            __package__,
            "klipper.jinja",
            meshes=content.meshes,
            skew=skew,
            name=_NAME,
            mesh_file=_MESH,
            skew_file=_SKEW,
            mm=lambda end: f"{to_unit(float(end), 'mm'):g}",
            zero=lambda mesh: zero_note(mesh, options),
            tried=TRIED,
        )
        steps = {"X": 1e-8, "Y": 1e-8, "Z": float(from_unit(2e-6, "mm"))}
        return Written(files, steps, notes, in_words(content))

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what a saved block holds, and what G-code sets."""
        texts = [TextFile(file.name, tuple(file.text.splitlines())) for file in files]
        meshes = (mesh_of_nodes(saved_mesh(text, ALONE, whole=True).readings) for text in texts if is_mesh(text))
        skew = {plane: tangent for file in files for plane, tangent in read_skew(file.text).items()}
        return Loaded(meshes=tuple(meshes), skew=skew)


def write_mesh(mesh: Mesh) -> str:
    """Return the saved block of the profile with the lines that Klipper knows it by; heights in mm, rows by y."""
    x, y, z = (to_unit(values, "mm") for values in (mesh.x, mesh.y, mesh.added))
    rows = ["\t  " + ", ".join(f"{value:.6f}" for value in row) for row in np.round(z, 6) + 0.0]
    keys = {"x_count": len(x), "y_count": len(y), "mesh_x_pps": 0, "mesh_y_pps": 0, "algo": "direct", "tension": 0.2}
    ends = {"min_x": x[0], "max_x": x[-1], "min_y": y[0], "max_y": y[-1]}
    lines = [f"[bed_mesh {_NAME}]", "version = 1", "points =", *rows, *(f"{k} = {v}" for k, v in keys.items())]
    lines += [f"{key} = {round(float(value), 6)}" for key, value in ends.items()]
    return _HEADER + "".join(f"{_SAVED}{line}\n" for line in lines)


def write_skew(skew: Skew) -> str:
    """Return the G-code: diagonals AC, BD and side AD of a square that leans by the skew."""
    words = " ".join(f"{plane}={_lengths(tangent)}" for plane, tangent in skew.items())
    return f"SET_SKEW {words}\nSKEW_PROFILE SAVE={_NAME}\n"


def read_skew(text: str) -> dict[str, float]:
    """Return the skew that skew_correction.py makes of `SET_SKEW`: all sides follow from the diagonals and AD."""
    found = dict[str, float]()
    for plane, *lengths in _PLANE.findall(text):
        ac, bd, ad = map(float, lengths)
        side = math.sqrt(2 * ac * ac + 2 * bd * bd - 4 * ad * ad) / 2
        angle = math.acos((ac * ac - side * side - ad * ad) / (2 * side * ad))
        found[plane] = math.tan(math.pi / 2 - angle)
    return found


def _lengths(tangent: float) -> str:
    lean = math.sin(math.atan(tangent))
    ac, bd = (_SIDE * math.sqrt(2 * (1 + sign * lean)) for sign in (1, -1))
    return f"{ac:.9f},{bd:.9f},{_SIDE:.9f}"
