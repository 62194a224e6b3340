"""How often the tests fire where nothing is wrong, and how often where something is, beside the formula for it.

    python benchmarks/bench_contrast.py             1,000 campaigns, a few minutes of one core
    python benchmarks/bench_contrast.py 100         so many campaigns

One axis of 1 m, 24 readings a minute apart, std 10 um, noise 0.5 um, an unknown zero that does not drift. Each campaign
is of another virtual machine, read through its kinematics. False alarms: the contrast at the end, odds of 20 to 1 after
any reading, one or the other. Power: to the same readings each departure is added with the size that readings show with
90 % by the formula; what the one test for it (alarms in 0.83 %) and what the contrast of all departures make of that,
the mean over its places. A place at which no reading stands beyond a step shows it at no size, and is left out.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from axiscal.accuracy.damage import FALSE_ALARM, needed
from axiscal.inference.contradiction import SURE, watched, whitened
from axiscal.inference.contrast import contrasts, threshold
from axiscal.measurement.departures import IN_PLANS, Departure, departures
from numpy.typing import NDArray
from scipy.stats import beta, chi2

from axiscal.inference.weighted_fit import Fitted
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import solution
from axiscal.numerics.gaussian import lower_root
from axiscal.numerics.threads import one_thread
from axiscal.simulation import Simulator
from benchmarks.trust.benches import PLACES, case_of, visits

CAMPAIGNS, _COUNT, _MINUTE, _MICRO, _ROUNDING = 1000, 24, 60.0, 1e6, 1e-12
_CASE = case_of("axis", "stated")


def campaign(places: str, seed: int) -> list[Reading]:
    """Return what one machine is read, nothing wrong with it."""
    setup = _CASE.description.setups[0]
    machine, rng = Simulator(_CASE.description.machine, (setup,)).drawn(seed), np.random.default_rng((seed, 4))
    taken = visits("axis", "stated", places, _COUNT, 0)
    return [
        Reading("it", *visit, machine.read_all(setup, *visit, rng)[0], time=_MINUTE * index)
        for index, visit in enumerate(taken)
    ]


@one_thread()
def rows(places: str, count: int) -> Iterator[str]:
    """Yield the line of the false alarms, then one for each family of departures.  count : of campaigns"""
    every = [campaign(places, seed) for seed in range(count)]
    fitted, observation = Fitted.of(_CASE.observation, every[0]), _CASE.observation
    lower = lower_root(fitted.covariance())
    shown = np.array([[reading.value for reading in each] for each in every])
    white = solution(lower, shown.T).T
    parts = whitened(lower, list(departures(observation, every[0])))
    limit = threshold(parts)
    fires = contrasts(parts, white) > limit
    looked = np.array([watched(observation, each).highest >= SURE for each in every])
    yield f"| {places} | nothing | – | – | – | {_share(fires)} | {_share(looked)} | {_share(fires | looked)} |"
    families: dict[str, list[Departure]] = {}
    for each in departures(observation, every[0], IN_PLANS):
        if each.family not in ("bad", "scale", "reversal"):
            families.setdefault(each.family, []).append(each)
    for family, members in families.items():
        shown_at_all = [each for each in members if _information(solution(lower, each.columns)) > 0]
        told = np.array([_told(each, lower, white, parts, limit) for each in shown_at_all])
        size, one, all_ = told[:, 0], told[:, 1].mean(), told[:, 2].mean()
        sizes = f"{size.min():.2g}" if np.ptp(size) < 0.05 * size.min() else f"{size.min():.2g} to {size.max():.2g}"
        yield f"| {places} | {family} | {sizes} | 90% | {one:.0%} | {all_:.0%} | – | – |"


def _information(part: Array) -> float:
    """Return bᵀK⁻¹b of the worst phase, 0 where it is rounding.  part : (m, r) whitened"""
    least = float(np.linalg.eigvalsh(part.T @ part)[0])
    return least if least > _ROUNDING * max(float(np.sum(part**2)), 1.0) else 0.0


def _told(each: Departure, lower: Array, white: Array, parts: Array, limit: float) -> tuple[float, float, float]:
    """Return the size that is shown with 90 %, um from the first to the last reading or as it stands, and how often
    the one test and the contrast fire at it.
    """
    part = solution(lower, each.columns)
    values, vectors = np.linalg.eigh(part.T @ part)
    worst, degrees = vectors[:, 0], part.shape[1]
    size = float(np.sqrt(needed(degrees) / values[0]))
    moved = white + size * (part @ worst)
    base = np.linalg.qr(part)[0]
    alone = np.sum((moved @ base) ** 2, axis=1) > chi2.ppf(1 - FALSE_ALARM, degrees)
    over = np.ptp(each.columns) if each.function is None else 1.0
    return _MICRO * size * float(over), float(alone.mean()), float((contrasts(parts, moved) > limit).mean())


def _share(fires: NDArray[np.bool_]) -> str:
    """Return a share with its 95 % limits (Clopper and Pearson)."""
    k, n = int(fires.sum()), len(fires)
    low, high = beta.ppf(0.025, k, n - k + 1) if k else 0.0, beta.ppf(0.975, k + 1, n - k) if k < n else 1.0
    return f"{k / n:.1%} ({low:.1%}–{high:.1%})"


if __name__ == "__main__":
    campaigns = int(sys.argv[1]) if len(sys.argv) > 1 else CAMPAIGNS
    print("| places | departure | size, um | formula | the one test | contrast | odds of 20 at any look | either |")
    print("|---|---|---|---|---|---|---|---|")
    for spread in PLACES:
        for line in rows(spread, campaigns):
            print(line, flush=True)
