"""A machine: its axes from the workpiece to the tool, its tool, and what is known beforehand about its errors."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from axiscal.document import Document, shown
from axiscal.document.quoting import meant
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal.machine.axis import Axis
from axiscal.machine.entry import ErrorEntry
from axiscal.machine.plane_entry import PlaneEntry

__all__ = ["ErrorEntry", "Machine", "builtin_names", "load_machine", "machine_from_text"]

_LIBRARY = Path(__file__).parent / "library"
TOOL_RADIUS = 0.04
"""m, of the tool and what holds it where nobody says."""


@dataclass(frozen=True, slots=True)
class Machine:
    """A machine as described by its owner.

    axes : in the order of the chain, from the workpiece to the tool; tool : length of the tool, m
    tool_radius : m, of the cylinder from the tip of the tool to the spindle, which enters nothing that is kept out
    errors : one entry per error of one axis that is not taken to be zero; text : the TOML it came from
    planes : one entry per error of two axes together; stylus : diameter of the ball at the end of a probe, m, or 0
    fine_knots : knots of which nothing is said are as close as is cheap; in records of before they were not
    """

    name: str
    axes: tuple[Axis, ...]
    tool: float
    errors: tuple[ErrorEntry, ...]
    chain: str
    text: str
    planes: tuple[PlaneEntry, ...] = ()
    tool_radius: float = TOOL_RADIUS
    stylus: float = 0.0
    fine_knots: bool = True

    def index(self, axis_name: str) -> int:
        """Return the place of an axis in a pose; raises DescriptionError for an axis that the machine does not have."""
        names = [axis.name for axis in self.axes]
        if axis_name not in names:
            same = [name for name in names if name.casefold() == axis_name.casefold()]
            remedy = meant(axis_name, same, said("Its axes are {known}", known=", ".join(names)), quoted="{}")
            what = "there is no axis {axis} on the machine {machine}"
            raise DescriptionError(what, remedy, axis=shown(axis_name), machine=shown(self.name))
        return names.index(axis_name)

    def with_rests(self, rests: Mapping[str, float]) -> Machine:
        """Return the machine with other rests of errors, by name, m or rad."""
        errors = tuple(replace(e, rest=rests.get(e.name, e.rest)) for e in self.errors)
        planes = tuple(replace(e, rest=rests.get(e.name, e.rest)) for e in self.planes)
        return replace(self, errors=errors, planes=planes)

    @property
    def error_names(self) -> tuple[str, ...]:
        """The names of all errors that are described, those of one axis first."""
        return *(entry.name for entry in self.errors), *(entry.name for entry in self.planes)

    @property
    def zero(self) -> tuple[float, ...]:
        """The pose called machine zero: every axis at 0, or at the end of its travel nearest to it, m or rad."""
        return tuple(min(max(0.0, axis.travel[0]), axis.travel[1]) for axis in self.axes)

    def axis(self, name: str) -> Axis:
        """Return the axis of that name; raises DescriptionError when there is none."""
        return self.axes[self.index(name)]


def builtin_names() -> tuple[str, ...]:
    """Return the names of the built-in machines."""
    return tuple(sorted(path.stem for path in _LIBRARY.glob("*.toml")))


def load_machine(source: str | Path) -> Machine:
    """Return the machine in a file, or the built-in one of that name.

    source : a path, or a name of `builtin_names`, which goes before a file of the same name without an ending
    Raises DescriptionError, ChainError or UnitError with file, line, what is wrong and what would be right.
    """
    if isinstance(source, str) and source in builtin_names():
        return _built(Document.read(_LIBRARY / f"{source}.toml"))
    path = Path(source)
    if path.suffix != ".toml" and len(path.parts) == 1 and not os.path.exists(path):
        otherwise = said("The built-in machines are {known}", known=", ".join(builtin_names()))
        remedy = meant(str(source), builtin_names(), otherwise, quoted="{}")
        raise DescriptionError("{text} is neither a file nor a built-in machine", remedy, text=shown(str(source)))
    return _built(Document.read(path))


def machine_from_text(text: str, source_name: str | Path = "machine.toml", *, fine_knots: bool = True) -> Machine:
    """Return the machine in a TOML text; raises as `load_machine`.

    source_name : what failures call it; fine_knots : as in `Machine`
    """
    return _built(Document.parse(text, source_name), fine_knots)


def _built(document: Document, fine_knots: bool = True) -> Machine:
    from axiscal.machine.building import assemble

    return Machine(text=document.text, fine_knots=fine_knots, **assemble(document, fine_knots)._asdict())
