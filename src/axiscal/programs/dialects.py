"""Our dialects, as `dialects.toml` has them: the words of each control as it reads them, by its manuals."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import fields
from importlib import resources
from typing import Any

from axiscal.document import meant, shown
from axiscal.document.ports import names, of_class, one_of
from axiscal.exceptions import ProgramError
from axiscal.programs.dialect import Dialect, Log

_TOLD: Mapping[str, dict[str, Any]] = tomllib.loads(
    resources.files(__package__).joinpath("dialects.toml").read_text(encoding="utf-8")
)


def _of(kind: type[Dialect | Log], told: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a table says of the fields of a class: several lines are written as one text, or as a list."""
    lines = {field.name for field in fields(kind) if field.type.startswith("Lines")}
    texts = {name: value.splitlines() for name, value in told.items() if name in lines and isinstance(value, str)}
    return {name: tuple(value) if name in lines else value for name, value in {**told, **texts}.items()}


def _dialect(name: str) -> Dialect:
    told = _TOLD[name]
    log = Log(**_of(Log, told["log"])) if "log" in told else None
    return Dialect(**_of(Dialect, told) | {"log": log})


FANUC, HEIDENHAIN, ISG, LINUXCNC, SINUMERIK = map(_dialect, ("fanuc", "heidenhain", "isg", "linuxcnc", "sinumerik"))
_DIALECTS = {"linuxcnc": LINUXCNC, "sinumerik": SINUMERIK, "heidenhain": HEIDENHAIN, "fanuc": FANUC, "isg": ISG}
PORTS = "axiscal.dialects"
"""Group of the entry points by which packages bring words of a control."""


def controllers() -> tuple[str, ...]:
    """Return the names of the controls that axiscal knows itself."""
    return tuple(_DIALECTS)


def dialect(controller: str) -> Dialect:
    """Return the words of a control; raises ProgramError for one that is not known."""
    found = _DIALECTS.get(controller.casefold()) or one_of(PORTS, controller)
    if found is None:
        remedy = meant(controller, (*_DIALECTS, *names(PORTS)), quoted="{}")
        what = "{name} is not a controller that programs can be written for"
        raise ProgramError(what, remedy, name=shown(controller))
    words: Dialect = of_class(controller, found, Dialect)
    return words
