"""A machine: its axes from the workpiece to the tool, its tool, and what is known beforehand about its errors."""

from __future__ import annotations

from dataclasses import dataclass

from axiscal.exceptions import DescriptionError
from axiscal.machine.axis import Axis
from axiscal.machine.entry import ErrorEntry

__all__ = ["ErrorEntry", "Machine"]


@dataclass(frozen=True, slots=True)
class Machine:
    """A machine as described by its owner.

    axes : in the order of the chain, from the workpiece to the tool; tool : length of the tool, m
    errors : one entry per error that is not taken to be zero; text : the TOML it came from
    """

    name: str
    axes: tuple[Axis, ...]
    tool: float
    errors: tuple[ErrorEntry, ...]
    chain: str
    text: str

    def index(self, axis_name: str) -> int:
        """Return the place of an axis in a pose; raises DescriptionError for an axis that the machine does not have."""
        names = [axis.name for axis in self.axes]
        if axis_name not in names:
            raise DescriptionError(
                f'there is no axis "{axis_name[:60]}" on the machine "{self.name}"', f"its axes are {', '.join(names)}"
            )
        return names.index(axis_name)

    def axis(self, name: str) -> Axis:
        """Return the axis of that name; raises DescriptionError when there is none."""
        return self.axes[self.index(name)]
