"""What plans make of minutes: readings and RMS of a machine whose ways cost time, at several speeds.

Two axes of 2 and 1.5 m carry a probe that reads z; heights along both and the roll of the first are unknown. J is
compared with that of a search that chose readings first and put them in order afterwards.
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
"""Places that a plan chooses from: a few hundred, as nodes of a bed."""

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
    (0.3, 1, 10, 1.09053e-10),
    (0.3, 1, 20, 2.69774e-11),
    (0.3, 1, 30, 1.61114e-12),
    (1, 1, 3, 1.3346e-10),
    (1, 1, 8, 2.53923e-12),
    (3, 2, 2, 5.09063e-11),
    (3, 2, 4, 1.92963e-12),
    (10, 3, 1, 4.56708e-11),
    (10, 3, 3, 1.34235e-12),
    (20, 6, 3, 4.77192e-12),
)
"""m/min, seconds of a reading, minutes, and J of a plan by the search before, from the same candidates."""


def asked(speed: float, seconds: float) -> Task:
    """Return the machine with axes of so many m/min, and a reading of so many seconds."""
    texts = CAMPAIGN.format(seconds=seconds), "c.toml", MACHINE.format(speed=1000 * speed), "m"
    case = Case(campaign_from_texts(*texts))
    return posed(case, case.knowledge, candidates=CANDIDATES)


def main() -> None:
    """Print readings, RMS and J of each plan, J over that of the search before, and seconds of the processor."""
    print("| m/min | s a reading | minutes | readings | RMS um | minutes taken | J | J / before | s |")
    print("|---|---|---|---|---|---|---|---|---|")
    for speed, seconds, minutes, before in ROWS:
        task, start = asked(speed, seconds), time.process_time()
        plan = make_plan(task, Limits(budget=60.0 * minutes), bounded=False)
        spent = time.process_time() - start
        made = f"{len(plan.readings)} | {1e6 * plan.accuracy.rms:.2f} | {plan.seconds / 60:.2f} | {plan.value:.3g}"
        print(f"| {speed} | {seconds} | {minutes} | {made} | {plan.value / before:.2f} | {spent:.1f} |", flush=True)


if __name__ == "__main__":
    with one_thread():
        main()
