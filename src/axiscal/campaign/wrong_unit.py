"""Test whether the readings of a file can be of this machine at all, and in the unit that it names.

Readings may fit better if they were written in another unit. The evidence is that for y, 1000 y and y/1000:

    p(y | f) = f^m p(f y),    averaged over sizes that nobody knows better than roughly

so that a machine that is three times as good, or an instrument five times as noisy, as stated is no other unit. Inches
are not looked for: a machine or a bed 25 times as good as stated exists, and fits no worse.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.case import Case, timed
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.judged import bent, judged, unit_guess
from axiscal.estimation.promise.problem import problem
from axiscal.exceptions import ReadingError
from axiscal.language.spoken import put, said
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading, drawn
from axiscal.numerics import Array
from axiscal_core.draws import as_stated, sized
from axiscal_core.problem import Problem
from axiscal_core.unknowns import space_of
from axiscal_core.usual import sizes_of

_FEWEST = 3
"""One or two slips are readings to be looked at; a file in another unit has all."""


def refuse_implausible(readings: Sequence[Reading], campaign: CampaignDescription, file: str | Path) -> None:
    """Raise ReadingError at the first implausible reading where most of them are: the file has another unit.

    Also where all readings of a set-up fit only when multiplied, by odds of a million, even if scales are learnt.
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


FACTORS = (1000.0, 1 / 1000.0)
"""By definition: mm for um, and back."""
_CERTAIN = 6.0
_FEWEST_TOLD, _MOST = 4, 60
"""Readings below which no unit can be told, and above which more only take time."""
_LEAST_FIT = 0.05
"""Share of what is expected: readings tell of no unit that scatter by less, multiplied, about a set-up's unknowns."""
_FARTHEST = float(np.log(1000.0)) / 2
"""Logarithm of what errors or noise may be beside what is stated, multiplied: what is nearer to it as written stays."""


class OtherUnit(NamedTuple):
    """Readings of a set-up that fit when multiplied by a factor; odds : powers of ten."""

    setup: str
    factor: float
    odds: float


def other_unit(observation: Observation, readings: Sequence[Reading]) -> OtherUnit | None:
    """Return the set-up whose readings are written in another unit by odds of a million; None for none."""
    for setup in observation.setups:
        mine = drawn([reading for reading in readings if reading.setup == setup.name], _MOST)
        if len(mine) < _FEWEST_TOLD or any(reading.std is not None for reading in mine):
            continue
        sizes = sizes_of(observation.machine, [setup.name for setup in observation.setups], "roughly", usual=True)
        posed = problem(observation, mine, sizes)
        multiplied = {factor: _multiplied(posed, factor) for factor in FACTORS}
        best = max(multiplied, key=lambda factor: multiplied[factor])
        if not np.isfinite(multiplied[best]):  # the usual case, in which the evidence as written need not be found
            continue
        odds = (multiplied[best] - sized(space_of(posed)).log_evidence) / np.log(10.0)
        if odds > _CERTAIN:
            return OtherUnit(setup.name, best, float(odds))
    return None


def _multiplied(posed: Problem, factor: float) -> float:
    """Return log p of the readings if f times their values are right.

    Minus infinity if these would be nothing, or so far beyond what is stated that they are nearer to it as written.
    """
    other = replace(posed, values=factor * posed.values)
    if _scatter(replace(posed, values=factor * _told(posed))) < _LEAST_FIT or _scatter(other) > np.exp(2 * _FARTHEST):
        return -np.inf
    found = sized(space_of(other))
    told = [index for index, size in enumerate(posed.sizes.of) if size.kind in ("std", "reversal", "noise")]
    if np.max(np.abs(found.weights @ found.thetas)[told]) > _FARTHEST:
        return -np.inf
    return found.log_evidence + len(posed.values) * float(np.log(factor))


def _scatter(posed: Problem) -> float:
    """Return the mean square of the readings over what is expected of them."""
    return as_stated(space_of(posed)).misfit / len(posed.values)


def _told(posed: Problem) -> Array:
    """Return the values, (m,), less what a set-up's own unknowns take up: a zero does so whatever the unit is."""
    own = posed.rows[:, posed.rows.shape[1] - posed.unknowns :]
    taken: Array = own @ np.linalg.lstsq(own, posed.values)[0]
    return posed.values - taken
