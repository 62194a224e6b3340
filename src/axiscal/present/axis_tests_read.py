"""ISO 230-2 as blocks of the report: readings of a campaign that are a test."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.functionals.functional import seen_by, stand_of
from axiscal.evaluation.standards import Positioning, PositioningTest, evaluate
from axiscal.machine.axis import letter_direction
from axiscal.machine.kinematics import in_frame
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.present.result import Iso230Figures
from axiscal.units import to_unit

_FEWEST_TARGETS, _FEWEST_RUNS = 5, 2
"""ISO 230-2 asks for five targets at least; a standard deviation needs two runs."""
_SAME = 1e-6
"""m or rad: targets nearer to each other are one."""


def iso230_blocks(
    description: CampaignDescription, readings: Sequence[Reading], doubted: Collection[int] = ()
) -> list[Iso230Figures]:
    """Return the figures of each axis whose readings in one set-up are a test after ISO 230-2.

    doubted : readings, counted from 0, that were not believed: their runs are left out
    """
    blocks = []
    for setup in description.setups:
        mine = [(number, reading) for number, reading in enumerate(readings) if reading.setup == setup.name]
        wrong = [reading.numbered(number) for number, reading in mine if number in doubted]
        kept = [replace(reading, value=np.nan) if number in doubted else reading for number, reading in mine]
        test = _test(description, setup, kept)
        if test is not None:
            axis = description.machine.axes[setup.moves[0]]
            blocks.append(_block(axis.name, evaluate(test, setup.noise), wrong))
    return blocks


def _test(description: CampaignDescription, setup: Setup, readings: Sequence[Reading]) -> PositioningTest | None:
    """Return a set-up's readings as a test; None where they are none: each target as often from each side.

    Deviations are those along, or about, the way in which the axis counts, wherever the instrument looks.
    A reading of nan takes its run out, the n-th reading of every target from its side.
    """
    stands = stand_of(setup, readings)
    if (seen := seen_by(setup, description.machine, stands)) is None:
        return None
    axis, own = setup.moves[0], description.machine.axes[setup.moves[0]]
    if seen != ("angle" if own.rotary else "length", letter_direction(own.letter)):
        return None
    way = np.array(own.direction) @ in_frame(description.machine, axis, stands)
    along = 1.0 if way @ np.array(setup.direction) > 0 else -1.0
    found: dict[tuple[int, int], list[float]] = {}
    for reading in readings:
        target = round(reading.pose[axis] / _SAME)
        found.setdefault((target, reading.approach[axis]), []).append(along * reading.value)
    targets = sorted({target for target, _ in found})
    sides = [_runs(found, targets, side) for side in (1, -1)]
    if len(targets) < _FEWEST_TARGETS or any(side == 0 for _, side in found) or all(side is None for side in sides):
        return None
    if any(side is None and any(way == sign for _, way in found) for side, sign in zip(sides, (1, -1), strict=True)):
        return None
    positions = np.array(targets) * _SAME
    return PositioningTest(positions, sides[0], sides[1], own.rotary)


def _runs(found: dict[tuple[int, int], list[float]], targets: Sequence[int], side: int) -> Array | None:
    """Return the readings of one direction, (targets, runs); None where not every target was read as often."""
    rows = [found.get((target, side), []) for target in targets]
    if len({len(row) for row in rows}) > 1:
        return None
    whole = np.array(rows)[:, ~np.any(np.isnan(rows), axis=0)]
    return whole if whole.shape[1] >= _FEWEST_RUNS else None


def _block(axis: str, found: Positioning, left_out: Sequence[int]) -> Iso230Figures:
    """Return the figures of one axis.  left_out : readings that were not believed; the test is without their runs"""
    figures, sizes = (
        {name: to_unit(x, found.unit) for name, x in each.items()} for each in (found.figures, found.uncertainty)
    )
    return Iso230Figures(axis=axis, unit=found.unit, figures=figures, U=sizes, left_out=[*left_out])
