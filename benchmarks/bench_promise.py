"""How often the posterior of one model covers what is true, where machines and readings are not as stated.

python benchmarks/bench_promise.py [MACHINES] [BENCH]     BENCH: "axis", "plate", "five axes" or "lengths"

Each row is a way of being wrong, each group of figures a choice of places, over machines of fresh seeds: share of the
volume that is no farther off than U (95 % are promised), true over promised RMS (geometric mean), and the share of
machines whose ratio is above 1.5. Places are planned by the ordinary criterion. "lengths" makes
all readings of the axis longer alike, and counts what no reading shows.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks.trust.attacks import ATTACKS, Attack, Passing, outcome
from benchmarks.trust.benches import PLACES

_FIRST = 7000
"""Seeds that nothing was chosen on."""
_REFUSED = {"values in mm, read as µm", "sign turned"}
"""Slips that a reader of files refuses, or that no reading can show."""


def _longer(strain: float) -> Passing:
    """Return what makes all readings longer by a strain about the middle of the travel, um/m."""
    return lambda x, along: strain * (x[:, 0] - 0.5)


_LENGTHS = (
    Attack("nothing"),
    Attack("laser, 5 µm/m", passing=_longer(5.0)),
    Attack("material, 1 K", passing=_longer(11.7)),
    Attack("20 µm/m", passing=_longer(20.0)),
)


def main() -> None:
    """Print a table for Markdown."""
    machines = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    bench = sys.argv[2] if len(sys.argv) > 2 else "axis"
    print(
        f"| {bench}, {machines} machines each | "
        + " | ".join(f"{each}: inside, ratio, above 1.5" for each in PLACES)
        + " |"
    )
    print("|---" * (len(PLACES) + 1) + "|")
    asked = [attack for attack in ATTACKS if attack.bench == bench and attack.words not in _REFUSED]
    for attack in _LENGTHS if bench == "lengths" else asked:
        row = []
        for places in PLACES:
            seeds = range(_FIRST, _FIRST + machines)
            each = [outcome(attack, places, "stated", seed, bench == "lengths") for seed in seeds]
            ratios = np.array([one.ratio for one in each])
            ratio, share = float(np.exp(np.mean(np.log(ratios)))), float(np.mean(ratios > 1.5))
            row.append(f"{np.mean([one.inside for one in each]):.0%}, {ratio:.2f}, {share:.0%}")
        print(f"| {attack.words} | {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
