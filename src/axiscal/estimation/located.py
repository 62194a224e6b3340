"""Fourth stage: where the stations stand that distances are read to, and about which machine readings are linear."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.history import History
from axiscal.estimation.stations import MOST, BentReadings, Optimum, mirrored, polished
from axiscal.exceptions import AmbiguityError
from axiscal.language.spoken import said
from axiscal.measurement.reading import Reading, drawn, place_text
from axiscal.measurement.reading_rows import linear_values, places_of
from axiscal.units import to_unit


def history(case: Case, readings: Sequence[Reading], left_out: Iterable[int] = ()) -> History:
    """Return readings as a case has them linear.  left_out : indices of those that do not count"""
    other = {reading.setup for reading in readings if not case.came_as_allowed(reading)}
    widened = replace(case, both=case.both | other) if other else case  # sides that nobody said they allow
    return History(widened, readings, frozenset(left_out))


_ROUNDS = 12
_LINEAR = 1e-2
"""RMS over all directions, in σ, of what the exact machine would change: less is not worth a second round."""


def located(known: History) -> History:
    """Return readings linearised about the machine and the stations that they show until these stay.

    A distance is linear about the assumed place of its station, so a better place makes a better estimate. Large errors
    of the machine also separate the exact chain from its rows. A round that asks for more than the one before goes half
    as far, and so do those after it: else the rounds would swing.
    known : with the sizes as learnt
    """
    share, last, count = 1.0, np.inf, known.case.observation.size
    for _ in range(_ROUNDS):
        mean = known.knowledge.belief.mean
        asked = moved_by(known, known.case.linear_about(mean))
        share, last = (share / 2 if asked > last else share), asked
        if asked < (_LINEAR if known.case.about is None else SETTLED):
            better = known.case.located(mean)
        else:
            start = np.zeros(count) if known.case.about is None else known.case.about
            better = known.case.linear_about(start + share * (mean[:count] - start))
        if better is None:
            break
        known = history(better, known.readings, known.left_out)
    return known


def moved_by(known: History, better: Case) -> float:
    """Return by how much the mean moves when readings are linearised elsewhere, in σ, RMS over all directions.

    known : after readings as they are linearised now
    With S Sᵀ the covariance it is ‖Sᵀ Hᵀ R⁻¹ Δe‖/√N, and never more than ‖Δe/σ‖/√N.
    """
    observation, counts = known.case.observation, ~np.isin(known.problem.reading, [*known.left_out])
    places, there = places_of(observation.setups, known.readings), replace(observation, about=better.about)
    here, moved = (linear_values(each, places, known.readings) for each in (observation, there))
    change = counts * (here - moved) / known.problem.noise
    if np.linalg.norm(change) < SETTLED * np.sqrt(known.rows.shape[1]):
        return 0.0
    return float(np.sqrt(np.mean((known.root.T @ (known.rows.T @ change)) ** 2)))


SETTLED = 1e-3
"""RMS of the change over all directions, in σ, at which rounds end."""


_NEAR, _APART = 6.0, 5.0
"""Optima within so much of the best one's log posterior, and so many standard deviations apart, are two."""


def refuse_mirrors(known: History, implausible: Collection[int]) -> None:
    """Raise AmbiguityError where a station's mirror image fits as well, with the reading that decides."""
    case = known.case
    kept = [reading for index, reading in enumerate(known.readings) if index not in implausible]
    size = case.observation.size
    for index in filter(case.station_columns, range(len(case.description.setups))):
        belief = known.knowledge.belief
        images = mirrored(case, kept, belief.mean[:size], index)
        for number, (columns, image) in enumerate(zip(case.station_columns(index), images, strict=False)):
            here, spread = belief.mean[list(columns)], belief.std[list(columns)]
            if np.all(np.abs(image[list(columns)] - here) < _APART * spread):
                continue
            bent_ones = BentReadings(case, drawn(kept, MOST))
            best, other = (polished(bent_ones, start) for start in (belief.mean[:size], image))
            apart = np.abs(best.point - other.point)[list(columns)] > _APART * spread
            if other.cost - best.cost < _NEAR and np.any(apart):
                raise _ambiguity(case, index, number, best, other)


def _ambiguity(case: Case, index: int, number: int, best: Optimum, other: Optimum) -> AmbiguityError:
    setup = case.description.setups[index]
    stated, columns = np.array(setup.standing[number]), list(case.station_columns(index)[number])
    spots = (to_unit(stated + each.point[columns], "mm").tolist() for each in (best, other))
    first, second = ("(" + ", ".join(f"{along:.1f}" for along in spot) + ") mm" for spot in spots)
    poses, sides = case.lattice.in_setup(index)
    one, two = (case.observation.shown(index, poses, sides, each.point)[:, number] for each in (best, other))
    decisive, apart = int(np.argmax(np.abs(one - two))), float(np.abs(one - two).max())
    axes, name = case.description.machine.axes, setup.name
    whose = said("station {number}", number=number + 1) if setup.stations else said("the station")
    what = '{whose} of "{name}" fits its readings as well at {first} as at {second} (x, y, z in the workpiece frame)'
    remedy = (
        'Read "{name}" at {place} as well: there the two differ by {apart:.3g} mm. '
        "Points in one plane cannot tell a station from its mirror image; or state the station nearer"
    )
    place, far = place_text(axes, poses[decisive].tolist()), to_unit(apart, "mm")
    return AmbiguityError(what, remedy, whose=whose, name=name, first=first, second=second, place=place, apart=far)
