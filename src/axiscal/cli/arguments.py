"""Arguments and options that several commands share."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Callable, Mapping, Sequence
from inspect import Parameter, Signature, signature
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_type_hints

import typer

from axiscal.exceptions import RecordError, TargetError
from axiscal.units import Dimension, parse_quantity

Command = TypeVar("Command", bound=Callable[..., None])
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


def records_here(incomplete: str) -> list[str]:
    """Return the records in this folder whose names begin so, for a shell that completes what is typed."""
    return sorted(path.name for path in Path.cwd().glob("*.axiscal") if path.name.startswith(incomplete))


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


_DEFAULTS = {each.__name__: each for each in (own_record, only_record)}


def explained(command: Command, rows: Mapping[str, Any]) -> Command:
    """Return a command whose arguments and options typer shows in the words of the table.

    rows : of `TABLE` by parameter; a text names a row of [shared], as does the parameter itself where there is none
    """
    types, found = get_type_hints(command), list[Parameter]()
    for each in signature(command).parameters.values():
        row = rows.get(each.name, each.name)
        words = _words(each.name, **(TABLE["shared"][row] if isinstance(row, str) else row))
        found.append(each.replace(annotation=Annotated[types[each.name], words]))
    command.__signature__ = Signature(found)  # type: ignore[attr-defined]
    return command


def _words(name: str, argument: str = "", flags: Sequence[str] = (), default: str = "", **row: Any) -> Any:
    """Return what typer is told of a parameter.  argument : how it is called in the usage, "" for an option"""
    if argument:
        completing = records_here if argument == "RECORD" else None
        return typer.Argument(
            metavar=argument, default_factory=_DEFAULTS.get(default), autocompletion=completing, **row
        )
    return typer.Option(*(flags or [f"--{name.replace('_', '-')}"]), **row)
