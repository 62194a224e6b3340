"""grblHAL: the whole estimate as kinematics of its own, a plugin that is built into the firmware with its table."""

from __future__ import annotations

from importlib import resources
from typing import ClassVar

import numpy as np

from axiscal import tables
from axiscal.estimation.machine_estimate import Estimate
from axiscal.language.spoken import later
from axiscal.tables import vcomp_file
from axiscal.tables.exporter import Draft, ExportOptions, Written, paragraphs
from axiscal.tables.offer import spread_poses
from axiscal.tables.vcomp_applying import CORE, VcompFile, whole_control

_FILE, _TABLE, _PLUGIN = "axiscal.vcomp", "axiscal_table.h", "axiscal_grblhal.c"
TRIED = "Its code was tried against grblHAL's interface of 2026, never in a controller with drives."
_STEP = 1e-8
"""m: what two rounds and twelve digits may leave; a controller rounds to 1e-7 of a position besides."""
_NOTHING = 1e-12
"""m: rounding."""


class GrblHal(vcomp_file.VolumetricFormat):
    """One table of every error, with the plugin that takes them away."""

    holds = (
        "every error motion, squareness, location error and reversal of the machine, as kinematics of grblHAL: "
        "axiscal_table.h is built into the firmware."
    )
    left_out = "the orientation of the tool beyond what rotary axes turn too far about themselves, and tool lengths."
    takes = frozenset({"--number"})
    instead: ClassVar = {
        "--on-top-of": later("a whole correction goes on top of none: measure with the firmware as it was, $160 to 0")
    }

    def make(self, estimate: Estimate, options: ExportOptions) -> Draft:
        """Return the files; raises TableError."""
        machine, wanted = estimate.machine, whole_control(estimate.machine, estimate.mean)
        poses, _ = spread_poses(estimate)
        largest = np.max([np.abs(wanted(poses, way * np.ones_like(poses))) for way in (1.0, -1.0)], axis=(0, 1))
        if np.max(largest) <= _NOTHING:
            return Draft({}, {}, (), self.holds, self.left_out, control=wanted, wanted=wanted)
        numbers = options.joints(machine)
        file = vcomp_file.content_of(
            estimate, [(numbers[a.name], 1.0) for a in machine.axes], "mm", largest, options.origin
        )
        text = vcomp_file.text_of(file, TRIED)
        files = {
            _FILE: text,
            _TABLE: _as_header(file, text),
            _PLUGIN: resources.files(__package__).joinpath(_PLUGIN).read_text(encoding="ascii"),
            CORE: resources.files(tables).joinpath(CORE).read_text(encoding="ascii"),
        }
        steps = {axis.name: _STEP for axis in machine.axes}
        notes = paragraphs(__package__, "notes.jinja", campaign=file.campaign, limit=file.limit, tried=TRIED)
        return self.draft(Written(files, steps, notes), wanted, machine, options)


def _as_header(file: VcompFile, text: str) -> str:
    """Return a table as a string of C, with the room that it takes."""
    knots = max(len(axis.knots) for axis in file.axes)
    lines = "\n".join(f'    "{line}\\n"' for line in text.splitlines())
    return (
        f"#define VC_AXES {len(file.axes)}\n#define VC_KNOTS {knots}\nstatic const char AXISCAL_TABLE[] =\n{lines};\n"
    )
