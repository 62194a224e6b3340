"""RepRapFirmware (Duet): `heightmap.csv`, version 2, and G-code with `M556` (skew) and `M425` (backlash)."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.measurement.readers.bed_map import height_map, is_height_map
from axiscal.measurement.readers.csv_readings import ALONE
from axiscal.measurement.readers.text_file import TextFile
from axiscal.ports.printers.contents import LEFT_OUT, STEP, content_of, in_words, play_of, zero_note
from axiscal.tables.exporter import ExportOptions, MapFormat, Written, paragraphs
from axiscal.tables.loaded import Loaded, OldFile, lost_motion
from axiscal.tables.surface import PLANES, Mesh, Skew, mesh_of_nodes
from axiscal.units import from_unit, to_unit
from axiscal_core.machine import Machine

_MAP, _CODE = "heightmap.csv", "axiscal.g"
_FIRST = "RepRapFirmware height map file v2"
_KEYS = "xmin,xmax,ymin,ymax,radius,xspacing,yspacing,xnum,ynum"
_SIDE = 1000.0
"""mm; M556 says how far an axis leans over so much."""
_USUAL, _MOST, _MOST_ALONG_X = 441, 961, 33
"""Points of a map that every Duet takes, those with most memory, and its line of 330 characters with six decimals."""
_COMMAND = re.compile(r"^\s*(M556|M425)\b([^;\n]*)", re.MULTILINE)
_WORD = re.compile(r"([A-Z])\s*(-?[\d.]+)")


class RepRapFirmware(MapFormat):
    """A height map of a Duet, and commands for its skew and its backlash."""

    left_out = LEFT_OUT

    def content(self, estimate: Estimate, options: ExportOptions) -> Loaded:
        """Return what was seen; raises TableError for a map that no Duet takes."""
        found = content_of(estimate, options, options.mesh or (None if estimate.grid else int(_USUAL**0.5)))
        for mesh in found.meshes:
            if mesh.added.size > _MOST or len(mesh.x) > _MOST_ALONG_X:
                what = "a Duet takes {most} points, {along} along x, and this map has {wide} x {high}"
                wide, high, along = len(mesh.x), len(mesh.y), _MOST_ALONG_X
                raise TableError(what, "export with --mesh 21", most=_MOST, along=along, wide=wide, high=high)
        return found

    def write(self, content: Loaded, machine: Machine, options: ExportOptions) -> Written:
        """Return a file for the map, and one for the commands."""
        files, play = dict[str, str](), play_of(content)
        for mesh in content.meshes:
            files[_MAP] = text_of(mesh)
        if content.skew or play:
            files[_CODE] = code_of(content.skew, play)
        steps = {"X": STEP, "Y": STEP, "Z": STEP if "Z" in play else 2e-9}
        notes = (*_notes(content, play), *(zero_note(mesh, options) for mesh in content.meshes))
        return Written(files, steps, notes, in_words(content))

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what height maps hold, and what G-code sets."""
        texts = [TextFile(file.name, tuple(file.text.splitlines())) for file in files]
        meshes = [mesh_of_nodes(height_map(text, ALONE).readings) for text in texts if is_height_map(text)]
        lines = (found for file in files for found in _COMMAND.findall(file.text))
        commands = {code: {letter: float(word) for letter, word in _WORD.findall(words)} for code, words in lines}
        play = {axis: float(from_unit(value, "mm")) for axis, value in commands.get("M425", {}).items()}
        skew = _skew(commands["M556"]) if "M556" in commands else {}
        return Loaded(lost_motion(machine, play), tuple(meshes), skew)


def _notes(content: Loaded, play: Mapping[str, float]) -> tuple[str, ...]:
    back = [code for code, used in (("M425 X0 Y0 Z0", play), ("M556 S100 X0 Y0 Z0", content.skew)) if used]
    values = {"meshes": content.meshes, "skew": content.skew, "play": play, "back": back, "usual": _USUAL}
    return paragraphs(__package__, "reprapfirmware.jinja", map=_MAP, code=_CODE, **values)


def code_of(skew: Skew, play: Mapping[str, float]) -> str:
    """Return the G-code, mm.

    The firmware adds: x += X y + Z z, y += Y z, with letters over S; XZ is of the skewed y, so it has a part of XY.
    """
    xy, xz, yz = (skew.get(plane, 0.0) for plane in PLANES)
    leans = {"XY": ("X", -xy), "YZ": ("Y", -yz), "XZ": ("Z", xy * yz - xz)}
    words = [f"{letter}{_SIDE * lean + 0.0:.6f}" for plane, (letter, lean) in leans.items() if plane in skew]
    lines = [" ".join([f"M556 S{_SIDE:g}", *words])] if words else []
    lost = [f"{axis}{to_unit(value, 'mm'):.4f}" for axis, value in play.items()]
    return "\n".join([*lines, *([" ".join(["M425", *lost])] if lost else [])]) + "\n"


def _skew(words: Mapping[str, float]) -> dict[str, float]:
    letters = {"XY": "X", "XZ": "Z", "YZ": "Y"}
    skew = {plane: -words[letter] / words["S"] for plane, letter in letters.items() if letter in words}
    if "XZ" in skew:
        skew["XZ"] += skew.get("XY", 0.0) * skew.get("YZ", 0.0)
    return skew


def text_of(mesh: Mesh) -> str:
    """Return the map, mm."""
    x, y, z = (np.round(to_unit(values, "mm"), 6) + 0.0 for values in (mesh.x, mesh.y, mesh.added))
    mean, deviation = round(float(np.mean(z)), 3) + 0.0, float(np.std(z))
    head = f"{_FIRST} generated by axiscal, mean error {mean:.3f}, deviation {deviation:.3f}"
    numbers = [x[0], x[-1], y[0], y[-1], -1.0, x[1] - x[0], y[1] - y[0]]
    line = ",".join([*(f"{number:.6f}" for number in numbers), str(len(x)), str(len(y))])
    rows = [",".join(f"{value:.6f}" for value in row) for row in z]
    return "\n".join([head, _KEYS, line, *rows]) + "\n"
