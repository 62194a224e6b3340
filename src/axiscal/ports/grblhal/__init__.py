"""grblHAL: the whole estimate as kinematics of its own, a plugin that is built into the firmware with its table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from axiscal.estimation.machine_estimate import Estimate
from axiscal.tables import vcomp_file
from axiscal.tables.exporter import Written, paragraphs

_FILE, _TABLE = "axiscal.vcomp", "axiscal_table.h"
TRIED = "Its code was tried against grblHAL's interface of 2026, never in a controller with drives."


class GrblHal(vcomp_file.VolumetricFormat):
    """One table of every error, with the plugin that takes them away."""

    holds = (
        "every error motion, squareness, location error and reversal of the machine, as kinematics of grblHAL: "
        "axiscal_table.h is built into the firmware."
    )
    left_out = "the orientation of the tool beyond what rotary axes turn too far about themselves, and tool lengths."
    takes = frozenset({"--number"})
    source = __package__, "axiscal_grblhal.c"
    step = 1e-8  # two rounds and twelve digits; a controller rounds to 1e-7 of a position besides

    def seconds(self, estimate: Estimate) -> list[float]:
        """Return a second for each axis: the plugin turns a side within a part of a line."""
        return [1.0] * len(estimate.machine.axes)

    def write(self, file: Mapping[str, Any]) -> Written:
        """Return the table, and once more as a header."""
        text = vcomp_file.text_of(file, TRIED)
        files = {_FILE: text, _TABLE: _as_header(file, text)}
        notes = paragraphs(__package__, "notes.jinja", tried=TRIED, **file)
        return Written(files, {}, notes)


def _as_header(file: Mapping[str, Any], text: str) -> str:
    """Return a table as a string of C, with the room that it takes."""
    axes = file["axes"]
    lines = "\n".join(f'    "{line}\\n"' for line in text.splitlines())
    room = f"#define VC_AXES {len(axes)}\n#define VC_KNOTS {max(len(axis['knots']) for axis in axes)}\n"
    return f"{room}static const char AXISCAL_TABLE[] =\n{lines};\n"
