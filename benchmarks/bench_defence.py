"""What plans can vouch for: the best for their model, evenly spaced, those that are guarded, and these in one round.

    python benchmarks/bench_defence.py          one axis, a few minutes of one core
    python benchmarks/bench_defence.py mill     three axes and three probes as well

RMS promise and what the readings vouch for (U_def), um; the most that one bad reading of them does when the others just
show it, um; the departure that does most damage; seconds of the processor.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.design.plan.guarded import vouched_along, vouched_for, worst_slip
from axiscal.design.plan.order import seconds_each
from axiscal.design.plan.plain_designs import evenly_spaced
from axiscal.design.plan.plan import make_plan
from axiscal.design.plan.task import Limits, Task
from axiscal.estimation.case import Case
from axiscal.estimation.defence import Defence
from axiscal.machine import load_machine
from axiscal.measurement.place import Places
from axiscal.planning.next_readings import posed
from axiscal.units import to_unit

AXIS = """machine = "one-axis"
[target]
readings = 20
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
noise = "0.5 um"
approach = "both"
"""
PROBE = """
[[setups]]
name = "p{0}"
instrument = "probe"
direction = "{0}"
moves = ["X", "Y", "Z"]
reach = {{ X = ["0 mm", "600 mm"], Y = ["0 mm", "400 mm"], Z = ["0 mm", "400 mm"] }}
approach = "both"
"""
MILL = 'machine = "three-axis-mill"\n[target]\nreadings = 66\n' + "".join(PROBE.format(axis) for axis in "xyz")


def task_of(text: str) -> Task:
    """Return what is to be planned of a campaign."""
    machine = text.split('"')[1]
    case = Case(campaign_from_texts(text, "campaign.toml", load_machine(machine).text, machine))
    return posed(case, case.knowledge)


def in_one_round(task: Task, places: Places) -> Defence:
    """Return what readings of one axis vouch for where one side is read as it rises, and the other as it falls."""
    sides, at = places.approaches[:, 0], places.poses[:, 0]
    once = places.within(np.lexsort([sides * at, -sides]))
    return vouched_along(task, once, np.cumsum(seconds_each(task, once)))


def rows(task: Task, readings: int) -> Iterator[str]:
    """Yield a line for each way to choose so many readings."""
    seconds, plans = [], list[tuple[str, Places]]()
    for name, guard in (("best for its model", False), ("guarded", True)):
        begun = time.process_time()
        plans.append((name, make_plan(task, Limits(readings=readings), guard=guard).places))
        seconds.append(time.process_time() - begun)
    counts = [(setup, len(mine)) for setup, mine in plans[0][1].by_setup()]
    plans.append(("evenly spaced", evenly_spaced(task, counts)))
    found = [(name, vouched_for(task, places)) for name, places in plans]
    slips = [worst_slip(task, places) for _, places in plans]
    seconds.append(0.0)
    if len(counts) == 1:
        found.append(("guarded, its places in one round", in_one_round(task, plans[1][1])))
        slips.append(slips[1])
        seconds.append(0.0)
    for (name, of), bad, took in zip(found, slips, seconds, strict=True):
        worst = next(each for each in of.departures if each.counted)
        promise, vouched = to_unit(of.promise, "um"), to_unit(of.u_def, "um")
        weakest = f"{worst.family} {worst.owner}, power {worst.power:.0%}"
        figures = f"{promise:.3f} | {vouched:.3f} | {to_unit(bad, 'um'):.2f}"
        yield f"| {readings} | {name} | {figures} | {weakest} | {took:.1f} |"


if __name__ == "__main__":
    print("| readings | plan | RMS um | U_def um | one bad reading um | weakest | s |\n|---|---|---|---|---|---|---|")
    cases = [(AXIS, each) for each in (10, 14, 20, 24, 28, 32, 40)] + [(MILL, 60), (MILL, 66)] * ("mill" in sys.argv)
    for text, count in cases:
        for row in rows(task_of(text), count):
            print(row, flush=True)
