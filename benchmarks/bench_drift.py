"""What zeros that wander as is usual cost where nothing drifts, and what they buy where something does.

    python benchmarks/bench_drift.py            40 machines, a few minutes of one core
    python benchmarks/bench_drift.py 5          so many machines
    python benchmarks/bench_drift.py plans      what plans leave out: a minute

One axis of 1 m, 24 readings a minute apart, std 10 um, noise 0.5 um, an unknown zero; planned, even (out and back) and
random places. `said to stand still` is the campaign with drift = "0", `usual` the one that says nothing. Each row:
root mean squares over machines of what is promised and what is true, um; where both campaigns stand beside each other
the first is the one that is right. Silent: true above 1.5 times the promise and the verdict `holds`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from axiscal.estimation.ruled import ruled, ruling_of

from axiscal.accuracy.expanded import expanded
from axiscal.design.plan.task import Limits
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread
from axiscal.planning.proposal import Thoroughness, proposed
from axiscal.simulation import Simulator
from benchmarks.trust.benches import PLACES, Changes, case_of, visits

_STILL: Changes = ()
_USUAL: Changes = (('drift = "0 um/h"\n', ""),)
_MINUTE, _POSES, _WORSE = 60.0, 200, 1.5
MACHINES = 40
_FEW = 400
"""Candidates of a plan, of time."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """promised, true : RMS over the volume, um; word : the verdict"""

    promised: float
    true: float
    word: str

    @property
    def silent(self) -> bool:
        """Whether it is much worse than promised, and nothing says so."""
        return self.true > _WORSE * self.promised and self.word == "holds"


Shape = Callable[[Array], Array]
DRIFTS: dict[str, Shape] = {
    "nothing drifts": lambda along: 0.0 * along,
    "3 um, straight": lambda along: 3.0 * along,
    "10 um, straight": lambda along: 10.0 * along,
    "10 um, levelling off": lambda along: 10.0 * (1 - np.exp(-3 * along)),
    "10 um to and fro, one and a half times": lambda along: 10.0 * np.sin(3 * np.pi * along),
}


@one_thread()
def outcome(stated: Case, places: str, shape: Shape, seed: int) -> Outcome:
    """Return what one machine's readings promise, and what is true."""
    actual = case_of("axis", "stated", _STILL).description
    machine, rng = Simulator(actual.machine, actual.setups).drawn(seed), np.random.default_rng((seed, 4))
    taken = visits("axis", "stated", places, 24, seed)
    moved = 1e-6 * shape(np.linspace(0, 1, len(taken)))
    readings = [
        Reading("it", *visit, machine.read_all(actual.setups[0], *visit, rng)[0] + moved[index], time=_MINUTE * index)
        for index, visit in enumerate(taken)
    ]
    known = ruled(concluded(stated, readings))
    ruling, alone = ruling_of(known), expanded(known.banded.case.yardstick, known.banded.knowledge.belief)
    promised = known.accuracy.rms * max(ruling.expanded.space / alone.space, 1.0)
    where = np.random.default_rng(1).uniform(0.0, 1.0, (_POSES, 1))
    ways = np.where(np.arange(_POSES)[:, None] % 2 == 0, 1.0, -1.0)
    left = machine.deviation(where, ways) - known.estimate().deviation(where, ways)
    left -= left.mean(axis=0)
    true = float(np.sqrt(np.mean(np.sum(left**2, axis=1))))
    return Outcome(1e6 * promised, 1e6 * true, ruling.verdict)


def row(words: str, places: str, machines: int) -> str:
    """Return a line of the table."""
    cells = []
    for changes in (_STILL, _USUAL):
        stated = case_of("axis", "stated", changes)
        found = [outcome(stated, places, DRIFTS[words], seed) for seed in range(machines)]
        promised, true = (
            float(np.sqrt(np.mean(np.square(each)))) for each in ([o.promised for o in found], [o.true for o in found])
        )
        holds, silent = (np.mean([o.word == "holds" for o in found]), np.mean([o.silent for o in found]))
        cells.append(f"{promised:.2f} | {true:.2f} | {holds:.0%} | {silent:.0%}")
    return f"| {words} | {places} | {' | '.join(cells)} |"


def plan_rows() -> Iterator[str]:
    """Yield what plans promise, and what their readings do once drifts as they are usual count, in um.

    Read when the plan has them, and one a minute, as by hand.
    """
    for instrument, readings in product(("interferometer", "indicator"), (12, 24, 40)):
        case = case_of("axis", "stated", (("interferometer", instrument), *_USUAL))
        plan = proposed(case, Limits(readings), Thoroughness(_FEW)).plan
        where = zip(plan.places.poses.tolist(), plan.places.approaches.tolist(), strict=True)
        visited = [(tuple(pose), tuple(int(side) for side in sides)) for pose, sides in where]
        planned = [each.seconds for each in plan.readings]
        cells = []
        for times in (planned, [_MINUTE * index for index in range(readings)]):
            taken = [Reading("it", *visit, 0.0, time=at) for visit, at in zip(visited, times, strict=True)]
            took, rms = (times[-1] - times[0]) / _MINUTE, concluded(case, taken).accuracy.rms
            cells.append(f"{took:.1f} min, {1e6 * rms:.3f}")
        yield f"| {instrument} | {readings} | {1e6 * plan.accuracy.rms:.3f} | {' | '.join(cells)} |"


if __name__ == "__main__":
    if sys.argv[1:] == ["plans"]:
        print("| instrument | readings | plan | as planned | one a minute |\n|---|---|---|---|---|")
        for line in plan_rows():
            print(line, flush=True)
        sys.exit()
    count = int(sys.argv[1]) if len(sys.argv) > 1 else MACHINES
    told = "promised | true | holds | silent"
    print(f"| drift | places | said to stand still: {told} | usual: {told} |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for shape in DRIFTS:
        for spread in PLACES:
            print(row(shape, spread, count), flush=True)
