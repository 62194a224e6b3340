"""What the files of printers hold: the height over the plane, the skew, and one lost motion of each axis."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from axiscal.estimation.machine_estimate import Estimate
from axiscal.measurement.readers.text_file import TextFile
from axiscal.tables.exporter import ExportOptions, MapFormat, Written, paragraphs, summed
from axiscal.tables.loaded import Loaded, OldFile, lost_motion
from axiscal.tables.sampling import backlash
from axiscal.tables.surface import Mesh, height_seen, mesh_of, skew_of
from axiscal.units import to_unit
from axiscal_core.machine import Machine

STEP = 1e-7
"""The last decimal that G-code is written with, m."""


class PrinterFormat(MapFormat):
    """A printer: its files hold what readings have seen.

    template : of what README.txt says, with the values of `known` besides
    """

    left_out = (
        "positioning errors, straightness in the plane, reversal that changes along an axis or runs ahead, and what "
        "the height does over z."
    )  # by a firmware that knows one backlash of each axis
    template: ClassVar[str]

    def content(self, estimate: Estimate, options: ExportOptions) -> Loaded:
        """Return what was seen; raises TableError for what the printer does not take."""
        return content_of(estimate, options, options.mesh)

    @abstractmethod
    def files(self, content: Loaded) -> dict[str, str]:
        """Return the files by name; none for what was not seen."""

    @abstractmethod
    def steps(self, content: Loaded, machine: Machine) -> dict[str, float]:
        """Return what rounding may leave of each axis, m."""

    def known(self, content: Loaded) -> Mapping[str, Any]:
        """Return more values of the template."""
        return {}

    def write(self, content: Loaded, machine: Machine, options: ExportOptions) -> Written:
        """Return the files, with what to know of them."""
        told = {"meshes": content.meshes, "skew": content.skew, "play": play_of(content), **self.known(content)}
        told |= {
            "mm": lambda place: f"{to_unit(float(place), 'mm'):g}",
            "zero_of": lambda mesh: _zero_of(mesh, options),
        }
        words = ["height over the plane as a bed mesh"] if content.meshes else []
        words = [" and ".join([*words, f"the skew of {', '.join(content.skew)}"])] if content.skew else words
        words += [f"one backlash for {', '.join(told['play'])}"] if told["play"] else []
        notes = paragraphs(__package__, self.template, **told)
        return Written(self.files(content), self.steps(content, machine), notes, "; ".join(words) + ".")


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


def play_of(content: Loaded) -> dict[str, float]:
    """Return the lost motion that tables make up for, half of it to each side, m."""
    return summed((one.axis, float(one.reverse[0] - one.forward[0])) for one in content.tables)


def texts_of(files: Sequence[OldFile]) -> list[TextFile]:
    """Return files as their readers take them."""
    return [TextFile(file.name, tuple(file.text.splitlines())) for file in files]
