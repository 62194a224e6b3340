"""What the files of printers hold: the height over the plane, the skew, and one lost motion of each axis."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.measurement.readers.homing import Place, zero_in
from axiscal.tables.exporter import ExportOptions, summed
from axiscal.tables.loaded import Loaded, OldFile, lost_motion
from axiscal.tables.sampling import backlash
from axiscal.tables.surface import Mesh, height_seen, mesh_of, skew_of
from axiscal.units import to_unit

_COMMAND = re.compile(r"(?<![;\w])\b(M425|M556|M852)\b([^;\n*]*)")

LEFT_OUT = (
    "positioning errors, straightness in the plane, reversal that changes along an axis or runs ahead, and what the "
    "height does over z."
)
"""By a firmware that knows one backlash of each axis."""
STEP = 1e-7
"""The last decimal that G-code is written with, m."""
TRIED = "Tried with Klipper's own host by the steps of the motors, never on a printer."
"""Of its files; `make controls` does it again."""


def content_of(estimate: Estimate, options: ExportOptions, points: int | None) -> Loaded:
    """Return the map and the skew that were seen, and the lost motion, with what was active already.

    points : of the map along each side, None for as many as were read or the curves have
    """
    old = options.old
    found = [old.under_mesh(mesh_of(estimate, points))] if height_seen(estimate) else []
    meshes = tuple(mesh.zeroed(*_zero_of(mesh, options)) for mesh in found)
    lost = ((axis, value) for axis, value in backlash(estimate).items() if value > 0)
    play = summed([*lost, *play_of(old).items()])
    skew = {plane: tangent + old.skew.get(plane, 0.0) for plane, tangent in skew_of(estimate).items()}
    return Loaded(lost_motion(estimate.machine, play), meshes, skew)


def other_words(file: OldFile, allowed: Mapping[str, str]) -> Iterator[TableError]:
    """Yield a failure for each command with a word that its reader has no use for.  allowed : letters by command"""
    for line, text in enumerate(file.text.splitlines(), 1):
        found = _COMMAND.search(text)
        if found and found[1] in allowed and re.sub(rf"[{allowed[found[1]]}]\s*-?[\d.]+", "", found[2]).strip():
            what, remedy = "{text!r} has a word that is not taken", "known are {letters}, each with its number"
            letters = " ".join(allowed[found[1]])
            yield TableError(what, remedy, file.name, line, text=found[0].strip()[:60], letters=letters)


def _zero_of(mesh: Mesh, options: ExportOptions) -> Place:
    """Return where a mesh is zero: the place that was stated, or the middle."""
    stated = options.zero or next(filter(None, (zero_in(file.text) for file in options.old_files)), None)
    return stated or (float(mesh.x[[0, -1]].mean()), float(mesh.y[[0, -1]].mean()))


def zero_note(mesh: Mesh, options: ExportOptions) -> str:
    """Return where a mesh is zero, a sentence for README.txt."""
    place = _zero_of(mesh, options)
    x, y = (f"{to_unit(at, 'mm'):g}" for at in place)
    return (
        f"The mesh is zero at X{x} Y{y}: there the printer has to find the zero of Z, for it homes without the mesh. "
        'Another place is stated by --zero: printer.cfg, homez.g, Configuration.h, or "150 mm, 150 mm".'
    )


def in_words(content: Loaded) -> str:
    """Return what files hold, a sentence."""
    skew, play = content.skew, play_of(content)
    words = ["height over the plane as a bed mesh"] if content.meshes else []
    words = [" and ".join([*words, f"the skew of {', '.join(skew)}"])] if skew else words
    return "; ".join([*words, f"one backlash for {', '.join(play)}"] if play else words) + "."


def play_of(content: Loaded) -> dict[str, float]:
    """Return the lost motion that tables make up for, half of it to each side, m."""
    return summed((one.axis, float(one.reverse[0] - one.forward[0])) for one in content.tables)
