"""Where a tracer stands: four places chosen by hand, those that the plan chooses of twelve, and four of them by chance.

    python benchmarks/bench_stations.py     # five minutes

RMS of the shape of the three-axis mill that a plan of so many readings leaves, um, by picks alone, and what the details
of the errors, finer than their knots, leave of it whatever is read.
"""

from __future__ import annotations

import json
import math
import time
from pathlib import Path

import numpy as np

from axiscal.description.campaign import campaign_from_texts, read_campaign
from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.planning.next_readings import posed
from axiscal.planning.plan.greedy import chosen_setups, filled, scores_among
from axiscal.planning.plan.task import Limits, Task
from axiscal.units import to_unit

EXAMPLE = Path(__file__).parents[1] / "examples" / "tracer.campaign.toml"
FURTHER = [
    *[(600, 900, -500), (-800, 700, 300), (300, -800, 400), (300, 200, -600)],
    *[(900, 700, 300), (-900, 0, 0), (300, 200, 300), (1000, -700, -600)],
]
"""mm: places about the machine, put down beside the four of the example without a trial."""
CHANCES, SEED = 20, 1


def twelve() -> str:
    """Return the example with the places of its set-ups, and further ones, to choose from."""
    by_hand = [tuple(to_unit(x, "mm") for x in setup.station or ()) for setup in read_campaign(EXAMPLE).setups]
    places = json.dumps([[f"{x:g} mm" for x in place] for place in [*by_hand, *FURTHER]])
    head, first, *_ = EXAMPLE.read_text(encoding="utf-8").split("[[setups]]")
    kept = [line for line in first.splitlines() if not line.startswith(("station", "#"))]
    return f"{head}[[setups]]\nchoose_from = {places}\n" + "\n".join(kept)


def left(case: Case, task: Task, readings: int, setups: tuple[int, ...]) -> float:
    """Return the RMS after readings of some set-ups, um."""
    places = filled(scores_among(task, setups), readings, setups).places
    return to_unit(case.yardstick.rms_of(task.state.after_readings(places).value), "um")


def main() -> None:
    machine = load_machine("three-axis-mill")
    case = Case(campaign_from_texts(twelve(), "campaign.toml", machine.text, "three-axis-mill"))
    task, rng = posed(case, case.knowledge), np.random.default_rng(SEED)
    print(f"details alone: {to_unit(math.sqrt(case.yardstick.rest), 'um'):.2f} um")
    print("readings  by hand  chosen  all twelve  by chance: best, median, worst   seconds to choose   chosen")
    for readings in (48, 80, 160):
        begun = time.process_time()
        chosen = chosen_setups(task, Limits(readings=readings))
        seconds = time.process_time() - begun
        drawn = [tuple(sorted(rng.choice(12, 4, replace=False).tolist())) for _ in range(CHANCES)]
        chance = [left(case, task, readings, setups) for setups in drawn]
        figures = [left(case, task, readings, setups) for setups in ((0, 1, 2, 3), chosen, tuple(range(12)))]
        figures += [min(chance), float(np.median(chance)), max(chance)]
        print(f"{readings:8d}", *(f"{figure:8.2f}" for figure in figures), f"{seconds:8.1f}", chosen, flush=True)


if __name__ == "__main__":
    main()
