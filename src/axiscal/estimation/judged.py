"""Second stage: the implausible readings, which no error of about the stated size could make: mostly slips of the unit.

The test uses the set-up's own unknowns after the readings before, and the stated std of the errors at the place. It
treats these errors as independent from place to place. So a curve that is rougher than its prior, or several times
larger, makes no reading implausible. Errors count as scatter there, and only the unknowns are learnt.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from axiscal.estimation.case import Case
from axiscal.language.spoken import later, listed, said
from axiscal.measurement.instruments.distance import SHIFTS, TURNS
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading, reading_text, units_of
from axiscal.measurement.reading_rows import seen
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.units import said_quantity
from axiscal_core.axes import Axis
from axiscal_core.causes import wandered
from axiscal_core.machine import Machine

_LEARNABLE = 4.0
"""How many times larger than stated an error may be where its std is to be learnt."""


def judged(case: Case, readings: Sequence[Reading]) -> Mapping[int, Doubt]:
    """Return the implausible readings by index from 0; those nearest to their middle are judged first."""
    order, mean = nearest_first(readings), np.zeros(case.errors.size)
    mean = mean if case.inherited is None else case.inherited.mean
    slack = _LEARNABLE if case.description.sure == "roughly" else 1.0
    taken, covariance = [readings[index] for index in order], case.errors.covariance()
    sizes = surprises(case.observation, mean, slack**2 * covariance, taken)
    far = np.array(sizes) > limit(sizes)
    if slack > 1 and np.any(far):  # what is printed, and which unit it tells, is by what is stated
        sizes = surprises(case.observation, mean, covariance, taken)
    found = {index: sizes[at] for at, index in enumerate(order) if far[at]}
    return {i: Doubt(i, size, True) for i, size in sorted(found.items()) if not readings[i].accepted}


IMPLAUSIBLE = 12.0
"""So many standard deviations are no chance, and no prior that is three times too small."""
_WIDEST, _ENOUGH, _COUNTLESS = 4.0, 5, 1e6
_NEAREST = 0.05
"""No station stands nearer, m: by how much distances may bend before it is located."""
_SLIPS = (
    (75.0, later("about 25 times too large (inches instead of mm?)")),
    (4000.0, later("about a thousand times too large (mm instead of um?)")),
    (1e5, later("about 25000 times too large (inches instead of um?)")),
)


def unit_guess(size: float, angular: bool = False) -> str:
    """Return which slip of the unit makes a reading so many standard deviations too large; empty for none."""
    if angular:
        return said("about a thousand times too large (mrad instead of urad?)") if 75.0 < size <= 4000.0 else ""
    return next((said(words) for most, words in _SLIPS if size <= most), "")


def objection(doubt: Doubt, reading: Reading, setup: Setup, axes: Sequence[Axis]) -> str:
    """Return what is wrong with a reading that is not used, and which slip of the unit may have made it."""
    named = reading_text(axes, setup, reading, doubt.reading)
    if not doubt.implausible:
        away = "{reading} is {away:.1f} standard deviations from what the other readings say"
        return said(away, reading=named, away=float(doubt.surprise))
    pairs = zip(reading.values, units_of(setup), strict=True)
    value = listed(", ", [said_quantity(each, unit, 6) for each, unit in pairs])
    size = f"{doubt.surprise:.0f}" if doubt.surprise < _COUNTLESS else said("more than a million")
    guess = unit_guess(doubt.surprise, setup.reads == "angle")
    text = said(
        "{reading}, {value}, is {size} standard deviations from all that the stated std and the other readings allow",
        reading=named,
        value=value,
        size=size,
    )
    return listed(", ", [text, guess]) if guess else text


def surprises(observation: Observation, mean: Array, covariance: Array, readings: Sequence[Reading]) -> list[float]:
    """Return how far each reading is from what those before it allow, in standard deviations.

    mean : (size,) and covariance : (size, size) of the errors as expected
    Their rows meet the covariance of the errors once for all of them: as fast as it can be read.
    """
    numbers, values = seen(observation, readings)
    rows, own = np.split(numbers.rows, [len(mean)], axis=1)
    scatter = observation.variances(numbers) + np.einsum("mi,mi->m", rows @ covariance, rows)
    stds = [unknown.std for unknown in observation.unknowns]
    known, spread = np.zeros(len(stds)), np.diag(np.square(stds))
    values = values - rows @ mean
    setups, first, sizes = {setup.name: setup for setup in observation.setups}, dict[str, float](), list[float]()
    ends = np.searchsorted(numbers.place, np.arange(len(readings) + 1)).tolist()
    for reading, mine in zip(readings, (slice(*each) for each in pairwise(ends)), strict=True):
        setup = setups[reading.setup]
        # its zero may have wandered since the first one that was judged
        after = 0.0 if reading.time is None else reading.time - first.get(reading.setup, reading.time)
        variances = scatter[mine] + bent(observation.machine, setup, reading) + wandered(setup.drift, after)
        shown = spread @ own[mine].T
        surprise, wide = values[mine] - own[mine] @ known, own[mine] @ shown + np.diag(variances)
        sizes.append(float(np.max(np.abs(surprise) / np.sqrt(np.diagonal(wide)))))
        if reading.accepted or sizes[-1] <= IMPLAUSIBLE * _WIDEST:
            gain = np.linalg.solve(wide, shown.T).T
            known, spread = known + gain @ surprise, spread - gain @ shown.T
        if reading.time is not None:
            first.setdefault(reading.setup, reading.time)
    return sizes


def bent(machine: Machine, setup: Setup, reading: Reading) -> float:
    """Return the variance by which a reading of a set-up bends while its station or its turn is not found, m²."""
    stations = max(len(setup.stations), 1)
    wide = sum(u.std**2 for u in setup.unknowns if u.name.startswith(SHIFTS)) / stations
    turned = sum(u.std**2 for u in setup.unknowns if u.name in TURNS)
    if not turned:
        return float((wide / (2 * _NEAREST)) ** 2)
    place = machine.frames(np.array([reading.pose])).tcp[0]
    away = float(np.linalg.norm(place - np.array(setup.station or (0.0, 0.0, 0.0))))
    return float((turned * away / 2) ** 2)


def limit(sizes: Sequence[float]) -> float:
    """Return the size above which the last reading is implausible: more where most are larger than the prior says."""
    if len(sizes) < _ENOUGH:
        return IMPLAUSIBLE
    usual = 1.4826 * float(np.median(sizes))
    return IMPLAUSIBLE * min(max(usual, 1.0), _WIDEST)


def nearest_first(readings: Sequence[Reading]) -> list[int]:
    """Return the indices of readings, those nearest to the middle of their set-up first."""
    middle = {
        name: np.median([r.values for r in readings if r.setup == name], axis=0) for name in {r.setup for r in readings}
    }
    away = [float(np.max(np.abs(np.array(r.values) - middle[r.setup]))) for r in readings]
    return [int(index) for index in np.argsort(away, kind="stable")]


class Doubt(NamedTuple):
    """A reading that is not used: its index from 0, and standard deviations from what the others predict.

    implausible : no error of about the stated size could make it; the standard deviations are then those of the prior
    """

    reading: int
    surprise: float
    implausible: bool = False
