"""`python -m benchmarks.beyond`: the pictures of docs/evidence/equations.md; `reproduce` shows three of them, too."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.measurement.reading import Reading
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import Thoroughness, proposed
from axiscal.ports.paper.beyond import Compared, beyond
from tests.docs.pictures import svg

PICTURES = Path(__file__).parents[1] / "docs" / "pictures"
NAMES = ("beyond-joint.svg", "beyond-plane.svg", "beyond-station.svg")
_MICRO = 1e6
_BRIDGE = """chain = "w-b-Y-X-Z-t"
[axes.X]
travel = ["0 mm", "4000 mm"]
speed = "4 m/min"
[axes.Y]
travel = ["0 mm", "2000 mm"]
speed = "4 m/min"
[axes.Z]
travel = ["0 mm", "1000 mm"]
speed = "2 m/min"
[errors]
EXX = { std = "20 um", knots = 9, length = "800 mm" }
EYX = { std = "20 um", knots = 9, length = "800 mm" }
EYY = { std = "20 um", knots = 9, length = "600 mm" }
EZY = { std = "20 um", knots = 9, length = "600 mm" }
EZZ = { std = "10 um", knots = 9, length = "400 mm" }
"""
_TRACKER = """machine = "m"
[target]
readings = 24
[[setups]]
name = "tracker"
instrument = "tracker"
station = ["-1000 mm", "-1000 mm", "0 mm"]
noise = "5 um"
unknowns = {}
setup_time = "5 min"
settle = "1 s"
reading_time = "2 s"
"""


def costs() -> str:
    """Return how well a large machine is known against minutes: the same 24 readings by their worth, and by the way."""
    case = Case(campaign_from_texts(_TRACKER, "c.toml", _BRIDGE, "m.toml"))
    plan = proposed(case, Limits(24), Thoroughness(600)).plan.places
    rows = zip(plan.poses.tolist(), plan.approaches.tolist(), strict=True)
    readings = [Reading("tracker", tuple(p), tuple(int(a) for a in s), 0.0, others=(0.0, 0.0)) for p, s in rows]
    lines = {
        "one by one, the best first (the paper)": _known(case, _best_first(case, readings)),
        "by the way": _known(case, readings),
    }
    return svg({"x": "minutes", "y": "standard deviation, RMS, um", "lines": lines})


def _known(case: Case, readings: list[Reading]) -> tuple[list[float], list[float]]:
    """Return minutes and RMS over the volume, um, after each reading."""
    minutes, rms, known, last = [0.0], [_rms(case, [])], 0.0, None
    for count, reading in enumerate(readings, 1):
        known += case.seconds_of(last, reading)
        last = reading
        minutes.append(known / 60)
        rms.append(_rms(case, readings[:count]))
    return minutes, rms


def _best_first(case: Case, readings: list[Reading]) -> list[Reading]:
    chosen: list[Reading] = []
    left = list(readings)
    while left:
        best = min(range(len(left)), key=lambda i: _rms(case, [*chosen, left[i]]))
        chosen.append(left.pop(best))
    return chosen


def _rms(case: Case, readings: list[Reading]) -> float:
    belief = case.knowledge.read(readings).belief if readings else case.knowledge.belief
    return case.yardstick.measure(belief).rms * _MICRO


def picture(found: Compared) -> str:
    """Return what both methods miss against the number of readings."""
    count = list(found.scenario.readings)
    lines = {
        "linear and additive": (count, np.median(found.linear, axis=0) * _MICRO),
        "with everything": (count, np.median(found.whole, axis=0) * _MICRO),
    }
    return svg({"x": "readings", "y": "missed, um", "lines": lines, "log": True})


if __name__ == "__main__":
    for name, found in zip(NAMES, beyond(), strict=True):
        (PICTURES / name).write_text(picture(found))
    (PICTURES / "beyond-costs.svg").write_text(costs())
