"""Klipper: a `bed_mesh` profile with `SET_SKEW`, or the whole estimate as a move transform in an extra."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from importlib import resources
from typing import ClassVar

import numpy as np

from axiscal.estimation.belief import Belief
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import InputError, TableError
from axiscal.language.spoken import later
from axiscal.machine.description import Machine
from axiscal.measurement.readers.bed_map import is_mesh
from axiscal.measurement.readers.bed_map import mesh as saved_mesh
from axiscal.measurement.readers.csv_readings import ALONE
from axiscal.measurement.readers.text_file import TextFile
from axiscal.numerics import Array
from axiscal.ports.printers.contents import TRIED, content_of, in_words, zero_note
from axiscal.tables import vcomp_file
from axiscal.tables.exporter import Draft, ExportOptions, MapFormat, Written, paragraphs
from axiscal.tables.loaded import Loaded, OldFile
from axiscal.tables.offer import spread_poses
from axiscal.tables.surface import Mesh, Skew, mesh_control, mesh_of, mesh_of_nodes, plane_axes, sum_of
from axiscal.tables.vcomp_applying import whole_control
from axiscal.units import from_unit, to_unit

_FILE, _EXTRA, _SOURCE = "axiscal.vcomp", "axiscal.py", "klipper_extra.py"
_STEP = 1e-8
"""m: what two rounds and twelve digits may leave."""
_NOTHING = 1e-12
"""m: rounding."""
_POINTS = 33
"""Of the bed along each side: its file is read once, and no probe has to go there."""


class KlipperVolumetric(vcomp_file.VolumetricFormat):
    """One file of every error, with the extra that takes them away."""

    holds = (
        "every error motion and squareness of X, Y and Z, and the bed, as one move transform: axiscal.vcomp is read by "
        "the extra axiscal.py when Klipper starts."
    )
    left_out = "reversal, the orientation of the tool, and errors of two axes together but for the bed."
    with_bed = True
    takes = frozenset({"--mesh"})
    instead: ClassVar = {
        "--on-top-of": later(
            "a whole correction goes on top of none: measure with AXISCAL ENABLE=0, without mesh and skew"
        )
    }

    def make(self, estimate: Estimate, options: ExportOptions) -> Draft:
        """Return the files; raises TableError."""
        machine, bed = estimate.machine, _bed(estimate, options.mesh or _POINTS)
        both = sum_of(whole_control(estimate.as_described, estimate.mean), mesh_control(machine, bed))

        def wanted(poses: Array, approaches: Array) -> Array:
            return both(poses, np.zeros_like(approaches))

        largest = np.max(np.abs(wanted(*spread_poses(estimate))), axis=0)
        if np.max(largest) <= _NOTHING:
            return Draft({}, {}, (), self.holds, self.left_out, control=wanted, wanted=wanted)
        given = [((k,), 1.0) for k in range(len(machine.axes))]
        file = vcomp_file.content_of(estimate, given, "mm", largest, options.origin)
        axes = tuple(replace(axis, reversals=np.zeros((len(axis.knots) - 1, 0, 4))) for axis in file.axes)
        text = vcomp_file.text_of(replace(file, axes=axes, bed=bed), TRIED)
        files = {_FILE: text, _EXTRA: resources.files(__package__).joinpath(_SOURCE).read_text(encoding="utf-8")}
        steps = {axis.name: _STEP for axis in machine.axes}
        values = {"file": _FILE, "extra": _EXTRA, "limit": file.limit, "tried": TRIED}
        notes = paragraphs(__package__, "klipper_volumetric.jinja", **values)
        return self.draft(Written(files, steps, notes), wanted, machine, options)


def _bed(estimate: Estimate, count: int) -> Mesh:
    """Return the height that two axes have together, which no curve of one axis holds.  count : of points a side"""
    plane_axes(estimate.machine)
    mean = estimate.mean.copy()
    for function in estimate.model.functions:
        mean[function.columns] = 0.0
    alone = Belief(mean, np.zeros((len(mean), len(mean))))
    return mesh_of(Estimate(estimate.model, alone, estimate.box), count if estimate.model.planes else 2).zeroed(
        0.0, 0.0
    )


_SAVED = "#*# "
_HEADER = """
#*# <---------------------- SAVE_CONFIG ---------------------->
#*# DO NOT EDIT THIS BLOCK OR BELOW. The contents are auto-generated.
#*#
"""
"""Klipper looks for these lines, the line break before them too (configfile.py, AUTOSAVE_HEADER)."""
_SIDE = 1000.0
"""mm; the skew depends on the ratios of the lengths alone."""
_SAME = 1e-6
"""mm: rounding of a height that is written with six decimals."""
_MESH, _SKEW = "bed_mesh.cfg", "skew.gcode"
_SAVED_SKEW = re.compile(r"^(?:#\*# )?(xy|xz|yz)_skew\s*=\s*(\S+)", re.MULTILINE)
_SET = re.compile(r"^(?:#\*#\s*)?\[skew_correction\s+\S|^\s*SET_SKEW\s.*=")
_PLANE = re.compile(r"(XY|XZ|YZ)=([\d.]+),([\d.]+),([\d.]+)")


class Klipper(MapFormat):
    """A mesh profile and a skew profile."""

    left_out = "positioning errors, straightness in the plane, reversal, and what the height does over z."
    tried = True
    takes = MapFormat.takes | {"--name", "--load"}

    def content(self, estimate: Estimate, options: ExportOptions) -> Loaded:
        """Return the map and the skew that were seen."""
        return replace(content_of(estimate, options, options.mesh), tables=())

    def write(self, content: Loaded, machine: Machine, options: ExportOptions) -> Written:
        """Return a file for each of them."""
        name, skew = options.name, content.skew
        files = dict[str, str]()
        for mesh in content.meshes:
            files[_MESH] = write_mesh(mesh, name)
        files |= {_SKEW: write_skew(skew, name)} if skew else {}
        notes = paragraphs(
            __package__,
            "klipper.jinja",
            meshes=content.meshes,
            skew=skew,
            name=name,
            mesh_file=_MESH,
            skew_file=_SKEW,
            mm=lambda end: f"{to_unit(float(end), 'mm'):g}",
            zero=lambda mesh: zero_note(mesh, options),
            tried=TRIED,
        )
        steps = {"X": 1e-8, "Y": 1e-8, "Z": float(from_unit(2e-6, "mm"))}
        return Written(files, steps, notes, in_words(content))

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what a printer.cfg has saved, or G-code sets; raises ReadingError, TableError."""
        meshes, skew, untaken = list[Mesh](), dict[str, float](), list[InputError]()
        for file in files:
            text = TextFile(file.name, tuple(file.text.splitlines()))
            meshes += [mesh_of_nodes(saved_mesh(text, ALONE, whole=True).readings)] if is_mesh(text) else []
            found = {plane.upper(): float(value) for plane, value in _SAVED_SKEW.findall(file.text)}
            skew = found or read_skew(file.text) or skew
            lines = [each for each in enumerate(text.lines, 1) if _SET.search(each[1])]
            profiles = [(n, line) for n, line in lines if "=" not in line][1:]
            profiles += [(n, line) for n, line in lines if line.count("=") > len(_PLANE.findall(line))]
            what, remedy = "{text!r} is not taken", "keep one skew, as in SET_SKEW XY=AC,BD,AD"
            untaken += [TableError(what, remedy, file.name, n, text=line.strip()[:60]) for n, line in profiles]
            if not found and not _PLANE.search(file.text) and not is_mesh(text):
                remedy = "give the printer.cfg with its saved block"
                raise TableError("no mesh and no skew is saved here", remedy, file.name)
        return Loaded(meshes=tuple(meshes), skew=skew, untaken=tuple(untaken))


def write_mesh(mesh: Mesh, name: str) -> str:
    """Return the saved block of the profile with the lines that Klipper knows it by; heights in mm, rows by y."""
    x, y, z = (to_unit(values, "mm") for values in (mesh.x, mesh.y, mesh.added))
    rows = ["\t  " + ", ".join(f"{value:.6f}" for value in row) for row in np.round(z, 6) + 0.0]
    keys = {"x_count": len(x), "y_count": len(y), "mesh_x_pps": 0, "mesh_y_pps": 0, "algo": "direct", "tension": 0.2}
    ends = {"min_x": x[0], "max_x": x[-1], "min_y": y[0], "max_y": y[-1]}
    lines = [f"[bed_mesh {name}]", "version = 1", "points =", *rows, *(f"{k} = {v}" for k, v in keys.items())]
    lines += [f"{key} = {round(float(value), 6)}" for key, value in ends.items()]
    return _HEADER + "".join(f"{_SAVED}{line}\n" for line in lines)


def plain_profile(saved: str) -> str:
    """Return a saved block as a file that printer.cfg may include."""
    return saved.removeprefix(_HEADER).replace(f"\n{_SAVED}", "\n").removeprefix(_SAVED)


def holds_heights(held: object, mesh: str) -> bool:
    """Return whether a printer's matrix has the heights of a profile as it was written."""
    rows = [line.partition("\t")[2] for line in mesh.splitlines() if "\t" in line]
    wanted = np.array([[float(each) for each in row.split(",")] for row in rows])
    try:
        matrix = np.array(held, dtype=float)
    except (TypeError, ValueError):
        return False
    return matrix.shape == wanted.shape and bool(np.all(np.abs(matrix - wanted) <= _SAME))


def write_skew(skew: Skew, name: str) -> str:
    """Return the G-code: diagonals AC, BD and side AD of a square that leans by the skew."""
    words = " ".join(f"{plane}={_lengths(tangent)}" for plane, tangent in skew.items())
    return f"SET_SKEW {words}\nSKEW_PROFILE SAVE={name}\n"


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
