"""What the readings of an estimation can vouch for: found once, the same wherever it is said."""

from __future__ import annotations

from axiscal.estimation.believed import sides_told
from axiscal.estimation.defence import Defence, defence
from axiscal.estimation.estimation import Estimation
from axiscal.inference.contradiction import FEWEST
from axiscal.measurement.reading import Reading
from axiscal.numerics.remembered import remembered


def defended(estimation: Estimation) -> Defence:
    """Return what the readings of an estimation that are believed vouch for, once there is a verdict its own."""
    if estimation.ruling is not None:
        return estimation.ruling.defence
    return defended_by(estimation, len(estimation.readings), estimation.accuracy.rms)


@remembered
def defended_by(estimation: Estimation, count: int, promise: float) -> Defence:
    """Return what the first readings vouch for, those of them that are believed today.

    count : of the first readings; promise : RMS over the volume that they left, m
    """
    stated = estimation.stated.description.machine
    believed = _believed(estimation, count)
    told = sides_told(believed, estimation.stated)
    return defence(estimation.case, told if len(told) >= FEWEST else believed, promise, stated)


def _believed(estimation: Estimation, count: int) -> list[Reading]:
    apart = {doubt.reading for doubt in estimation.outliers if doubt.rejected}
    return [reading for index, reading in enumerate(estimation.readings[:count]) if index not in apart]
