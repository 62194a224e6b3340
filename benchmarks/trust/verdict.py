"""What a set of animals comes to: the share of the truth inside U by kind, slopes, and what falls short."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.zoo.animals import INSIDE, Interval, Judged

MEAN_INSIDE = 0.92
"""Least share of the truth inside U over all kinds."""


@dataclass(frozen=True, slots=True)
class Kind:
    """A family of animals.  found : what became of each"""

    name: str
    found: Sequence[Judged]

    @property
    def named(self) -> float:
        """The share whose cause is named."""
        return float(np.mean([each.named for each in self.found]))

    @property
    def intervals(self) -> list[Interval]:
        """How U does where the cause is not named and a U is printed."""
        return [how for each in self.found if not each.named and (how := each.interval) is not None]

    @property
    def inside(self) -> float | None:
        """The mean share of the truth inside U; None where no U is printed or every cause is named."""
        return float(np.mean([how.inside for how in self.intervals])) if self.intervals else None

    @property
    def least_kept(self) -> float | None:
        """The least share of a slope that a table keeps."""
        return min((each.kept.share for each in self.found if each.kept is not None), default=None)

    def faults(self) -> Iterator[str]:
        """Yield what falls short."""
        for each in self.found:
            if each.named:
                continue
            where = f"{each.animal.name}, machine {each.seed}"
            if each.animal.asked:
                yield f"{where}: no question names the cause"
            elif each.interval is None:
                yield f"{where}: no U, and the cause is not named"
            elif each.kept is not None and not each.kept.holds:
                yield f"{where}: {each.kept.share:.0%} of the slope kept"
        if self.inside is not None and self.inside < INSIDE:
            yield f"{self.name}: {self.inside:.0%} inside U"


def kinds(found: Sequence[Judged]) -> list[Kind]:
    """Return the families in their order."""
    names = dict.fromkeys(each.animal.kind for each in found)
    return [Kind(name, [each for each in found if each.animal.kind == name]) for name in names]


def faults(found: Sequence[Judged]) -> list[str]:
    """Return a line for everything that falls short: nothing where the program may be trusted with these animals."""
    families = kinds(found)
    lines = [line for kind in families for line in kind.faults()]
    shares = [kind.inside for kind in families if kind.inside is not None]
    if shares and np.mean(shares) < MEAN_INSIDE:
        lines.append(f"all kinds: {np.mean(shares):.0%} inside U in the mean")
    return lines
