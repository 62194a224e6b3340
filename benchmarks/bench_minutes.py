"""What plans make of minutes: readings and RMS of a machine whose ways cost time, at several speeds.

Two axes of 2 and 1.5 m carry a probe that reads z; heights along both and the roll of the first are unknown. `before`
is J of the search that this one replaced, which chose readings first and put them in order afterwards.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.numerics.threads import one_thread
from axiscal.planning.next_readings import posed
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits, Task

CANDIDATES = 400

MACHINE = """
name = "gantry"
chain = "w-b-X-Y-t"

[axes.X]
travel = ["0 mm", "2000 mm"]
speed = "{speed} mm/min"
acceleration = "1 m/s2"
overrun = "1 mm"

[axes.Y]
travel = ["0 mm", "1500 mm"]
speed = "{speed} mm/min"
acceleration = "1 m/s2"
overrun = "1 mm"

[errors]
EZX = {{ std = "20 um", length = "400 mm" }}
EZY = {{ std = "20 um", length = "400 mm" }}
EAX = {{ std = "20 urad", length = "400 mm" }}
"""
CAMPAIGN = """
machine = "m"
usual = "off"
[target]
budget = "10 min"
[[setups]]
name = "probe"
instrument = "probe"
direction = "z"
moves = ["X", "Y"]
reach = {{ X = ["0 mm", "2000 mm"], Y = ["0 mm", "1500 mm"] }}
noise = "1 um"
setup_time = "0 s"
settle = "0 s"
reading_time = "{seconds} s"
"""

ROWS = (
    (0.3, 1, 10),
    (0.3, 1, 20),
    (0.3, 1, 30),
    (1, 1, 3),
    (1, 1, 8),
    (3, 2, 2),
    (3, 2, 4),
    (10, 3, 1),
    (10, 3, 3),
    (20, 6, 3),
)


def asked(speed: float, seconds: float) -> Task:
    case = Case(
        campaign_from_texts(CAMPAIGN.format(seconds=seconds), "c.toml", MACHINE.format(speed=1000 * speed), "m")
    )
    return posed(case, case.knowledge, candidates=CANDIDATES)


def main() -> None:
    for speed, seconds, minutes in ROWS:
        task = asked(speed, seconds)
        start = time.process_time()
        plan = make_plan(task, Limits(budget=60.0 * minutes), bounded=False)
        spent = time.process_time() - start
        print(
            f"| {speed} m/min, {seconds} s | {minutes} | {len(plan.readings)} | {1e6 * plan.accuracy.rms:.2f} um"
            f" | {plan.value:.6g} | {plan.seconds / 60:.2f} | {spent:.1f} s |",
            flush=True,
        )


if __name__ == "__main__":
    with one_thread():
        main()
