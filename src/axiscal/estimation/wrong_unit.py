"""Test whether the readings of a file can be of this machine at all, and in the unit that it names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.case import Case
from axiscal.estimation.inference.implausible import bent, unit_guess
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.judged import judged
from axiscal.estimation.promise.other_unit import other_unit
from axiscal.estimation.timed import timed
from axiscal.exceptions import ReadingError
from axiscal.language.spoken import put, said
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.reading import Reading

_FEWEST = 3
"""One or two slips are readings to be looked at; a file in another unit has all."""


def refuse_implausible(readings: Sequence[Reading], campaign: CampaignDescription, file: str | Path) -> None:
    """Raise ReadingError at the first implausible reading where most of them are: the file has another unit.

    Also where all readings of a set-up fit only when multiplied, by odds of a million, even if scales are learnt.
    """
    case = case_of(campaign)
    doubts = judged(case, timed(case, readings).readings).values()
    if len(doubts) < _FEWEST or 2 * len(doubts) <= len(readings):
        _refuse_other_unit(case, readings, file)
        return
    first = readings[min(doubt.reading for doubt in doubts)]
    size = float(np.median([doubt.surprise for doubt in doubts]))
    guess = unit_guess(size, INSTRUMENTS[campaign.setup(first.setup).instrument].reads == "angle")
    what = (
        "{count} of {readings} readings are some {size:.0f} standard deviations from all that the "
        "stated std of the errors allow"
    )
    at = {"count": len(doubts), "readings": len(readings), "size": size}
    what = put("{fault}, {guess}", fault=said(what, **at), guess=guess) if guess else said(what, **at)
    remedy = "Check the unit that the file names for its values, or state larger std in the machine"
    raise ReadingError(what, remedy, file, first.line)


def _refuse_other_unit(case: Case, readings: Sequence[Reading], file: str | Path) -> None:
    """Raise ReadingError at the first reading of a set-up whose readings are written in another unit."""
    found = other_unit(case.observation, readings) if case.inherited is None else None
    bends = None if found is None else other_unit(_with_bends(case, readings).observation, readings)
    if found is None or bends is None or bends.factor != found.factor:
        return
    first = next(reading for reading in readings if reading.setup == found.setup)
    by = f"{found.factor:g}" if found.factor > 1 else f"1/{1 / found.factor:g}"
    what = (
        'the readings of "{setup}" fit the stated errors and noise when they are multiplied by {by}, by odds of '
        "10^{odds:.0f} to 1, and not as they are"
    )
    remedy = "Check the unit that the file names for its values (mm instead of um?), or state other std and noise"
    raise ReadingError(what, remedy, file, first.line, setup=found.setup, by=by, odds=found.odds)


def _with_bends(case: Case, readings: Sequence[Reading]) -> Case:
    """Return the case with what readings bend by as noise: a station that is far off is no other unit.

    With so much noise a station that is not off looks like another unit, so that what is told without it has to agree.
    """
    machine, setups = case.description.machine, []
    for setup in case.description.setups:
        most = max((bent(machine, setup, reading) for reading in readings if reading.setup == setup.name), default=0.0)
        setups.append(replace(setup, noise=float(np.hypot(setup.noise, np.sqrt(most)))))
    return replace(case, description=replace(case.description, setups=tuple(setups)))
