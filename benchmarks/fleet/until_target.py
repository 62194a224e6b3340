"""One machine read until the target is reached, by beliefs that stand side by side: what a campaign does, in rows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from axiscal.estimation.case import Rival
from axiscal.estimation.data_equation import moments_of
from axiscal.estimation.promise.problem import Inherited
from axiscal.numerics import Array
from benchmarks.fleet.virtual_types import Bench

_MOST = 300
_BAND = 1.96
_GONE = 1e-9


class Reached(NamedTuple):
    """What became of a machine.

    readings : until the target; held : share of the tool point's deviations, at 408 poses from two sides, that are in
    their 95 % band; by_first : the same in that of the first belief alone; shares : how probable the beliefs are
    places : that were read
    """

    readings: int
    held: float
    by_first: float
    shares: Sequence[float]
    places: Sequence[int] = ()


class _Side:
    """One belief of all unknowns, and what it foretells at every place.  log : of how well it foretold the readings"""

    def __init__(self, bench: Bench, rival: Rival) -> None:
        prior, size = bench.case.prior, bench.size
        self.mean, self.covariance = prior.mean.copy(), prior.covariance.copy()
        self.mean[:size], self.covariance[:size, :size] = rival.belief.mean, rival.belief.covariance
        self.log = float(np.log(rival.weight))
        self._bench = bench
        self.seen = self.covariance @ bench.rows.T

    def take(self, place: int, value: float) -> None:
        """Take over a reading."""
        bench = self._bench
        variance = float(bench.rows[place] @ self.seen[:, place] + bench.variances[place])
        off = value - float(bench.rows[place] @ self.mean)
        self.log -= 0.5 * (off**2 / variance + np.log(variance))
        change = self.seen[:, place] / np.sqrt(variance)
        self.mean = self.mean + change * off / np.sqrt(variance)
        self.covariance = self.covariance - np.outer(change, change)
        self.seen = self.seen - np.outer(change, bench.rows @ change)


def plan_as_stated(bench: Bench) -> list[int]:
    """Return where the stated prior alone would read until the target, whatever it reads."""
    prior, size = bench.case.prior, bench.size
    stated = Rival("as stated", 1.0, Inherited(prior.mean[:size], prior.covariance[:size, :size]))
    return _campaign(bench, (stated,), prior.mean, np.random.default_rng(0))[0]


def reached(bench: Bench, rivals: Sequence[Rival], errors: Array, seed: Sequence[int]) -> Reached:
    """Return what became of a machine.  errors : (size,) its truth; the same seed for the same set-ups and noise"""
    rng = np.random.default_rng(list(seed))
    places, found, sides, shares = _campaign(bench, rivals, bench.unknowns(errors, rng), rng)
    first = Inherited(sides[0].mean, sides[0].covariance)
    held = _held(bench, found, errors), _held(bench, first, errors)
    return Reached(len(places), *held, tuple(shares.tolist()), tuple(places))


def _campaign(
    bench: Bench, rivals: Sequence[Rival], unknowns: Array, rng: np.random.Generator
) -> tuple[list[int], Inherited, list[_Side], Array]:
    """Read until the mixture has reached the target; return the places, the mixture, its parts and their shares.

    The planner works for the likeliest belief, and for the mixture once that one has reached the target. First comes a
    place of each set-up, which only finds its zero.
    """
    sides, places = [_Side(bench, rival) for rival in rivals], list[int]()
    target, setups = bench.case.description.target.rms or 0.0, int(bench.owner.max()) + 1
    while True:
        mixed, shares = _mixture(sides)
        first = len(places) < setups
        if not first and (_rms(bench, mixed.covariance) <= target or len(places) == _MOST):
            return places, mixed, sides, shares
        likeliest = sides[int(np.argmax(shares))]
        if first:
            place = int(np.flatnonzero(bench.owner == len(places))[0])
        elif _rms(bench, likeliest.covariance) > target:
            place = _best(bench, likeliest.seen)
        else:
            place = _best(bench, mixed.covariance @ bench.rows.T)
        value = bench.read(place, unknowns, rng)
        for side in sides:
            side.take(place, value)
        places.append(place)


def _mixture(sides: Sequence[_Side]) -> tuple[Inherited, Array]:
    logs = np.array([side.log for side in sides])
    odds = np.exp(logs - logs.max())
    shares = odds / odds.sum()
    kept = np.flatnonzero(shares > _GONE)
    parts = [Inherited(sides[index].mean, sides[index].covariance) for index in kept.tolist()]
    return (parts[0] if len(parts) == 1 else moments_of(parts, shares[kept] / shares[kept].sum())), shares


def _best(bench: Bench, seen: Array) -> int:
    """Return the place that lets J fall most.  seen : (n, m) C Hᵀ"""
    gains = np.sum((bench.root @ seen) ** 2, axis=0) / (np.sum(bench.rows.T * seen, axis=0) + bench.variances)
    return int(np.argmax(gains))


def _rms(bench: Bench, covariance: Array) -> float:
    return bench.yardstick.rms_of(float(np.sum((bench.root @ covariance) * bench.root)))


def _held(bench: Bench, found: Inherited, errors: Array) -> float:
    size = bench.size
    rows = bench.yardstick.rows.reshape(-1, size)
    off = rows @ (found.mean[:size] - errors)
    std = np.sqrt(np.sum((rows @ found.covariance[:size, :size]) * rows, axis=1))
    return float(np.mean(np.abs(off) <= _BAND * std))
