"""How often the posterior of one model covers what is true, where machines and readings are not as stated.

python benchmarks/bench_promise.py [MACHINES] [BENCH]     BENCH: "axis", "plate", "five axes" or "lengths"

Each row is a way of being wrong, each group of figures a choice of places, over machines of fresh seeds: share of the
volume that is no farther off than U (95 % are promised), true over promised RMS (geometric mean), and the share of
machines whose ratio is above 1.5. Places are planned by the ordinary criterion. "lengths" makes
all readings of the axis longer alike, and counts what no reading shows.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from axiscal.accuracy.expanded import expanded
from axiscal.belief import Belief
from axiscal.error_model.model import ErrorModel
from axiscal.estimation.case import Case
from axiscal.numerics.threads import one_thread
from axiscal.promise.heavy_tails import Volume
from axiscal.promise.posterior import posterior
from axiscal.promise.problem import problem
from axiscal.promise.sizes import Sizes
from axiscal.promise.type_b import SaidOfSetup
from axiscal.promise.usual import Learnable, rescaled_machine, sizes_of, usual_machine
from benchmarks.trust.attacks import ATTACKS, Attack, Passing, attacked
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


@one_thread()
def met(attack: Attack, places: str, seed: int, said: Mapping[str, SaidOfSetup] | None = None) -> tuple[float, float]:
    """Return the ratio of true to promised RMS, and the share of the volume inside U.

    said : of set-ups by name, where what no reading shows counts
    """
    found = attacked(attack, places, "stated", seed)
    described = found.stated.description
    machine = usual_machine(described.machine, described.setups)
    case = replace(found.stated, description=replace(described, machine=machine))
    sizes = sizes_of(machine, described.setups, Learnable("roughly", usual=True, inherited=False))
    known = posterior(problem(case.observation, found.readings, sizes, said=said), over=_volume(case, sizes))
    wide = replace(case, description=replace(described, machine=rescaled_machine(machine, known.sizes)))
    belief = Belief(known.mean, known.agreement.inflation * (known.covariance + known.covariance.T) / 2)
    promised = wide.yardstick.measure(belief).rms
    size = found.sizes_left(ErrorModel(machine).rows(*found.places) @ known.mean[: case.errors.size])
    inside = float(np.mean(size <= expanded(wide.yardstick, belief).space))
    return float(np.sqrt(np.mean(size**2))) / promised, inside


def _volume(case: Case, sizes: Sizes) -> Volume:
    """Return what unknowns and rests do over the volume."""
    terms, moments = case.errors.terms, case.yardstick.moments
    size_at = sizes.indices("rest", [term.name for term in terms])
    rests = np.array([term.rest**2 * moments.levers[term.name] for term in terms])
    return Volume(case.yardstick.root.matrix, rests[size_at >= 0], size_at[size_at >= 0])


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
    said: Mapping[str, SaidOfSetup] | None = {} if bench == "lengths" else None
    asked = [attack for attack in ATTACKS if attack.bench == bench and attack.words not in _REFUSED]
    for attack in _LENGTHS if bench == "lengths" else asked:
        row = []
        for places in PLACES:
            each = np.array([met(attack, places, _FIRST + index, said) for index in range(machines)])
            ratio, share = float(np.exp(np.mean(np.log(each[:, 0])))), float(np.mean(each[:, 0] > 1.5))
            row.append(f"{np.mean(each[:, 1]):.0%}, {ratio:.2f}, {share:.0%}")
        print(f"| {attack.words} | {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
