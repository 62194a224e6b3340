"""All files for the component: the machine's errors, the HAL text, the source, and notes.

The component (`axiscal_vcomp.comp`) corrects in realtime between motion and drives. It is one for every machine,
installed once by halcompile, and reads the file of a campaign when it is loaded, which `tables.vcomp_file` writes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from axiscal.document.ports import rendered
from axiscal.estimation.machine_estimate import Estimate
from axiscal.tables import vcomp_file
from axiscal.tables.exporter import Written, paragraphs
from axiscal.tables.offer import spread_poses
from axiscal.tables.vcomp_file import whole_control
from axiscal.units import format_quantity

_FILE, HAL_FILE = "axiscal.vcomp", "axiscal-volumetric.hal"
_STATEMENT = "Never run on real drives or on a realtime kernel. It is no safety function."
LOADRT = (  # with quotes: people write blanks between the letters
    f'loadrt axiscal_vcomp file={_FILE} units=[TRAJ]LINEAR_UNITS "coordinates=[TRAJ]COORDINATES" joints=[KINS]JOINTS'
)
_SHARE, _QUICKEST, _SLOWEST = 0.2, 5e-3, 5.0
"""Of a joint's acceleration that a reversal may take, and how many s it takes at least and at most."""
_EVERY = 5
"""Of the poses at which files are tried, for a time that may be a few percent off."""


class LinuxcncVolumetric(vcomp_file.VolumetricFormat):
    """One file of every error for the realtime component, with the component itself."""

    holds = (
        "every error motion, squareness, location error and reversal of the machine as one realtime correction of all "
        "joints, between motion and drives: axiscal.vcomp is read by the component axiscal_vcomp when LinuxCNC starts."
    )
    left_out = (
        "the orientation of the tool beyond what rotary axes turn too far about themselves, what no spline follows, "
        "and errors that one tool length cannot show."
    )
    takes = frozenset({"--unit", "--number", "--ini"})
    step = 1e-9  # by twelve digits
    source = str(__package__), "axiscal_vcomp.comp"

    def seconds(self, estimate: Estimate) -> list[float]:
        """Return for each axis how long its reversal takes, s: T = sqrt(4 J / (0.2 a)), J the step of a joint.

        a : the acceleration of that joint, at any pose; a reversal then takes a fifth of it
        """
        control, axes = whole_control(estimate.machine, estimate.mean), estimate.machine.axes
        poses, times = spread_poses(estimate)[0][::_EVERY], list[float]()
        for k in range(len(axes)):
            way = np.zeros_like(poses)
            way[:, k] = 1.0
            step = np.max(np.abs(control(poses, way) - control(poses, -way)), axis=0)
            time = float(np.max(np.sqrt(4 * step / (_SHARE * np.array([axis.acceleration for axis in axes])))))
            times.append(min(max(time, _QUICKEST), _SLOWEST))
        return times

    def write(self, file: Mapping[str, Any]) -> Written:
        """Return the file and the HAL text."""
        joints = sorted(n for axis in file["axes"] for n in axis["joints"])
        values = {"joints": joints, "nets": {}, "thread": "", "statement": _STATEMENT, "load": LOADRT}
        files = {_FILE: vcomp_file.text_of(file, _STATEMENT)}
        files[HAL_FILE] = rendered("axiscal.ports.linuxcnc", "volumetric.hal.jinja", **values)
        reversing = [axis for axis in file["axes"] if axis["reversals"].shape[1]]
        seconds = ", ".join(f"{axis['name']} {format_quantity(axis['seconds'], 's', 3)}" for axis in reversing)
        told = {
            "file": file,
            "limit": f"{file['limit']:.4g}",
            "rotary": [axis for axis in file["axes"] if axis["rotary"]],
        }
        told |= {"reversing": seconds, "statement": _STATEMENT, "vcomp": _FILE, "hal": HAL_FILE}
        notes, first = (paragraphs(str(__package__), f"volumetric_{part}.jinja", **told) for part in ("notes", "first"))
        return Written(files, {}, notes, first=first)
