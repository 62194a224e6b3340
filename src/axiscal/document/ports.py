"""What packages bring, ours and others: parts by their entry points, loaded at their first use, and templates."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from traceback import walk_tb
from typing import TYPE_CHECKING, Any

from axiscal.exceptions import AxiscalError, PortError

if TYPE_CHECKING:
    from jinja2 import Environment


_GROUPS = "exporters", "dialects", "readers", "sources", "instruments"
"""Entry points by which strangers bring parts."""


def part(name: str) -> Any:
    """Return a part that other rooms use and can do without; raises PortError where its package is not installed."""
    found = one_of("axiscal.parts", name)
    if found is None:
        raise PortError("{name}: this part is not installed", "Install the package that brings it", name=name)
    return found


def names(group: str) -> tuple[str, ...]:
    """Return the names of a group, in the order of the alphabet."""
    return tuple(sorted({point.name for point in _points(group)}))


def one_of(group: str, name: str) -> Any:
    """Return what a package brings under a name, ours first; None where none does, PortError where it cannot load."""
    found = _point(group, name)
    return None if found is None else _tried(found, found.load)


def made_by(group: str, name: str, kind: type, *arguments: object) -> Any:
    """Return what the part of a name makes, which has to be of a class; None and PortError as `one_of`."""
    found = _point(group, name)
    return None if found is None else of_class(name, _tried(found, lambda: found.load()(*arguments)), kind)


def of_class(part: str, found: Any, *kinds: type) -> Any:
    """Return what somebody else's part gave; raises PortError where it is of another class."""
    if not isinstance(found, kinds):
        wanted = " or ".join(kind.__name__ for kind in kinds)
        remedy = "Repair the package that brings it, or uninstall it"
        raise PortError("{part} is a {kind}, no {wanted}", remedy, part=part, kind=type(found).__name__, wanted=wanted)
    return found


def culprit(failure: Exception) -> str:
    """Return the module of another package where something failed, with its line; else who may have had a hand."""
    brought = (point.module.partition(".")[0] for group in _GROUPS for point in _points(f"axiscal.{group}"))
    others = {*brought} & {*sys.modules} - {"axiscal"}
    lines = [(str(frame.f_globals.get("__name__")), line) for frame, line in walk_tb(failure.__traceback__)]
    inside = [f"{name}, line {line}" for name, line in lines if name.partition(".")[0] in others]
    return inside[-1] if inside else " or ".join(["axiscal", *sorted(others)])


def _point(group: str, name: str) -> EntryPoint | None:
    every = (point for point in _points(group) if point.name == name)
    return min(every, key=lambda point: not point.value.startswith("axiscal."), default=None)


def _points(group: str) -> tuple[EntryPoint, ...]:
    return _points_along(os.pathsep.join(sys.path), group)


@cache
def _points_along(path: str, group: str) -> tuple[EntryPoint, ...]:
    """Return a group, looked for once: all installed packages are read.  path : where Python looks for them"""
    return tuple(entry_points(group=group))


def _tried(point: EntryPoint, make: Callable[[], Any]) -> Any:
    try:
        return make()
    except AxiscalError:
        raise
    except Exception as fault:
        what = "{name} = {value} of {group} cannot be loaded ({kind}: {fault})"
        remedy = "Repair the package that brings it, or uninstall it"
        raise PortError(
            what, remedy, name=point.name, value=point.value, group=point.group, kind=type(fault).__name__, fault=fault
        ) from fault


def templates(package: str, **filters: Callable[..., object]) -> Environment:
    """Return what renders the templates of a package; a name that has no value is a fault.

    filters : what they call
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined  # which no campaign needs

    made = Environment(
        loader=PackageLoader(package),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.filters |= filters
    return made


def rendered(package: str, template: str, **values: object) -> str:
    """Return the text that a template of a package makes of values."""
    return templates(package).get_template(template).render(values)
