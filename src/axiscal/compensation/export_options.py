"""What a person may choose for an export."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from axiscal.compensation.loaded import Loaded
from axiscal.compensation.old_files import OldFile
from axiscal.document import shown
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,30}")

_LARGEST_MESH = 50
_MOST_POINTS = 5000
_USUAL = "XYZABCUVWPQR"


@dataclass(frozen=True, slots=True)
class ExportOptions:
    """Choices; what a controller has no use for it does not look at.

    spacing : distance of the points of linear axes, m; unit : of the machine, mm or in
    numbers : of the joint or machine axis of each axis, where the order of the letters is not theirs
    template : text of a file that the control saved, template_name : how it is called
    name : of a mesh or profile; mesh : points of a height map along each side, as many as the map that was read or the
    curves have where nobody says
    pivots : put location errors of rotary axes into the kinematics (linuxcnc) instead of the tables
    points : the most of a table, where the control's memory is set by its owner; encoder : measuring system, 1 or 2
    flip : the control takes the values with the other sign, as a check at one point has shown
    old_files : of the compensation that was active while measuring; old : what they say, once they are read
    active : whether one was, None where nobody said
    Raises TableError for a name that is more than letters, digits, _ and -.
    """

    spacing: float | None = None
    unit: str = "mm"
    numbers: Mapping[str, int] = field(default_factory=dict)
    template: str | None = None
    template_name: str = "the template"
    name: str = "axiscal"
    mesh: int | None = None
    flip: bool = False
    pivots: bool = False
    points: int | None = None
    encoder: int = 1
    old_files: tuple[OldFile, ...] = ()
    old: Loaded = field(default_factory=Loaded)
    active: bool | None = None

    def numbered(self, machine: Machine, first: int = 1) -> dict[str, int]:
        """Return the number of each axis in the control: from `first` in the order X Y Z A B C … unless chosen."""
        ordered = sorted((axis.name for axis in machine.axes), key=lambda name: (_USUAL.index(name[0]), name))
        return {name: self.numbers.get(name, number) for number, name in enumerate(ordered, first)}

    def __post_init__(self) -> None:
        if not _NAME.fullmatch(self.name):
            raise TableError(
                f"{shown(self.name)} is not a name for a table", "Take letters, digits, _ and -, 31 at most"
            )
        if self.unit not in ("mm", "in"):
            raise TableError(f"{shown(self.unit)} is not the unit of a machine", "It can be mm or in")
        if self.mesh is not None and not 2 <= self.mesh <= _LARGEST_MESH:
            raise TableError(f"a mesh of {self.mesh} points a side", f"Take 2 to {_LARGEST_MESH}")
        if self.encoder not in (1, 2):
            raise TableError(f"measuring system {self.encoder}", "An axis has measuring systems 1 and 2")
        if self.points is not None and not 2 <= self.points <= _MOST_POINTS:
            raise TableError(f"a table of {self.points} points", f"Take 2 to {_MOST_POINTS}")
        if any(number < 0 for number in self.numbers.values()):
            raise TableError("numbers of axes are negative", "Count from 0 or 1 as the control does")
