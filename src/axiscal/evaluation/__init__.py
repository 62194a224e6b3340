"""The figures of the standards, from readings alone: positioning and circles."""

from axiscal.evaluation.circle import CircleFigures, circular, figures_of
from axiscal.evaluation.one_axis import (
    FIGURES,
    Positioning,
    PositioningTest,
    TargetFigures,
    evaluate,
    read_iso230,
)

__all__ = [
    "FIGURES",
    "CircleFigures",
    "Positioning",
    "PositioningTest",
    "TargetFigures",
    "circular",
    "evaluate",
    "figures_of",
    "read_iso230",
]
