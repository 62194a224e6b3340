"""A finished ISO 230-2 test as a block of the report."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.evaluation import FIGURES, Positioning, TargetFigures
from axiscal.report.summary import Iso230
from axiscal.units import to_unit


def iso230_block(axis: str, found: Positioning) -> Iso230:
    """Return the block of one axis; a direction that was not measured is empty."""
    unit, position_unit = ("arcsec", "deg") if found.rotary else ("um", "mm")
    figures = {name: getattr(found, name) for name in FIGURES}
    return Iso230(
        axis=axis,
        position_unit=position_unit,
        value_unit=unit,
        target=[to_unit(row.target, position_unit) for row in found.per_target],
        mean_up=_column(found.per_target, "mean_up", unit),
        std_up=_column(found.per_target, "s_up", unit),
        mean_down=_column(found.per_target, "mean_down", unit),
        std_down=_column(found.per_target, "s_down", unit),
        figures={name: to_unit(value, unit) for name, value in figures.items() if value is not None},
        uncertainties={name: to_unit(value, unit) for name, value in found.uncertainty.items()},
    )


def _column(rows: Sequence[TargetFigures], name: str, unit: str) -> list[float]:
    values = [getattr(row, name) for row in rows]
    return [to_unit(value, unit) for value in values if value is not None]
