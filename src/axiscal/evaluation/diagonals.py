"""Diagonal tests by ISO 230-6: a laser along face or body diagonals of the volume, each tested as an axis is.

    E   of each diagonal: bidirectional systematic deviation of positioning;  E_d = max over the diagonals
    B   of each diagonal: reversal;                                           B_d = max over the diagonals

each by the formulas of ISO 230-2 along the diagonal. (After ISO 230-6:2002, quoted from memory.)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from axiscal.evaluation.one_axis import Positioning, PositioningTest, evaluate
from axiscal.units import to_unit

_FACES, _BODY = 2, 4
"""Diagonals of a face, and of the body."""


@dataclass(frozen=True, slots=True)
class Diagonals:
    """each : the figures of each diagonal by name; figures : E_d and B_d, m, where both directions were measured"""

    each: Mapping[str, Positioning]
    figures: Mapping[str, float]
    warnings: tuple[str, ...] = ()

    def as_json(self) -> dict[str, object]:
        """Return the document `axiscal-iso230-6/1`, figures in um, those of each diagonal by ISO 230-2."""
        figures = {name: to_unit(value, "um") for name, value in self.figures.items()}
        each = {name: found.as_json() for name, found in self.each.items()}
        return {
            "schema": "axiscal-iso230-6/1",
            "unit": "um",
            **figures,
            "diagonals": each,
            "warnings": list(self.warnings),
        }


def diagonals(tests: Mapping[str, PositioningTest]) -> Diagonals:
    """Return the figures of diagonals by name; raises EvaluationError."""
    each = {name: evaluate(test) for name, test in tests.items()}
    both = [found for found in each.values() if found.E is not None and found.B is not None]
    figures = {}
    if len(both) == len(each):
        figures = {"E_d": max(found.E or 0.0 for found in both), "B_d": max(found.B or 0.0 for found in both)}
    few = len(each) not in (_FACES, _BODY)
    asked = f"ISO 230-6 asks for the two diagonals of a face or the four of the body; there are {len(each)}."
    return Diagonals(each, figures, (asked,) if few else ())
