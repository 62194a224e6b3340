"""Klipper: the whole estimate as a move transform, an extra of Klipper with a file of the campaign."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from importlib import resources

import numpy as np

from axiscal.estimation.belief import Belief
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.ports.printers.contents import TRIED
from axiscal.tables.export_options import ExportOptions
from axiscal.tables.exporter import Exporter, Written
from axiscal.tables.loaded import Loaded
from axiscal.tables.offer import Draft, spread_poses
from axiscal.tables.old_files import OldFile
from axiscal.tables.surface import Mesh, mesh_control, mesh_of, plane_axes, sum_of
from axiscal.tables.vcomp import vcomp_reading, vcomp_writing
from axiscal.tables.vcomp.applying import component_control, whole_control

_FILE, _EXTRA, _SOURCE = "axiscal.vcomp", "axiscal.py", "klipper_extra.py"
_STEP = 1e-8
"""m: what two rounds and twelve digits may leave."""
_NOTHING = 1e-12
"""m: rounding."""
_POINTS = 33
"""Of the bed along each side: its file is read once, and no probe has to go there."""


class KlipperVolumetric(Exporter):
    """One file of every error, with the extra that takes them away."""

    holds = (
        "every error motion and squareness of X, Y and Z, and the bed, as one move transform: axiscal.vcomp is read by "
        "the extra axiscal.py when Klipper starts."
    )
    left_out = "reversal, the orientation of the tool, and errors of two axes together but for the bed."
    tried = True

    def make(self, estimate: Estimate, options: ExportOptions) -> Draft:
        """Return the files; raises TableError."""
        machine, bed = estimate.machine, _bed(estimate, options.mesh or _POINTS)
        both = sum_of(whole_control(estimate.model, estimate.mean), mesh_control(machine, bed))
        if options.old_files:
            what = "the whole correction cannot go on top of another one"
            raise TableError(what, "measure with AXISCAL ENABLE=0 and without mesh and skew")

        def wanted(poses: Array, approaches: Array) -> Array:
            return both(poses, np.zeros_like(approaches))

        largest = np.max(np.abs(wanted(*spread_poses(estimate))), axis=0)
        if np.max(largest) <= _NOTHING:
            return Draft({}, wanted, wanted, {}, (), self.holds, self.left_out, (), self.tried)
        given = [((k,), 1.0) for k in range(len(machine.axes))]
        file = vcomp_writing.content_of(estimate, given, "mm", largest, options.origin)
        axes = tuple(replace(axis, reversals=np.zeros((len(axis.knots) - 1, 0, 4))) for axis in file.axes)
        text = vcomp_writing.text_of(replace(file, axes=axes, bed=bed), TRIED)
        files = {_FILE: text, _EXTRA: resources.files(__package__).joinpath(_SOURCE).read_text(encoding="utf-8")}
        steps = {axis.name: _STEP for axis in machine.axes}
        held = self.held(Written(files, steps, ()), machine, options)
        return Draft(files, held, wanted, steps, (), self.holds, self.left_out, _notes(file.limit), self.tried)

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what the extra makes of its files; raises TableError."""
        read = vcomp_reading.read_among(files, with_bed=True)
        return Loaded(others=tuple(component_control(each, machine) for each in read))


def _bed(estimate: Estimate, count: int) -> Mesh:
    """Return the height that two axes have together, which no curve of one axis holds.  count : of points a side"""
    plane_axes(estimate.machine)
    mean = estimate.mean.copy()
    for function in estimate.model.functions:
        mean[function.columns] = 0.0
    alone = Belief(mean, np.zeros((len(mean), len(mean))))
    return mesh_of(Estimate(estimate.model, alone, estimate.box), count if estimate.model.planes else 2)


def _notes(limit: float) -> tuple[str, ...]:
    return (
        f"Copy {_EXTRA} into klippy/extras of Klipper (~/klipper/klippy/extras) and {_FILE} beside printer.cfg, write "
        "the line [axiscal] into printer.cfg, and start the service Klipper again. A later campaign brings a new "
        f"{_FILE} only: copy it, then FIRMWARE_RESTART.",
        "It takes the place of bed_mesh and skew_correction: a move beside an active mesh or skew is refused. Take "
        "BED_MESH_PROFILE LOAD and SKEW_PROFILE LOAD out of the start of prints.",
        "AXISCAL ENABLE=0 switches it off, for measuring; AXISCAL ENABLE=1 on. After each start it is on. Homing and "
        "probing go without it: set z_offset anew with it on.",
        f"It moves the motors by up to {limit:.3g} mm: keep so far from position_min and position_max.",
        TRIED,
    )
