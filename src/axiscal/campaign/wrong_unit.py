"""Test whether the readings of a file can be of this machine at all, and in the unit that it names.

Most are beyond all that is stated, or all together far below it. Sizes that are learnt name another unit besides
(`estimation.promise.slip`); this holds where none is, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.case import Case, timed
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.judged import judged, unit_guess
from axiscal.estimation.promise.problem import problem
from axiscal.exceptions import ReadingError
from axiscal.language.spoken import put, said
from axiscal.measurement.reading import Reading, drawn
from axiscal_core.draws import as_stated
from axiscal_core.unknowns import space_of

_FEWEST = 3
"""One or two slips are readings to be looked at; a file in another unit has all."""
_FEWEST_TOLD, _MOST = 4, 60
"""Readings below which no unit can be told, and above which more only take time."""
_NEXT_TO_NOTHING = 0.01
"""Of what is stated: mm for um is a thousandth, and no instrument is a hundred times better than stated."""


def refuse_implausible(readings: Sequence[Reading], campaign: CampaignDescription, file: str | Path) -> None:
    """Raise ReadingError at the first implausible reading where most of them are: the file has another unit.

    Also where all readings of a set-up are far below what is stated.
    """
    case = case_of(campaign)
    doubts = judged(case, timed(case, readings).readings).values()
    if len(doubts) < _FEWEST or 2 * len(doubts) <= len(readings):
        slips = {doubt.reading for doubt in doubts}  # a lost decimal point is no other unit of all
        _refuse_other_unit(case, [each for i, each in enumerate(readings) if i not in slips], file)
        return
    first = readings[min(doubt.reading for doubt in doubts)]
    size = float(np.median([doubt.surprise for doubt in doubts]))
    guess = unit_guess(size, campaign.setup(first.setup).reads == "angle")
    what = (
        "{count} of {readings} readings are some {size:.0f} standard deviations from all that the "
        "stated std of the errors allow"
    )
    at = {"count": len(doubts), "readings": len(readings), "size": size}
    what = put("{fault}, {guess}", fault=said(what, **at), guess=guess) if guess else said(what, **at)
    remedy = "Check the unit that the file names for its values, or state larger std in the machine"
    values = [reading.value for reading in readings if reading.setup == first.setup]
    if 5 * np.ptp(values) < abs(np.median(values)):
        remedy = "Check the unit that the file names. If all are off by one amount, state a zero as wide in unknowns"
    raise ReadingError(what, remedy, file, first.line)


def _refuse_other_unit(case: Case, readings: Sequence[Reading], file: str | Path) -> None:
    """Raise ReadingError at the first reading of a set-up whose readings, not all alike, differ by next to nothing."""
    for setup in case.observation.setups if case.inherited is None else ():
        mine = drawn([each for each in readings if each.setup == setup.name], _MOST)
        if len(mine) < _FEWEST_TOLD or len({each.values for each in mine}) == 1:
            continue
        posed = problem(case.observation, mine, case.sizes)
        if as_stated(space_of(posed)).misfit < _NEXT_TO_NOTHING**2 * len(posed.values):
            what = 'the readings of "{setup}" differ by less than a hundredth of the stated errors and noise'
            remedy = (
                "Check the unit that the file names for its values (mm instead of um?), or state other std and noise"
            )
            raise ReadingError(what, remedy, file, mine[0].line, setup=setup.name)
