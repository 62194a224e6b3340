"""The figures of the standards, from readings alone: positioning, circles, diagonals, rotating axes."""

from axiscal.evaluation.circles import Circular, circular
from axiscal.evaluation.diagonals import Diagonals, diagonals
from axiscal.evaluation.kinematic import Kinematic, kinematic
from axiscal.evaluation.one_axis import (
    FIGURES,
    Positioning,
    PositioningTest,
    TargetFigures,
    evaluate,
    read_iso230,
)
from axiscal.evaluation.spindles import ErrorMotion, error_motion
from axiscal.evaluation.which_test import Figures, figures_of

__all__ = [
    "FIGURES",
    "Circular",
    "Diagonals",
    "ErrorMotion",
    "Figures",
    "Kinematic",
    "Positioning",
    "PositioningTest",
    "TargetFigures",
    "circular",
    "diagonals",
    "error_motion",
    "evaluate",
    "figures_of",
    "kinematic",
    "read_iso230",
]
