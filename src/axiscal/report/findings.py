"""What a person has to be told about an estimate: what could not be seen, and what does not fit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.campaign.calibration import Calibration, Problem
from axiscal.measurement.reading import Reading
from axiscal.report.summary import Finding, ResidualCheck
from axiscal.units import to_unit

_OUTLIER = 4.0
_MISFIT = 1e-3
_MATTERS = 0.1


def observability(problem: Problem) -> list[str]:
    """Return what no allowed reading can see, in sentences."""
    return [part.text for part in problem.hidden]


def residual_check(calibration: Calibration) -> ResidualCheck | None:
    """Return the chi-square of all innovations; None before the first reading."""
    from scipy.special import chdtrc

    if not calibration.innovations:
        return None
    total = sum(each.chi_square for each in calibration.innovations)
    count = sum(each.degrees for each in calibration.innovations)
    return ResidualCheck(total, count, float(chdtrc(count, total)))


def findings(calibration: Calibration, readings: Sequence[Reading]) -> list[Finding]:
    """Return the warnings of an estimate."""
    return [*_unobservable(calibration), *_outliers(calibration, readings), *_misfit(calibration)]


def _unobservable(calibration: Calibration) -> list[Finding]:
    yardstick = calibration.problem.yardstick
    if yardstick.unseen_rms <= _MATTERS * calibration.accuracy().rms:
        return []
    text = (
        f"No allowed reading can bring the RMS below {to_unit(yardstick.unseen_rms, 'um'):.3g} um: "
        "see what could not be seen."
    )
    return [Finding("unobservable", None, text)]


def _outliers(calibration: Calibration, readings: Sequence[Reading]) -> list[Finding]:
    result = []
    for number, (reading, innovation) in enumerate(zip(readings, calibration.innovations, strict=True), start=1):
        surprise = float(np.max(np.abs(innovation.value / innovation.std)))
        if surprise > _OUTLIER:
            text = (
                f'Reading {number} in "{reading.setup}" is {surprise:.1f} standard deviations from what the readings '
                "before it predict; take it again."
            )
            result.append(Finding("outlier", None, text))
    return result


def _misfit(calibration: Calibration) -> list[Finding]:
    check = residual_check(calibration)
    if check is None or min(check.probability, 1 - check.probability) > _MISFIT:
        return []
    size = np.sqrt(check.chi_square / check.degrees)
    text = (
        f"The readings scatter {size:.2g} times as much about their predictions as the priors and the noise say: "
        "the bands are not to be trusted; review the std of the errors and the noise of the set-ups."
    )
    return [Finding("prior-misfit", None, text)]
