"""What can be kept of every case of a study: names, units and words."""

from __future__ import annotations

from typing import NamedTuple


class KeptFigure(NamedTuple):
    """column : of the table of results; words : what it is; unit : as printed"""

    column: str
    words: str
    unit: str = ""


FIGURES = {
    "readings": KeptFigure("readings", "readings"),
    "minutes": KeptFigure("minutes", "minutes of machine time", "min"),
    "rms": KeptFigure("rms_um", "RMS promised", "µm"),
    "worst": KeptFigure("worst_um", "worst place promised", "µm"),
    "U": KeptFigure("U_um", "U, expanded uncertainty in space", "µm"),
    "true_rms": KeptFigure("true_rms_um", "RMS that is true", "µm"),
    "true_worst": KeptFigure("true_worst_um", "worst place that is true", "µm"),
    "within_U": KeptFigure("within_U", "share of the volume within U"),
    "coverage_curves": KeptFigure("coverage_curves", "share of the curves in their bands"),
    "coverage_tcp": KeptFigure("coverage_tcp", "share of the tool point in its band"),
    "agreement": KeptFigure("agreement", "whether the readings agree"),
    "said": KeptFigure("said", "warnings"),
    "reached": KeptFigure("reached", "target reached"),
}
"""By the name that a study file has for it."""
