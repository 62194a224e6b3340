"""From readings to what is known: linear where the machine is, sizes averaged over, slips taken out.

A reading that the others contradict is a slip of a hand, a chip, a wrong line (`left_out`).
"""

from __future__ import annotations

from functools import partial

import numpy as np

from axiscal_core.draws import Weighed, as_stated
from axiscal_core.known import Known
from axiscal_core.left_out import Judged, taken_out
from axiscal_core.model import Model
from axiscal_core.places import Readings
from axiscal_core.posing import posed
from axiscal_core.refusals import Array, InputError
from axiscal_core.threads import one_thread
from axiscal_core.unknowns import space_of

_ROUNDS = 20  # of Gauss and Newton: who needs more has described another set-up
_LINEAR = 0.01  # noises


@one_thread()
def estimated(case: Model, *parts: Readings) -> Known:
    """Return what readings make known, all parts together."""
    readings = sum(parts[1:], parts[0])
    case.values(readings, "Case.estimate")
    if not len(readings):
        raise InputError("Case.estimate", "readings", "are none", "Give one or more")
    kept = np.arange(len(readings))
    found = Judged.of(posed(case, readings, located(case, readings)))
    if bad := taken_out(found)[0]:
        kept = np.setdiff1d(kept, [*bad])
        mine = only(case, readings, kept)
        found = Judged.of(posed(case, mine, located(case, mine)))  # a slip moves where a station is found
    draws = found.found
    mean, covariance, moved = averaged(draws)
    sizes = {f"{kind} {owner}": factor for (kind, owner), factor in found.sizes.items()}
    apart = {int(kept[i]): each.z for i, each in found.left.items()}
    again = partial(estimated, case, readings)
    return Known(case, mean, covariance, moved, np.sqrt(draws.weights), sizes, tuple(bad), apart, readings, again)


def averaged(draws: Weighed) -> tuple[Array, Array, Array]:
    """Return mean (size,), covariance (size, size) without type B, and (size, c, d) what type B moves in each draw."""
    each = [given.without_causes() for given in draws.given]
    mean = draws.weights @ np.array([one.mean for one in each])
    covariance = np.zeros((len(mean),) * 2)
    for weight, one in zip(draws.weights, each, strict=True):
        covariance += weight * (one.covariance + np.outer(one.mean - mean, one.mean - mean))
    moved = [np.sqrt(w) * given.type_b.gains for w, given in zip(draws.weights, draws.given, strict=True)]
    return mean, covariance, np.stack(moved, axis=2)


def located(case: Model, readings: Readings) -> Array | None:
    """Return the unknowns at which readings are to be linear, (size,), by Gauss-Newton; None where nominal rows do.

    An instrument 300 mm from where it is said to stand has other rows.
    """
    about: Array | None = None
    for _ in range(_ROUNDS):
        n, mean = case.numbers(readings, about), as_stated(space_of(posed(case, readings, about))).without_causes().mean
        promised = n.shown + n.rows @ (mean if about is None else mean - about)
        there = case.numbers(readings, mean)
        if np.abs(there.shown - promised).max(initial=0.0) < _LINEAR * there.noise.min():
            return about
        about = mean
    raise InputError("Case.estimate", "readings", "fit no machine near this one", "Say better where instruments stand")


def only(case: Model, readings: Readings, kept: np.ndarray) -> Readings:
    """Return some readings.  kept : (k,) which"""
    place = case.numbers(readings).place
    std, time = (None if each is None else each[kept] for each in (readings.std, readings.time))
    return Readings(readings.places.at(kept), readings.values[np.isin(place, kept)], std, time)
