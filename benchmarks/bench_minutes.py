"""What plans make of minutes: readings and RMS of a machine whose ways cost time, at several speeds.

Two axes of 2 and 1.5 m carry a probe that reads z; heights along both and the roll of the first are unknown. J is
compared with that of a search that chose readings first and put them in order afterwards; so are the minutes to a
target.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.planning.next_readings import posed
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits, Task
from axiscal.planning.proposal import proposed
from axiscal_core.threads import one_thread

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
{target}
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


TARGETS = (
    (0.3, 1, 'rms = "2.43 um"', 23.44),
    (1, 1, 'U = "4 um"', 7.14),
    (1, 1, 'wants = ["straightness X in Z 3 um"]', 2.24),
    (3, 2, 'rms = "1.5 um"', 3.61),
    (20, 6, 'rms = "1.55 um"', 3.66),
)
"""m/min, seconds of a reading, what is asked for, and the minutes of a plan by the search before."""
_CHOICE = 600


def described(speed: float, seconds: float, target: str = 'budget = "10 min"') -> Case:
    """Return the machine with axes of so many m/min, and a reading of so many seconds."""
    campaign = CAMPAIGN.format(seconds=seconds, target=target)
    return Case(campaign_from_texts(campaign, "c.toml", MACHINE.format(speed=1000 * speed), "m"))


def asked(speed: float, seconds: float) -> Task:
    """Return what is to be planned with axes of so many m/min, and a reading of so many seconds."""
    case = described(speed, seconds)
    return posed(case, case.knowledge, candidates=CANDIDATES)


def for_targets() -> None:
    """Print readings and minutes to each target, these of the search before, and seconds of the processor."""
    print("\n| m/min | s a reading | target | readings | minutes | before | s |")
    print("|---|---|---|---|---|---|---|")
    for speed, seconds, target, before in TARGETS:
        case, start = described(speed, seconds, target), time.process_time()
        plan = proposed(case, Limits.of(case.description.target), _CHOICE)
        spent = time.process_time() - start
        made = f"{len(plan.readings)} | {plan.seconds / 60:.2f} | {before}"
        print(f"| {speed} | {seconds} | {target} | {made} | {spent:.1f} |", flush=True)


def for_budgets() -> None:
    """Print readings, RMS and J of each plan, J over that of the search before, and seconds of the processor."""
    print("| m/min | s a reading | minutes | readings | RMS um | minutes taken | J | J / before | s |")
    print("|---|---|---|---|---|---|---|---|---|")
    for speed, seconds, minutes, before in ROWS:
        task, start = asked(speed, seconds), time.process_time()
        plan = make_plan(task, Limits(budget=60.0 * minutes))
        spent = time.process_time() - start
        made = f"{len(plan.readings)} | {1e6 * plan.accuracy.rms:.2f} | {plan.seconds / 60:.2f} | {plan.value:.3g}"
        print(f"| {speed} | {seconds} | {minutes} | {made} | {plan.value / before:.2f} | {spent:.1f} |", flush=True)


if __name__ == "__main__":
    with one_thread():
        for_budgets()
        for_targets()
