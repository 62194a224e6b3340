"""Marlin: G-code with `M852` (skew), `M425` (backlash) and `M421` (bed mesh), saved by `M500`."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from axiscal.compensation.effect import Control
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.loaded import Loaded
from axiscal.compensation.lookup import Lookup
from axiscal.compensation.offer import Draft
from axiscal.compensation.old_files import OldFile
from axiscal.compensation.sampling import axis_tables
from axiscal.compensation.skew import Skew, skew_control, skew_of
from axiscal.compensation.surface import (
    Mesh,
    height_seen,
    held_words,
    mesh_control,
    mesh_of,
    plane_axes,
    sum_of,
    with_height,
)
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.units import from_unit, to_unit

_FILE = "axiscal.gcode"
_COMMAND = re.compile(r"(M(?:421|425|852) .*)")
_NODE = re.compile(r"M421 I(\d+) J(\d+)")
_WORD = re.compile(r"([A-Z])(-?[\d.]+)")
_SKEW = {"XY": "I", "XZ": "J", "YZ": "K"}
_LEFT = (
    "positioning errors, straightness in the plane, reversal that changes along an axis or runs ahead, and what the "
    "height does over z."
)


def make(estimate: Estimate, options: ExportOptions) -> Draft:
    """Return the file; raises TableError."""
    estimate = with_height(estimate)
    machine = estimate.machine
    old = options.old
    mesh = old.under_mesh(mesh_of(estimate, _points(options))) if height_seen(estimate) else None
    skew, play = old.under_skew(skew_of(estimate)), _summed(backlash(estimate), old)
    text = write(mesh, skew, play)
    held_mesh, held_skew, held_play = read(text, mesh)
    held, wanted = (
        sum_of(skew_control(machine, s), backlash_control(machine, p), *([mesh_control(machine, m)] if m else []))
        for m, s, p in ((held_mesh, held_skew, held_play), (mesh, skew, play))
    )
    reach = max(abs(bound) for bounds in estimate.box for bound in bounds)
    step = float(from_unit(1e-4, "mm"))
    resolution = {"X": step + 2e-7 * reach, "Y": step + 2e-7 * reach, "Z": 2 * step}
    files = {_FILE: text} if mesh or skew.seen or play else {}
    holds = held_words(mesh is not None, skew.seen)
    parts = [part for part in (holds, f"one backlash for {', '.join(play)}" if play else "") if part]
    notes = _notes(mesh, skew, play)
    said = f"{'; '.join(parts)}."
    return Draft(files, held, wanted, resolution, (), said, _LEFT, notes, tried=False, about=estimate)


def load(files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
    """Return what commands made active: a report of M503 or the file of an earlier export; raises TableError.

    Where a mesh has its points is built into the firmware: they are taken to span the travels of X and Y.
    """
    meshes, skew, play = list[Mesh](), Skew(), dict[str, float]()
    for file in files:
        commands = [found[1] for line in file.text.splitlines() if (found := _COMMAND.search(line))]
        found_mesh, found_skew, found_play = read("\n".join(commands), _built("\n".join(commands), machine))
        if found_mesh is None and not found_skew.seen and not found_play:
            what = "there is no M421, M425 or M852 in this file"
            raise TableError(what, "send M503, and save what Marlin answers", file.name)
        meshes += [found_mesh] if found_mesh else []
        skew, play = found_skew if found_skew.seen else skew, play | found_play
    lookups = (lookup for axis, value in play.items() for lookup in _both_ways(machine, axis, value))
    return Loaded(tuple(lookups), tuple(meshes), skew)


def _built(text: str, machine: Machine) -> Mesh | None:
    """Return the points that commands fill, over the travels; raises TableError for a mesh with holes."""
    nodes = {(int(i), int(j)) for i, j in _NODE.findall(text)}
    if not nodes:
        return None
    wide, high = (max(node[side] for node in nodes) + 1 for side in (0, 1))
    if len(nodes) < wide * high or min(wide, high) < 2:
        what = f"the mesh of {wide} x {high} points has {len(nodes)} values"
        raise TableError(what, "give the whole answer to M503, or send M420 S1 first")
    x, y, _ = plane_axes(machine)
    across, along = (np.linspace(*machine.axes[axis].travel, count) for axis, count in ((x, wide), (y, high)))
    return Mesh(across, along, np.zeros((high, wide)))


def _both_ways(machine: Machine, axis: str, play: float) -> Iterator[Lookup]:
    at = np.array(machine.axis(axis).travel)
    yield from (Lookup(axis, axis, at, np.full(2, side * play / 2), side) for side in (1, -1))


def _points(options: ExportOptions) -> int | None:
    """Return the points of a mesh along each side: the firmware was built for those of an old one."""
    for mesh in options.old.meshes if options.mesh is None else ():
        if len(mesh.x) == len(mesh.y):
            return len(mesh.x)
    return options.mesh


def _summed(play: Mapping[str, float], old: Loaded) -> dict[str, float]:
    """Return the lost motion of each axis with what was made up for already."""
    total = dict(play)
    for lookup in old.lookups:
        total[lookup.axis] = total.get(lookup.axis, 0.0) + lookup.direction * float(lookup.added[0])
    return total


def _notes(mesh: Mesh | None, skew: Skew, play: Mapping[str, float]) -> tuple[str, ...]:
    needs = [name for name, used in (("SKEW_CORRECTION", skew.seen), ("BACKLASH_COMPENSATION", play)) if used]
    needs += ["SKEW_CORRECTION_FOR_Z"] if {"XZ", "YZ"} & skew.seen.keys() else []
    back = [code for code, used in (("M425 F0", play), ("M852 I0 J0 K0", skew.seen), ("M420 S0", mesh)) if used]
    notes = [f"The firmware needs {', '.join(needs)}."] if needs else []
    if mesh is not None:
        notes.append(
            f"The firmware needs a mesh of {len(mesh.x)} x {len(mesh.y)} points (GRID_MAX_POINTS_X, _Y) from "
            f"X{_mm(mesh.x)} and Y{_mm(mesh.y)}; export with --mesh for another size. M420 S1 Z0 switches it on, "
            "without fading. Its values are added to Z: positive where the bed is high."
        )
    if skew.seen:
        notes.append(f"M852 sets {', '.join(skew.seen)}: no reading has seen another plane.")
    return (
        *notes,
        f"Send {_FILE} once; it ends with M500.",
        f"Before measuring again take it off: {', '.join(back)}.",
    )


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


def write(mesh: Mesh | None, skew: Skew, play: Mapping[str, float]) -> str:
    """Return the G-code, mm."""
    tangents = " ".join(f"{_SKEW[plane]}{tangent:.7f}" for plane, tangent in skew.seen.items())
    lines = [f"M852 {tangents}"] if tangents else []
    if play:
        words = " ".join(f"{axis}{to_unit(value, 'mm'):.4f}" for axis, value in play.items())
        lines.append(f"M425 {words} F1 S0")
    if mesh is not None:
        heights = np.round(np.asarray(to_unit(mesh.added, "mm")), 4) + 0.0
        lines += [f"M421 I{i} J{j} Z{value:.4f}" for j, row in enumerate(heights) for i, value in enumerate(row)]
    return "\n".join([*lines, "M500"]) + "\n"


def read(text: str, built: Mesh | None) -> tuple[Mesh | None, Skew, dict[str, float]]:
    """Return what Marlin makes of the commands; built : has the points that the firmware was built with."""
    heights = None if built is None else np.zeros(built.added.shape)
    skew, play = Skew(), dict[str, float]()
    for line in text.splitlines():
        command, *words = line.split()
        values = {m[1]: float(m[2]) for word in words if (m := _WORD.fullmatch(word))}
        if command == "M852":
            skew = Skew(*(values.get(letter) for letter in _SKEW.values()))
        elif command == "M425":
            share = values.pop("F", 1.0)
            play = {axis: share * float(from_unit(v, "mm")) for axis, v in values.items() if axis != "S"}
        elif command == "M421" and heights is not None:
            if not values.keys() >= set("IJZ"):
                raise TableError(f"{line[:40]!r} says no height of a point", "write it as in M421 I0 J0 Z0.05")
            heights[int(values["J"]), int(values["I"])] = values["Z"]
    mesh = None if built is None or heights is None else Mesh(built.x, built.y, from_unit(heights, "mm"))
    return mesh, skew, play


def _mm(places: Array) -> str:
    low, high = (to_unit(float(places[end]), "mm") for end in (0, -1))
    return f" {low:g} to {high:g}"
