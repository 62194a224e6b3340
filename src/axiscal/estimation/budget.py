"""Where the uncertainty of the tool point comes from: the budget of an estimate.

The error of an estimate is linear in all unknowns x and in the noise v of y = H x + v. With C the covariance after the
readings, P the prior covariance of x and R that of v,

    x − x̂ = G (x − x₀) − C Hᵀ R⁻¹ v,    G = I − C Hᵀ R⁻¹ H = C P⁻¹,    C = C P⁻¹ C + C Hᵀ R⁻¹ H C

(Joseph's form; Bierman, Factorization Methods, 1977). Independent sources add: each block of P and of R has its
covariance, and with it a mean square over the volume.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from axiscal.estimation.estimation import Estimation
from axiscal.estimation.promise.causes import Contribution, contributions
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading_rows import Seen, places_of, seen
from axiscal.measurement.setup import Unknown
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread


class BudgetShare(NamedTuple):
    """One source.

    kind : as reports name it; setup : whose readings they are, for "instrument"; rms : m, over the volume
    cause : what no reading shows, for "type B"
    """

    kind: str
    setup: str
    rms: float
    cause: Contribution | None = None


@one_thread()
def budget(known: Estimation) -> list[BudgetShare]:
    """Return the shares of the RMS standard uncertainty over the volume; their squares add up to its square.

    They are at the sizes as learnt. "sizes" is what the posterior has more; where it has less they add up to more.
    """
    if not known.readings:
        return _before(known)
    spread, numbers = _spread(known), seen(known.knowledge.observation, known.readings)
    read = known, spread, numbers
    shares = [*_of_readings(*read), *_of_unknowns(known, spread), *_of_type_b(*read)]
    missing = known.accuracy.rms**2 - sum(share.rms**2 for share in shares)
    return [*shares, BudgetShare("sizes", "", float(np.sqrt(max(missing, 0.0))))]


def _before(known: Estimation) -> list[BudgetShare]:
    yardstick = known.case.yardstick
    detail, unseen = yardstick.moments.rest, yardstick.unseen_rms**2
    prior = max(known.accuracy.rms**2 - detail - unseen, 0.0)
    return [BudgetShare(kind, "", float(np.sqrt(each)))
            for kind, each in (("detail", detail), ("prior", prior), ("unseen", unseen))]  # fmt: skip


def _of_readings(known: Estimation, spread: Array, numbers: Seen) -> Iterator[BudgetShare]:
    """Yield what the noise of each set-up's readings leaves: C Hᵀ R⁻¹ H C of these."""
    setups, precision = known.knowledge.observation.setups, known.absorbed.precisions(numbers)
    owner = places_of(setups, known.readings).setups[numbers.reading]
    for k, setup in enumerate(setups):
        mine = owner == k
        if np.any(mine):
            passed = (spread @ numbers.rows[mine].T) * np.sqrt(precision[mine])
            yield BudgetShare("instrument", setup.name, float(np.linalg.norm(passed)))


def _of_type_b(known: Estimation, spread: Array, numbers: Seen) -> Iterator[BudgetShare]:
    """Yield the shift of the estimate by one standard deviation of each type B cause b: V C Hᵀ R⁻¹ b."""
    observation = known.knowledge.observation
    places, values = places_of(observation.setups, known.readings), [each.values for each in known.readings]
    causes = contributions(observation, places, values, known.case.description.usual)
    if causes:
        columns = np.column_stack([each.effects for each in causes])
        moved = spread @ (numbers.rows.T @ (known.absorbed.precisions(numbers)[:, None] * columns))
        for cause, rms in zip(causes, np.linalg.norm(moved, axis=0).tolist(), strict=True):
            yield BudgetShare("type B", "", rms, cause)


def _spread(known: Estimation) -> Array:
    """Return V C, (r, size): V is what all unknowns do to the tool over the volume."""
    factor = known.knowledge.belief.factor
    return known.case.yardstick.root.times(factor) @ factor.T


def _of_unknowns(known: Estimation, spread: Array) -> Iterator[BudgetShare]:
    """Yield what each kind of unknown leaves: V C P⁻¹ C Vᵀ of its block of P."""
    case, observation = known.case, known.knowledge.observation
    own = case.errors.size
    found = dict.fromkeys(("set-up", "drift", "temperature", "artefact", "detail"), 0.0)
    for column, (kind, variance) in enumerate(_sources(observation), start=own):
        found[kind] += float(spread[:, column] @ spread[:, column]) / variance if variance > 0 else 0.0
    yardstick = case.yardstick_as_sized
    found["detail"] += yardstick.moments.rest
    whitened = np.linalg.lstsq(case.prior.factor[:own], spread[:, :own].T)[0]
    errors = float(np.sum(whitened**2)) - yardstick.root.criterion(yardstick.unseen)
    found |= {"prior": max(errors, 0.0), "unseen": yardstick.unseen_rms**2}
    yield from (BudgetShare(kind, "", float(np.sqrt(each))) for kind, each in found.items())


def _sources(observation: Observation) -> list[tuple[str, float]]:
    """Return kind and prior variance of every column beyond the errors."""
    kinds = [(_kind(unknown), unknown.std**2) for unknown in observation.unknowns]
    rest = observation.bare.rest_variances(observation)
    start = observation.errors.size + len(kinds)
    drifts = {column for course in observation.courses.values() for column in course.columns}
    return kinds + [("drift" if start + k in drifts else "detail", float(each)) for k, each in enumerate(rest)]


def _kind(unknown: Unknown) -> str:
    if unknown.name == "growth":
        return "temperature"
    return "artefact" if unknown.owner and unknown.owner != "tool" else "set-up"
