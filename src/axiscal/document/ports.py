"""Ports, each loaded at its first use: ours by their place, those of installed packages by their entry points."""

from __future__ import annotations

from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from axiscal.exceptions import PortError


def ours(place: str) -> Any:
    """Return what a port of ours has, loaded now.  place : its module below axiscal, and a name there: `module:name`"""
    module, _, name = place.partition(":")
    return getattr(import_module(f"axiscal.{module}"), name)


def names(group: str) -> tuple[str, ...]:
    """Return the names of a group, in the order of the alphabet."""
    return tuple(sorted(point.name for point in entry_points(group=group)))


def one_of(group: str, name: str) -> Any:
    """Return what a package brings under a name, None where none does; raises PortError where it cannot be loaded."""
    found = next(iter(entry_points(group=group, name=name)), None)
    return None if found is None else _loaded(found)


def all_of(group: str) -> list[Any]:
    """Return everything of a group; raises PortError where one cannot be loaded."""
    return [_loaded(point) for point in entry_points(group=group)]


def _loaded(point: EntryPoint) -> Any:
    try:
        return point.load()
    except Exception as fault:
        what = "{name} = {value} of {group} cannot be loaded ({kind}: {fault})"
        remedy = "Repair the package that brings it, or uninstall it"
        raise PortError(
            what, remedy, name=point.name, value=point.value, group=point.group, kind=type(fault).__name__, fault=fault
        ) from fault
