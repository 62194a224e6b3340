"""One error of two axes as plain data in display units, beside the rest of a summary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from axiscal.report.digits import number, numbers


@dataclass(frozen=True, slots=True)
class PlaneSummary:
    """One error of two axes over both; maps have a row for each position of the first axis.

    mean, std, prior_std : of what the axes do together alone, rest included; sign : +1 or -1, how the tool shows it
    whole_mean, whole_std : with the curves that each axis has alone in the same direction, signs as the tool moves,
        and their mean over the plane taken off
    """

    name: str
    axes: tuple[str, str]
    caption: str
    position: tuple[Sequence[float], Sequence[float]]
    position_unit: tuple[str, str]
    value_unit: str
    mean: Sequence[Sequence[float]]
    std: Sequence[Sequence[float]]
    prior_std: Sequence[Sequence[float]]
    whole_mean: Sequence[Sequence[float]]
    whole_std: Sequence[Sequence[float]]
    from_readings: float = 0.0
    sign: float = 1.0


def plane_json(plane: PlaneSummary) -> dict[str, Any]:
    """Return the entry of `plane_errors`."""
    first, second = (numbers(at, f"position of {plane.name}") for at in plane.position)
    return {
        "axes": list(plane.axes),
        "position": [first, second],
        "mean": [numbers(row, f"mean of {plane.name}", len(second)) for row in plane.mean],
        "std": [numbers(row, f"std of {plane.name}", len(second)) for row in plane.std],
        "position_unit": list(plane.position_unit),
        "value_unit": plane.value_unit,
        "prior_std": [numbers(row, f"prior_std of {plane.name}", len(second)) for row in plane.prior_std],
        "whole_mean": [numbers(row, f"whole_mean of {plane.name}", len(second)) for row in plane.whole_mean],
        "whole_std": [numbers(row, f"whole_std of {plane.name}", len(second)) for row in plane.whole_std],
        "from_readings": number(plane.from_readings, f"from_readings of {plane.name}"),
    }
