"""The controls that programs can be written for, by the names that people type."""

from __future__ import annotations

from importlib import import_module

from axiscal.document import nearest, shown
from axiscal.exceptions import ProgramError
from axiscal.gcode.dialect import Dialect

_ROOM = "axiscal.gcode.dialects"
_DIALECTS = {
    "linuxcnc": "LinuxCNC",
    "sinumerik": "Sinumerik",
    "heidenhain": "Heidenhain",
    "fanuc": "Fanuc",
    "isg": "Isg",
}


def controllers() -> tuple[str, ...]:
    """Return the names of the controls."""
    return tuple(_DIALECTS)


def dialect(controller: str) -> Dialect:
    """Return the words of a control; raises ProgramError for one that is not known."""
    name = controller.casefold()
    if name not in _DIALECTS:
        near = nearest(controller, controllers())
        remedy = f"Perhaps {near} is meant" if near else f"Known are {', '.join(controllers())}"
        raise ProgramError(f"{shown(controller)} is not a controller that programs can be written for", remedy)
    found: type[Dialect] = getattr(import_module(f"{_ROOM}.{name}"), _DIALECTS[name])
    return found()
