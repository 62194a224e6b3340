"""Marlin: G-code with `M852` (skew), `M425` (backlash) and `M421` (bed mesh), saved by `M500`."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.measurement.readers.bed_map import is_nodes, nodes
from axiscal.measurement.readers.csv_readings import Around
from axiscal.measurement.readers.text_file import TextFile
from axiscal.numerics import Array
from axiscal.ports.printers.contents import LEFT_OUT, STEP, content_of, in_words, play_of, zero_note
from axiscal.tables.exporter import ExportOptions, MapFormat, Written, paragraphs
from axiscal.tables.loaded import Loaded, OldFile, lost_motion
from axiscal.tables.surface import Mesh, Skew, mesh_of_nodes
from axiscal.units import from_unit, to_unit
from axiscal_core.machine import Machine

_FILE = "axiscal.gcode"
_COMMAND = re.compile(r"(M425|M852) ([^;\n]*)")
_WORD = re.compile(r"(?<!\S)([A-Z])(-?[\d.]+)(?!\S)")
_SKEW = {"XY": "I", "XZ": "J", "YZ": "K"}
_PLANES = {letter: plane for plane, letter in _SKEW.items()}


class Marlin(MapFormat):
    """Commands for the height, the skew, and one backlash of each axis."""

    left_out = LEFT_OUT

    def content(self, estimate: Estimate, options: ExportOptions) -> Loaded:
        """Return what was seen."""
        return content_of(estimate, options, options.mesh)

    def write(self, content: Loaded, machine: Machine, options: ExportOptions) -> Written:
        """Return the file; the firmware has to be built with the points of its map."""
        mesh, skew, play = next(iter(content.meshes), None), content.skew, play_of(content)
        reach = max(abs(end) for axis in machine.axes for end in axis.travel)
        steps = {"X": STEP + 2e-7 * reach, "Y": STEP + 2e-7 * reach, "Z": 2 * STEP}
        files = {_FILE: text_of(content)} if mesh or skew or play else {}
        where = [zero_note(each, options) for each in content.meshes]
        return Written(files, steps, (*_notes(mesh, skew, play), *where), in_words(content))

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what the commands make active."""
        return read("\n".join(file.text for file in files), machine)


def _notes(mesh: Mesh | None, skew: Skew, play: Mapping[str, float]) -> tuple[str, ...]:
    needs = [name for name, used in (("SKEW_CORRECTION", skew), ("BACKLASH_COMPENSATION", play)) if used]
    needs += ["SKEW_CORRECTION_FOR_Z"] if {"XZ", "YZ"} & skew.keys() else []
    back = [code for code, used in (("M425 F0", play), ("M852 I0 J0 K0", skew), ("M420 S0", mesh)) if used]
    values = {"mesh": mesh, "skew": skew, "needs": needs, "back": back, "mm": _mm, "file": _FILE}
    return paragraphs(__package__, "marlin.jinja", **values)


def text_of(content: Loaded) -> str:
    """Return the G-code, mm."""
    tangents = " ".join(f"{_SKEW[plane]}{tangent:.7f}" for plane, tangent in content.skew.items())
    lines = [f"M852 {tangents}"] if tangents else []
    if play := play_of(content):
        words = " ".join(f"{axis}{to_unit(value, 'mm'):.4f}" for axis, value in play.items())
        lines.append(f"M425 {words} F1 S0")
    for mesh in content.meshes:
        x, y = (to_unit(places[[0, -1]], "mm").tolist() for places in (mesh.x, mesh.y))
        lines.append(f"; mesh from X {x[0]!r} to {x[1]!r} and Y {y[0]!r} to {y[1]!r}")
        heights = np.round(np.asarray(to_unit(mesh.added, "mm")), 4) + 0.0
        lines += [f"M421 I{i} J{j} Z{value:.4f}" for j, row in enumerate(heights) for i, value in enumerate(row)]
    return "\n".join([*lines, "M500"]) + "\n"


def read(text: str, machine: Machine) -> Loaded:
    """Return what Marlin makes of the commands in a text, mm; raises ReadingError for a map that is not whole.

    Where the nodes of a map are is built into the firmware: an export says it, and else they span the travels.
    """
    skew, play, file = dict[str, float](), dict[str, float](), TextFile("", tuple(text.splitlines()))
    for command in _COMMAND.finditer(text):
        values = {letter: float(number) for letter, number in _WORD.findall(command[2])}
        if command[1] == "M852":
            skew = {_PLANES[letter]: value for letter, value in values.items()}
        else:
            share = values.pop("F", 1.0)
            play = {axis: share * float(from_unit(v, "mm")) for axis, v in values.items() if axis in "XYZ"}
    return Loaded(lost_motion(machine, play), (_mesh(file, machine),) if is_nodes(file) else (), skew)


def _mesh(file: TextFile, machine: Machine) -> Mesh:
    travel = {axis.name: axis.travel for axis in machine.axes}
    ends = (travel["X"], travel["Y"]) if {"X", "Y"} <= travel.keys() else None
    return mesh_of_nodes(nodes(file, Around(ends=ends), zeros=True).readings)


def _mm(places: Array) -> str:
    low, high = (to_unit(float(places[end]), "mm") for end in (0, -1))
    return f"{low:g} to {high:g}"
