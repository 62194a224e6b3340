"""What becomes of machines that are no sisters, on types that no page shows: `python -m benchmarks.fleet.strangers`.

Of each, how far what changed shows in the readings that were taken: χ² grows by δ² = (H d)ᵀ (H C Hᵀ + V)⁻¹ (H d), with
C of a sister and d what the machine has besides. Below nine nobody who sees these readings alone could tell.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np

from axiscal.estimation.type_prior import rivals
from axiscal.numerics import Array
from axiscal_core.threads import one_thread
from benchmarks.fleet.types import STRANGERS, changed, equations_of, lesson_of
from benchmarks.fleet.until_target import Reached, plan_as_stated, reached
from benchmarks.fleet.virtual_types import Bench, VirtualType

FIRST, TYPES, SISTERS, _NEW, _OTHER = 1000, 40, 10, 1000, 5000
"""Seed of the first type; types; sisters that are known; number of the new machine; from a type's seed to another's."""
_BLIND = 9.0


@one_thread()
def main() -> None:
    """Print a line for each kind of machine."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--types", type=int, default=TYPES)
    bench, found = Bench("4 um"), defaultdict[str, list[tuple[Reached, float]]](list)
    plan = plan_as_stated(bench)
    for seed in range(FIRST, FIRST + parser.parse_args().types):
        for name, one, alone in _of_type(bench, plan, seed):
            found[name].append((one, alone))
    for name, each in found.items():
        of, shown = [one for one, _ in each], np.array([number for _, number in each])
        missed = np.array([one.shares[0] >= 0.5 for one in of])
        held = np.array([one.held for one in of])
        error = 100 * held.std(ddof=1) / np.sqrt(len(held))
        readings = np.median([one.readings for one in of])
        blind = int(np.sum(shown[missed] < _BLIND))
        print(f"{name}: its type alone below half {np.sum(~missed)} of {len(of)}; {readings:.0f} readings")
        print(f"    of the others {blind} show less than {_BLIND:g}; held {100 * held.mean():.1f} ± {error:.1f} %")


def _of_type(bench: Bench, plan: list[int], seed: int) -> Iterator[tuple[str, Reached, float]]:
    kind = VirtualType(bench, STRANGERS, seed)
    beliefs = rivals(lesson_of(bench, equations_of(bench, plan, kind, SISTERS, seed), SISTERS), bench.case.errors)
    sister = kind.machine(_NEW)
    machines = {"a sister": sister} | dict(changed(bench, sister))
    machines["of another type"] = VirtualType(bench, STRANGERS, _OTHER + seed).machine(_NEW)
    for name, errors in machines.items():
        one = reached(bench, beliefs, errors, (seed, 0))
        yield name, one, _shown(bench, one.places, beliefs[0].belief.covariance, errors - sister)


def _shown(bench: Bench, places: Sequence[int], sisters: Array, besides: Array) -> float:
    """Return δ² of what a machine has besides, in the readings at places.  sisters : C; besides : (size,)"""
    at = list(places)
    rows, covariance = bench.rows[at], bench.case.prior.covariance.copy()
    covariance[: bench.size, : bench.size] = sisters
    moved = rows[:, : bench.size] @ besides
    return float(moved @ np.linalg.solve(rows @ covariance @ rows.T + np.diag(bench.variances[at]), moved))


if __name__ == "__main__":
    main()
