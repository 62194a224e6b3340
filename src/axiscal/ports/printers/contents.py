"""What the files of printers hold: the height over the plane, the skew, and one lost motion of each axis."""

from __future__ import annotations

from axiscal.estimation.machine_estimate import Estimate
from axiscal.tables.exporter import ExportOptions, summed
from axiscal.tables.loaded import Loaded, lost_motion
from axiscal.tables.sampling import backlash
from axiscal.tables.surface import Mesh, height_seen, mesh_of, skew_of
from axiscal.units import to_unit

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
    """Return the map and the skew that were seen, and the lost motion.

    points : of the map along each side, None for as many as were read or the curves have
    """
    mesh = mesh_of(estimate, points) if height_seen(estimate) else None
    meshes = () if mesh is None else (mesh.zeroed(*_zero_of(mesh, options)),)
    play = {axis: value for axis, value in backlash(estimate).items() if value > 0}
    return Loaded(lost_motion(estimate.machine, play), meshes, skew_of(estimate))


def _zero_of(mesh: Mesh, options: ExportOptions) -> tuple[float, float]:
    """Return where a mesh is zero: the place that was stated, or the middle."""
    return options.zero or (float(mesh.x[[0, -1]].mean()), float(mesh.y[[0, -1]].mean()))


def zero_note(mesh: Mesh, options: ExportOptions) -> str:
    """Return where a mesh is zero, a sentence for README.txt."""
    place = _zero_of(mesh, options)
    x, y = (f"{to_unit(at, 'mm'):g}" for at in place)
    return (
        f"The mesh is zero at X{x} Y{y}: there the printer has to find the zero of Z, for it homes without the mesh. "
        'Another place is stated by --zero, as in --zero "150 mm, 150 mm".'
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
