"""Arguments and options that several commands share."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterator, Mapping
from inspect import Parameter
from pathlib import Path
from typing import Annotated, Any

import typer

from axiscal.exceptions import RecordError, TargetError
from axiscal.units import Dimension, parse_quantity

TABLE = tomllib.loads(Path(__file__).with_name("commands.toml").read_text(encoding="utf-8"))
"""Where commands are and in which group, and the words of what each takes, by file, function and parameter."""
_COMPLETING = "_AXISCAL_COMPLETE"
"""Set by a shell that asks for completions."""


def only_record() -> Path | None:
    """Return the record of AXISCAL_RECORD, or the only one here; None where there is none, or several."""
    if named := os.environ.get("AXISCAL_RECORD"):
        return Path(named)
    here = list(Path.cwd().glob("*.axiscal"))
    return here[0].relative_to(Path.cwd()) if len(here) == 1 else None


def own_record() -> Path:
    """Return the record that is meant where none is named; raises RecordError where that is not clear."""
    if (only := only_record()) is not None:
        return only
    if _COMPLETING in os.environ:  # a shell asks what could be typed: there is nothing to refuse
        return Path()
    here = sorted(Path.cwd().glob("*.axiscal"))
    names = ", ".join(path.name for path in here)
    what = "There are {count} records here: {names}" if here else "There is no campaign record here"
    remedy = "Name the one that is meant, or put its path into AXISCAL_RECORD"
    raise RecordError(what, remedy, Path.cwd(), count=len(here), names=names)


def above_zero(text: str, dimension: Dimension) -> float:
    """Return an accuracy, m, or a time, s, that is to be kept; raises UnitError, TargetError."""
    wanted = parse_quantity(text, dimension)
    if wanted <= 0:
        raise TargetError('"{text}" is not above zero', "Give an accuracy or a time above zero", text=text)
    return wanted


def length_unit(text: str | None) -> str:
    """Return the unit of lengths that a person named, "" for none; raises UnitError for another."""
    if text is not None:
        parse_quantity(f"1 {text}", "length")
    return text or ""


_FACTORIES = {each.__name__: each for each in (own_record, only_record)}
_TYPES: Mapping[str, Any] = {"text": str, "texts": list[str], "path": Path, "number": int, "flag": bool, "choice": bool}


def words_of(place: str) -> Mapping[str, Any]:
    """Return what the table says of a command.  place : "file.function" """
    file, _, function = place.partition(".")
    found: Mapping[str, Any] = TABLE[file][function]
    return found


def parameters(place: str) -> Iterator[Parameter]:
    """Yield the arguments and options of a command as typer reads them.

    A text in the place of a row names one of [shared], as does the parameter itself where there is none.
    """
    words = words_of(place)
    for name in words["takes"]:
        row = words.get(name, name)
        yield _parameter(name, **(TABLE["shared"][row] if isinstance(row, str) else row))


def _parameter(
    name: str, type: str = "text", default: Any = None, required: bool | None = None, **row: Any
) -> Parameter:
    """Return a parameter.  required : left out for an argument that is, and an option that is not"""
    argument, kind = row.pop("argument", ""), _TYPES[type]
    if argument:
        factory = _FACTORIES.get(row.pop("factory", ""))
        words = typer.Argument(metavar=argument, default_factory=factory, **row)
    else:
        words = typer.Option(*row.pop("flags", [f"--{name.replace('_', '-')}"]), **row)
    if default is not None or type == "flag":
        default = Path(default) if type == "path" else default or kind()
    elif argument != "" if required is None else required:
        default = Parameter.empty
    else:
        kind |= None
    return Parameter(name, Parameter.KEYWORD_ONLY, default=default, annotation=Annotated[kind, words])
