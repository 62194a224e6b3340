"""What is promised of the tool point, and what check readings say of it, in display units."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """Expanded uncertainties of the tool point over the volume, 95 %, um.

    space : of the distance; axes : along x, y, z of the workpiece frame; worst : of the distance at the worst place
    factor : of `space` over the standard uncertainty of the model; conditions : what it was evaluated for, in words
    standard : uncertainty RMS of the distribution that `space` is of, where that is not the model's
    along : the directions whose distance `space` and `worst` are, such as "z" of a bed; all of them where it is "xyz"
    """

    space: float
    axes: tuple[float, float, float]
    worst: float
    factor: float
    conditions: str = ""
    standard: float | None = None
    along: str = "xyz"

    @property
    def k(self) -> float:
        """Of `space` over the standard uncertainty of the same distribution."""
        return self.space / self.standard if self.standard else self.factor


@dataclass(frozen=True, slots=True)
class Linear:
    """How linear machine and readings are.

    bound_um : no machine within the bands differs by more from its first order; index : the largest ν of a reading
    words : the same in a sentence
    """

    bound_um: float
    index: float
    words: str


@dataclass(frozen=True, slots=True)
class CheckReadings:
    """What readings say that were predicted before they were used, um; words : the same in a sentence."""

    count: int
    promised_um: float
    found_um: float
    low: float
    high: float
    words: str
