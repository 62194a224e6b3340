"""Which reading decides between the two likeliest causes of what contradicts the model.

    found = contest(known, gaps)
    found.first, found.second, found.place

Under a departure h of size s ~ N(0, s²) readings y and the numbers c of a candidate are normal together. With K the
model's covariance, k that of y and c, e = b_c − kᵀK⁻¹b, and Σ, u of the size after y (as in `inference.contradiction`),

    m_h = kᵀK⁻¹y + e Σu,    v_h = K_cc − kᵀK⁻¹k + e Σ eᵀ

and the reading that decides is argmax (m₁ − m₂)²/(v₁ + v₂) over the candidates of the set-up that is mounted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.estimation.believed import plausible_with_sides
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.inference.contradiction import MOST, SIZES, SURE, Explanation, Watched, watched
from axiscal.inference.weighted_fit import Fitted
from axiscal.measurement.candidates import spread
from axiscal.measurement.departures import Departure, Family, departures
from axiscal.measurement.instrument import values_of
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import solution
from axiscal.numerics.gaussian import lower_root
from axiscal.numerics.threads import one_thread
from axiscal.record.events import Gap

_RIVAL = 0.1
"""A cause competes with the likeliest one where its odds are no less than a tenth of those."""
FEWEST, _CANDIDATES = 6, 160
"""Fewer readings leave everything open; one of so many candidates is near the best of a curve of some tens of knots."""
_TELLS = 2.0
"""Standard deviations by which the two predictions differ where a reading decides: less would be asked for in vain."""
_ONE_CAUSE: tuple[frozenset[Family], ...] = (
    frozenset({"drift", "levelling", "excursion", "jump"}),
    frozenset({"bump", "detail"}),
)
"""Families that differ in how, not in what to do; how a zero has moved no later reading tells."""


@dataclass(frozen=True, slots=True)
class Contest:
    """Two causes that compete, and the reading that decides between them.

    first, second : the likeliest one first
    place : where to read; expected : what the first and the second let it show, m or rad, its first number
    apart : how far that is apart, in standard deviations
    """

    first: Explanation
    second: Explanation
    place: Place
    expected: tuple[float, float]
    apart: float


@one_thread()
def contest(known: Estimation, gaps: Sequence[Gap] = ()) -> Contest | None:
    """Return which causes compete for what contradicts the model, and what decides; None where nothing has to be.

    gaps : where no reading could be taken
    """
    readings = plausible_with_sides(known)
    if not FEWEST <= len(readings) <= MOST:
        return None
    rivals = _rivals(watched(known.case.observation, readings, known.case.inherited))
    return None if rivals is None else _decided(known.case, readings, rivals, gaps)


def _rivals(found: Watched) -> tuple[Explanation, Explanation] | None:
    """Return the two likeliest causes where the readings contradict the model and both may be."""
    if found.highest < SURE:
        return None
    first = found.explanations[0]
    others = (each for each in found.explanations[1:] if not _alike(first, each))
    second = next(others, None)
    return None if second is None or second.odds < _RIVAL * first.odds else (first, second)


def _alike(one: Explanation, other: Explanation) -> bool:
    both = {one.family, other.family}
    return one.owner == other.owner and any(both <= each for each in _ONE_CAUSE)


def _decided(
    case: Case, readings: Sequence[Reading], rivals: tuple[Explanation, Explanation], gaps: Sequence[Gap]
) -> Contest | None:
    candidates = _candidates(case, readings[-1], gaps)
    if not candidates:
        return None
    together = [*readings, *candidates]
    fitted = Fitted.of(case.observation, together, case.inherited)
    seen = int(np.searchsorted(fitted.reading, len(readings)))
    covariance, values = fitted.covariance(), fitted.values[:seen]
    lower = lower_root(covariance[:seen, :seen])
    half, white = solution(lower, covariance[:seen, seen:]), solution(lower, values)
    spare = np.diag(covariance)[seen:] - np.sum(half**2, axis=0)
    all_of_them = departures(case.observation, together, taken=len(readings))
    possible = {(each.family, each.owner, each.place, each.setup): each for each in all_of_them}
    unit = float(np.sqrt(np.median(fitted.noise[:seen])))
    asked = (possible[each.family, each.owner, each.place, each.setup] for each in rivals)
    told = [_predicted(each, lower, half, white, unit) for each in asked]
    (one, wide), (other, broad) = told
    apart = (one - other) ** 2 / (2 * spare + wide + broad)
    of_reading = np.bincount(fitted.reading[seen:] - len(readings), apart)
    best = int(np.argmax(of_reading))
    if not of_reading[best] > _TELLS**2:
        return None
    number = int(np.searchsorted(fitted.reading[seen:], len(readings) + best))
    base = float(half[:, number] @ white - fitted.values[seen + number])  # the prior, and what is not linear
    expected = base + float(one[number]), base + float(other[number])
    return Contest(*rivals, candidates[best].place, expected, float(np.sqrt(of_reading[best])))


def _predicted(each: Departure, lower: Array, half: Array, white: Array, unit: float) -> tuple[Array, Array]:
    """Return what a departure adds to the model's prediction of the candidates, mean and variance, (M,)."""
    seen = len(white)
    part = solution(lower, each.columns[:seen])
    beside = each.columns[seen:] - half.T @ part
    spread_of = np.linalg.inv(part.T @ part + np.eye(part.shape[1]) / (unit * SIZES[-1]) ** 2)
    return beside @ (spread_of @ (part.T @ white)), np.einsum("mr,rs,ms->m", beside, spread_of, beside)


def _candidates(case: Case, last: Reading, gaps: Sequence[Gap]) -> list[Reading]:
    """Return what may be read next in the set-up that is mounted, each at the time when it could be."""
    description = case.description
    setup = description.setup(last.setup)
    others = (0.0,) * (values_of(setup) - 1)
    found = []
    places = spread(description.machine, (setup,), _CANDIDATES)
    for pose, sides in zip(places.poses.tolist(), places.approaches.tolist(), strict=True):
        place = Place(setup.name, tuple(pose), tuple(int(side) for side in sides))
        if not any(gap.holds(place) for gap in gaps):
            time = (last.time or 0.0) + case.seconds_of(last, place)
            found.append(Reading(place.setup, place.pose, place.approach, 0.0, others=others, time=time))
    return found
