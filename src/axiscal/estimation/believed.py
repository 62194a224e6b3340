"""The readings of an estimation that are believed, and those of them that can speak of a drift."""

from __future__ import annotations

from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.reading import Reading


def trusted(estimation: Estimation) -> list[Reading]:
    """Return the readings that are believed."""
    doubted = {doubt.reading for doubt in estimation.outliers}
    return [reading for index, reading in enumerate(estimation.readings) if index not in doubted]


def with_sides(estimation: Estimation) -> list[Reading]:
    """Return those of them of which it is told from which side an axis with a reversal came: a reversal is no drift."""
    return [reading for reading in trusted(estimation) if _side_known(reading, estimation.stated)]


def plausible_with_sides(estimation: Estimation) -> list[Reading]:
    """Return the same with those that others contradict: a step contradicts a reading as a slip does."""
    impossible = {doubt.reading for doubt in estimation.outliers if doubt.implausible}
    kept = [reading for index, reading in enumerate(estimation.readings) if index not in impossible]
    return [reading for reading in kept if _side_known(reading, estimation.stated)]


def _side_known(reading: Reading, case: Case) -> bool:
    """Whether what a reading repeats is not another side of a reversal; of those that a probe evens out none counts."""
    setup, axes = case.description.setup(reading.setup), case.errors.machine.axes
    sided = [k for k in setup.moves if k in case.errors.reversing and (axes[k].rotary or not setup.mean_sides)]
    return all(reading.approach[axis] != 0 for axis in sided)
