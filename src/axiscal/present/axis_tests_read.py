"""ISO 230-2 as blocks of the report: readings of a campaign that are a test."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.functionals.functional import seen_by, stand_of
from axiscal.evaluation.standards import PositioningTest, evaluate
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
        kept = [replace(reading, value=np.nan) if number in doubted else reading for number, reading in mine]
        if (test := _test(description, setup, kept)) is not None:
            found, axis = evaluate(test, setup.noise), description.machine.axes[setup.moves[0]].name
            figures, sizes = (
                {name: to_unit(x, found.unit) for name, x in each.items()}
                for each in (found.figures, found.uncertainty)
            )
            wrong = [reading.numbered(number) for number, reading in mine if number in doubted]
            blocks.append(Iso230Figures(axis=axis, unit=found.unit, figures=figures, U=sizes, left_out=wrong))
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
    found, runs = dict[int, dict[int, list[float]]](), dict[int, Array]()
    for reading in readings:
        target = round(reading.pose[axis] / _SAME)
        found.setdefault(reading.approach[axis], {}).setdefault(target, []).append(along * reading.value)
    targets = sorted(set[int]().union(*found.values()))
    for side, values in found.items():
        rows = [values.get(target, []) for target in targets]
        if side == 0 or len({len(row) for row in rows}) > 1:
            return None
        runs[side] = np.array(rows)[:, ~np.any(np.isnan(rows), axis=0)]
    if len(targets) < _FEWEST_TARGETS or any(whole.shape[1] < _FEWEST_RUNS for whole in runs.values()):
        return None
    return PositioningTest(np.array(targets) * _SAME, runs.get(1), runs.get(-1), own.rotary)
