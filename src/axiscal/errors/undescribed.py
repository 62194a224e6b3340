"""Errors that a machine's description does not name, and the model therefore takes as zero."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from axiscal.language.spoken import listed, said
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.machine.names import COMPONENTS

_ABOUT = {"XY": "C", "XZ": "B", "YZ": "A"}


def undescribed(machine: Machine) -> str | None:
    """Return in one sentence which of the six errors of each axis, and which squarenesses, are not described.

    None where all are. A squareness may be that of either axis: C0Y or C0X.
    """
    named = {error.name for error in machine.errors}
    missing = [name for axis in machine.axes for name in _motions(axis, named)]
    missing += _squarenesses(machine, named)
    return said("Not described, taken as zero: {names}.", names=listed(", ", missing)) if missing else None


def _motions(axis: Axis, named: set[str]) -> list[str]:
    absent = [name for component in COMPONENTS if (name := f"E{component}{axis.name}") not in named]
    return absent if len(absent) < len(COMPONENTS) else [said("all six of {axis}", axis=axis.name)]


def _squarenesses(machine: Machine, named: set[str]) -> Iterator[str]:
    linear = sorted((axis for axis in machine.axes if not axis.rotary), key=lambda axis: axis.name)
    for first, second in combinations(linear, 2):
        about = _ABOUT.get(first.letter + second.letter)
        if about and not {f"{about}0{first.name}", f"{about}0{second.name}"} & named:
            yield f"{about}0{second.name}"
