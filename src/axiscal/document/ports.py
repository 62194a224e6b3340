"""What packages bring, ours and others: parts by their entry points, loaded at their first use, and templates."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import TYPE_CHECKING, Any

from axiscal.exceptions import PortError

if TYPE_CHECKING:
    from jinja2 import Environment


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
    every = (point for point in _points(group) if point.name == name)
    found = min(every, key=lambda point: not point.value.startswith("axiscal."), default=None)
    return None if found is None else _loaded(found)


def all_of(group: str) -> list[Any]:
    """Return everything of a group; raises PortError where one cannot be loaded."""
    return [_loaded(point) for point in _points(group)]


def _points(group: str) -> tuple[EntryPoint, ...]:
    return _points_along(os.pathsep.join(sys.path), group)


@cache
def _points_along(path: str, group: str) -> tuple[EntryPoint, ...]:
    """Return a group, looked for once: all installed packages are read.  path : where Python looks for them"""
    return tuple(entry_points(group=group))


def _loaded(point: EntryPoint) -> Any:
    try:
        return point.load()
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
