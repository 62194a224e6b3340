"""Constants as dots with whiskers: places on a common scale per unit, in per cent of the picture's width."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from axiscal.accuracy.expanded import BAND
from axiscal.report.digits import number
from axiscal.report.sentences import constant_note, short, unit_text
from axiscal.report.summary import ConstantSummary


@dataclass(frozen=True, slots=True)
class Whisker:
    """One constant; positions are per cent of the width, cut at the edges."""

    constant: ConstantSummary
    note: str
    prior: tuple[float, float]
    now: tuple[float, float]
    dot: float
    truth: float | None


@dataclass(frozen=True, slots=True)
class UnitScale:
    """The constants of one unit, and the ticks of their scale as (place, text)."""

    unit: str
    ticks: Sequence[tuple[float, str]]
    whiskers: Sequence[Whisker]


_LARGEST_RATIO = 6.0
"""Constants that differ by more than this in extent get scales of their own, or the small ones would be dots."""


def scales(constants: Sequence[ConstantSummary]) -> list[UnitScale]:
    """Return the constants grouped by unit and magnitude, each group on one symmetric scale."""
    units = dict.fromkeys(constant.unit for constant in constants)
    return [
        _scale(unit, alike)
        for unit in units
        for alike in _magnitudes([constant for constant in constants if constant.unit == unit])
    ]


def _magnitudes(constants: list[ConstantSummary]) -> list[list[ConstantSummary]]:
    """Return the constants in groups of like extent, in the order in which each group first appears."""
    tops: list[float] = []
    for reach in sorted((_reach(constant) for constant in constants), reverse=True):
        if not tops or reach * _LARGEST_RATIO < tops[-1]:
            tops.append(reach)
    found: dict[float, list[ConstantSummary]] = {}
    for constant in constants:
        found.setdefault(min(top for top in tops if top >= _reach(constant)), []).append(constant)
    return list(found.values())


def _scale(unit: str, constants: list[ConstantSummary]) -> UnitScale:
    reach = max(_reach(constant) for constant in constants) or 1.0
    step = _round_step(reach / 2.5)
    ticks = [(_place(step * i, reach), short(step * i)) for i in (-2, 0, 2)]  # more would not fit a narrow screen
    return UnitScale(unit_text(unit), ticks, [_whisker(constant, reach) for constant in constants])


def _reach(constant: ConstantSummary) -> float:
    known = [abs(constant.mean) + BAND * constant.std, 0.0 if constant.truth is None else abs(constant.truth)]
    prior = BAND * constant.prior_std
    return number(1.05 * max(*known, prior), f"extent of {constant.name}")


def _whisker(constant: ConstantSummary, reach: float) -> Whisker:
    half, prior = BAND * constant.std, BAND * constant.prior_std
    return Whisker(
        constant,
        constant_note(constant),
        (_place(-prior, reach), _place(prior, reach)),
        (_place(constant.mean - half, reach), _place(constant.mean + half, reach)),
        _place(constant.mean, reach),
        None if constant.truth is None else _place(constant.truth, reach),
    )


def _place(value: float, reach: float) -> float:
    return round(50 + 50 * max(-1.0, min(1.0, value / reach)), 3)


def _round_step(size: float) -> float:
    power = 10.0 ** int(f"{size:e}".split("e")[1])
    return max((m * power for m in (1, 2, 5) if m * power <= size * 1.0001), default=power)
