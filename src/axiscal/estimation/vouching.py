"""What the readings of an estimation can vouch for: found once, the same wherever it is said."""

from __future__ import annotations

from axiscal.estimation.believed import sides_told
from axiscal.estimation.defence import Defence, defence
from axiscal.estimation.estimation import Estimation
from axiscal.inference.contradiction import FEWEST
from axiscal.numerics.remembered import remembered


def defended(estimation: Estimation) -> Defence:
    """Return what the readings of an estimation that are believed vouch for, once there is a verdict its own."""
    if estimation.ruling is not None:
        return estimation.ruling.defence
    return _found(estimation)


@remembered
def _found(estimation: Estimation) -> Defence:
    stated = estimation.stated.description.machine
    apart = {doubt.reading for doubt in estimation.outliers if doubt.rejected}
    believed = [reading for index, reading in enumerate(estimation.readings) if index not in apart]
    told = sides_told(believed, estimation.stated)
    return defence(estimation.case, told if len(told) >= FEWEST else believed, estimation.accuracy.rms, stated)
