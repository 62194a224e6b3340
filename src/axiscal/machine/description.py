"""A machine: its axes from the workpiece to the tool, its tool, and what is known beforehand about its errors."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from axiscal.document import Document, read_model, shown
from axiscal.document.quoting import meant
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal.machine.machine_schema import MachineFile
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine, Nose
from axiscal_core.refusals import one

_LIBRARY = Path(__file__).parent / "library"


def _described(document: Document, fine_knots: bool = True) -> DescribedMachine:
    """Return the machine in a document; raises DescriptionError or UnitError.  fine_knots : as in it"""
    found = read_model(document, MachineFile, context=fine_knots)
    tool, axes = found.tool, tuple(found.axes.values())
    nose = Nose(tool.radius, tool.stylus, tool.reach, tuple(tool.head))
    named = {"name": found.name or document.path.stem, "nose": nose, "unit": _unit(axes, document)}
    return DescribedMachine(axes, found.errors, tool.length, **named, text=document.text)


def _unit(axes: tuple[Axis, ...], document: Document) -> str:
    """Return the unit in which the control counts lengths: in where all linear travels are written so, else mm."""
    linear = [document.data["axes"][axis.name]["travel"][1] for axis in axes if not axis.rotary]
    return "in" if linear and all(text.endswith(("in", "inch")) for text in linear) else "mm"


@dataclass(frozen=True, eq=False, repr=False, init=False)
class DescribedMachine(Machine):
    """A machine as its owner wrote it.  text : the TOML that it came from"""

    text: str

    def __init__(self, *given: Any, text: str = "", **named: Any) -> None:
        super().__init__(*given, **named)
        object.__setattr__(self, "text", text)

    def index(self, name: str) -> int:
        """Return the place of an axis in a pose; raises DescriptionError for an axis that the machine does not have."""
        if name not in self.axis_names:
            same = [each for each in self.axis_names if each.casefold() == name.casefold()]
            remedy = meant(name, same, said("Its axes are {known}", known=", ".join(self.axis_names)), quoted="{}")
            what = "there is no axis {axis} on the machine {machine}"
            raise DescriptionError(what, remedy, axis=shown(name), machine=shown(self.name))
        return self.axis_names.index(name)


def builtin_names() -> tuple[str, ...]:
    """Return the names of the built-in machines."""
    return tuple(sorted(path.stem for path in _LIBRARY.glob("*.toml")))


def load_machine(source: str | Path) -> DescribedMachine:
    """Return the machine in a file, or the built-in one of that name.

    source : a path, or a name of `builtin_names`, which goes before a file of the same name without an ending
    Raises DescriptionError or UnitError with file, line, what is wrong and what would be right.
    """
    one("load_machine", "source", source, (str, Path), '"dmu60", or "machine.toml"')
    if isinstance(source, str) and source in builtin_names():
        return _described(Document.read(_LIBRARY / f"{source}.toml"))
    path = Path(source)
    if path.suffix != ".toml" and len(path.parts) == 1 and not os.path.exists(path):
        otherwise = said("The built-in machines are {known}", known=", ".join(builtin_names()))
        remedy = meant(str(source), builtin_names(), otherwise, quoted="{}")
        raise DescriptionError("{text} is neither a file nor a built-in machine", remedy, text=shown(str(source)))
    return _described(Document.read(path))


def machine_from_text(
    text: str, source_name: str | Path = "machine.toml", *, fine_knots: bool = True
) -> DescribedMachine:
    """Return the machine in a TOML text; raises as `load_machine`.

    source_name : what failures call it
    fine_knots : knots of which nothing is said are as close as is cheap; in records of before they were not
    """
    return _described(Document.parse(text, source_name), fine_knots)
