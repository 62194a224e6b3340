"""What is known beforehand about what two axes do together: an entry such as EZXY of the [errors] table."""

from __future__ import annotations

from dataclasses import dataclass

from axiscal.machine.entry import GUESSED_REST, ErrorEntry
from axiscal.machine.names import COMPONENTS


@dataclass(frozen=True, slots=True)
class PlaneEntry:
    """The prior of one error of two axes, beside the curves of each.

    name : "EZXY"; component : 0…5; std : m or rad, of a plane that held its axes' own curves as well; 0 for a rest only
    sides : knots and correlation lengths along each axis, as of an error of std 1
    rest : of cells of the plane, m or rad; rest_estimated : it is to be learnt from the readings
    usual : nobody stated it, it is what two axes usually do together; then its lengths stay
    stretch : factor on the length along each axis that readings have taught; the splines stay those as stated
    """

    name: str
    component: int
    std: float
    sides: tuple[ErrorEntry, ErrorEntry]
    rest: float | None = None
    rest_estimated: bool = False
    stretch: tuple[float, float] = (1.0, 1.0)
    usual: bool = False

    @property
    def axes(self) -> tuple[str, str]:
        """Names of both axes."""
        first, second = self.sides
        return first.axis, second.axis

    def along(self, index: int) -> str:
        """Return what the length along one of its axes is called: "EZXY along X"."""
        return f"{self.name} along {self.axes[index]}"

    @property
    def angular(self) -> bool:
        """Whether it is a rotation."""
        return self.component >= 3

    @property
    def first_rest(self) -> float:
        """The rest before any reading, m or rad: as stated, a guess where it is to be learnt, else none."""
        return GUESSED_REST * self.std if self.rest is None and self.rest_estimated else self.rest or 0.0


def side_name(component: int, axis: str) -> str:
    """Return the name of the curve that an axis alone would have: "EZX" of "EZXY"."""
    return f"E{COMPONENTS[component]}{axis}"
