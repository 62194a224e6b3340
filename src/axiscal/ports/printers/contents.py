"""What the files of printers hold: the height over the plane, the skew, and one lost motion of each axis."""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar

from axiscal.estimation.machine_estimate import Estimate
from axiscal.measurement.readers.text_file import TextFile
from axiscal.tables.exporter import Exporter, ExportOptions, Written, paragraphs
from axiscal.tables.loaded import Loaded, OldFile, lost_motion
from axiscal.tables.sampling import backlash
from axiscal.tables.surface import Mesh, height_seen, mesh_of, skew_of, with_height
from axiscal.units import to_unit
from axiscal_core.machine import Machine

STEP = 1e-7
"""The last decimal that G-code is written with, m."""
_COMMAND = re.compile(r"^\s*([GM]\d+)\b([^;\n]*)", re.MULTILINE)
_WORD = re.compile(r"([A-Z])\s*(-?[\d.]+)")


PrinterFiles = tuple[Mapping[str, str], Mapping[str, float], Mapping[str, Any]]
"""Files by name, none for what was not seen; what rounding may leave of each axis, m; values of the template."""


class PrinterFormat(Exporter):
    """A printer of X, Y and Z: its files hold what readings have seen.

    template : of what README.txt says; backlashes : it knows one of each axis
    usual : points of a mesh along each side where nobody says, None for as many as the curves have
    """

    left_out = (
        "positioning errors, straightness in the plane, reversal that changes along an axis or runs ahead, and what "
        "the height does over z."
    )  # by a firmware that knows one backlash of each axis
    takes = frozenset({"--mesh", "--zero"})
    template: ClassVar[str]
    backlashes: ClassVar[bool] = True
    usual: ClassVar[int | None] = None

    @abstractmethod
    def printed(self, content: Loaded, machine: Machine) -> PrinterFiles:
        """Return the files, mm; raises TableError for what the printer does not take."""

    def content(self, estimate: Estimate, options: ExportOptions) -> Loaded:
        """Return the map and the skew that were seen, and the lost motion."""
        mesh = None
        if height_seen(estimate):
            mesh = mesh_of(estimate, options.mesh or (None if estimate.grid else self.usual))
        meshes = () if mesh is None else (mesh.zeroed(*_zero_of(mesh, options)),)
        play = {axis: value for axis, value in backlash(estimate).items() if value > 0} if self.backlashes else {}
        return Loaded(lost_motion(estimate.machine, play), meshes, skew_of(estimate))

    def make(self, estimate: Estimate, options: ExportOptions) -> Written:
        """Return the files; raises TableError."""
        estimate = with_height(estimate)
        machine, content = estimate.machine, self.content(estimate, options)
        files, steps, known = self.printed(content, machine)
        play = play_of(content)
        known = {"meshes": content.meshes, "skew": content.skew, "play": play, **known}
        known |= {
            "mm": lambda place: f"{to_unit(float(place), 'mm'):g}",
            "zero_of": lambda mesh: _zero_of(mesh, options),
        }
        words = ["height over the plane as a bed mesh"] if content.meshes else []
        words = [" and ".join([*words, f"the skew of {', '.join(content.skew)}"])] if content.skew else words
        words += [f"one backlash for {', '.join(play)}"] if play else []
        written = Written(files, steps, paragraphs(__package__, self.template, **known), "; ".join(words) + ".")
        return replace(self.draft(written, content.control(machine), machine, options), about=estimate)


def _zero_of(mesh: Mesh, options: ExportOptions) -> tuple[float, float]:
    """Return where a mesh is zero: the place that was stated, or the middle."""
    return options.zero or (float(mesh.x[[0, -1]].mean()), float(mesh.y[[0, -1]].mean()))


def play_of(content: Loaded) -> dict[str, float]:
    """Return the lost motion that tables make up for, half of it to each side, m."""
    return {table.axis: float(table.reverse[0] - table.forward[0]) for table in content.tables}


def play_text(content: Loaded) -> str:
    """Return the lost motion as words of G-code, mm."""
    return " ".join(f"{axis}{to_unit(value, 'mm'):.4f}" for axis, value in play_of(content).items())


def commands_of(files: Sequence[OldFile]) -> dict[str, dict[str, float]]:
    """Return the words of each command of G-code, of the last one that a file has."""
    lines = (found for file in files for found in _COMMAND.findall(file.text))
    return {code: {letter: float(word) for letter, word in _WORD.findall(words)} for code, words in lines}


def texts_of(files: Sequence[OldFile]) -> list[TextFile]:
    """Return files as their readers take them."""
    return [TextFile(file.name, tuple(file.text.splitlines())) for file in files]
