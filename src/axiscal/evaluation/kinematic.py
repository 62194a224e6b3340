"""Kinematic tests by ISO 10791-6: a point, or the length of a bar, held while axes move together.

Circles with a rotary axis in step (K), and a point held while a rotary axis of head or table turns (AK, BK, CK). For
each test, along each direction in which it is read, over the whole path

    E_plus, E_minus   max e − min e while the angle grows, while it falls
    E                 max e − min e of both ways together

A constant is the place of the ball or the instrument, and is in none of them. After ISO 10791-6:2014, quoted from
memory; the names of the figures are ours.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from axiscal.exceptions import EvaluationError
from axiscal.measurement.readers.around import HeldPath
from axiscal.units import to_unit

_FEWEST = 4
"""Readings of a way, below which a range says nothing: the ends and two between."""


@dataclass(frozen=True, slots=True)
class Kinematic:
    """Figures by name, m, such as `CK_x`, `CK_x_plus`, `CK_x_minus`."""

    figures: Mapping[str, float]
    warnings: tuple[str, ...] = ()

    def as_json(self) -> dict[str, object]:
        """Return the document `axiscal-iso10791-6/1`, figures in um."""
        figures = {name: to_unit(value, "um") for name, value in self.figures.items()}
        return {"schema": "axiscal-iso10791-6/1", "unit": "um", "figures": figures, "warnings": list(self.warnings)}


def kinematic(tests: Mapping[str, HeldPath]) -> Kinematic:
    """Return the figures of tests by name; raises EvaluationError for a way of fewer than four readings."""
    figures, warnings = dict[str, float](), list[str]()
    for name, test in tests.items():
        ways = {"plus": test.directions > 0, "minus": test.directions < 0}
        read = {way: mine for way, mine in ways.items() if np.any(mine)}
        if any(np.sum(mine) < _FEWEST for mine in read.values()):
            what = "{name} has a way of fewer than {least} readings"
            raise EvaluationError(what, "Read it at four angles or more", test.file, name=name, least=_FEWEST)
        for along, values in test.deviations.items():
            stem = f"{name}_{along}" if along else name
            figures[stem] = float(np.ptp(values))
            figures |= {f"{stem}_{way}": float(np.ptp(values[mine])) for way, mine in read.items()}
        if len(read) < len(ways):
            warnings.append(f"Of {name} only one way was read: what changes with the side is not in its figures.")
    return Kinematic(figures, tuple(warnings))
