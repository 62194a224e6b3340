"""The figures of the standards, from readings alone: positioning, circles, diagonals, rotating axes."""

from axiscal.evaluation.one_axis import (
    FIGURES,
    Positioning,
    PositioningTest,
    TargetFigures,
    evaluate,
    read_iso230,
)
from axiscal.evaluation.other_tests import StandardFigures, circular, diagonals, error_motion, figures_of, kinematic

__all__ = [
    "FIGURES",
    "Positioning",
    "PositioningTest",
    "StandardFigures",
    "TargetFigures",
    "circular",
    "diagonals",
    "error_motion",
    "evaluate",
    "figures_of",
    "kinematic",
    "read_iso230",
]
