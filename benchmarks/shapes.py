"""`python -m benchmarks.shapes`: the table and the picture of docs/evidence/shapes.md, in some minutes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.reading import Places, Reading
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal_core.threads import one_thread
from tests.docs.pictures import svg

PAGE = Path(__file__).parents[1] / "docs" / "evidence" / "shapes.md"
PICTURE = PAGE.parents[1] / "pictures" / "shapes.svg"
_MICRO, _MACHINES = 1e6, 12
_CURVE = 'EXX = { std = "10 um", length = "200 mm", knots = 21, rest = "0.3 um"PERIOD }\n'
_MACHINE = 'chain = "w-b-X-t"\n[axes.X]\ntravel = ["0 mm", "1000 mm"]\n[errors]\n' + _CURVE
_LASER = """[[setups]]
name = "it"
instrument = "interferometer"
direction = "x"
noise = "0.5 um"
unknowns = { zero = "1 mm" }
"""
STATED = {
    "nothing": ("", ""),
    "the period": (', period = "50 mm"', ""),
    "`EXX_pitch`, two waves": ("", 'EXX_pitch = { std = "4 um", period = "50 mm", harmonics = 2 }\n'),
}
_DENSE = np.linspace(0.0, 1.0, 2001)[:, None]


def case_of(words: str, readings: int, usual: str = "on") -> Case:
    """Return an axis of a metre under a laser, of which something is stated.  usual : "off" for that alone"""
    period, more = STATED[words]
    machine = _MACHINE.replace("PERIOD", period) + more
    text = f'machine = "m"\nusual = "{usual}"\n[target]\nreadings = {readings}\n{_LASER}'
    return Case(campaign_from_texts(text, "campaign.toml", machine, "m"))


def read(case: Case, places: Places, seed: int) -> tuple[list[Reading], Array]:
    """Return readings at planned places, and the true curve at dense ones, m, a pitch of 50 mm in both."""
    plain = case_of("nothing", len(places), "off").description
    machine, rng = Simulator(plain.machine, plain.setups).drawn(seed), np.random.default_rng((seed, 1))
    phase = rng.uniform(0, 2 * np.pi)
    readings = [
        Reading(
            "it", (x,), (1,), machine.read_all(plain.setups[0], (x,), (1,), rng)[0] + _wave(x, phase), time=60.0 * index
        )
        for index, x in enumerate(places.poses[:, 0].tolist())
    ]
    truth = machine.deviation(_DENSE, np.ones_like(_DENSE))[:, 0]
    return readings, truth + np.array([_wave(float(x), phase) for x in _DENSE[:, 0]])


def _wave(x: float, phase: float) -> float:
    return 5e-6 * float(np.sin(2 * np.pi * x / 0.05 + phase))


def missed(known: Estimation, truth: Array) -> float:
    """Return the RMS of truth less estimate, means taken off, m."""
    left = truth - known.estimate().deviation(_DENSE, np.ones_like(_DENSE))[:, 0]
    return float(np.std(left))


def rows() -> Iterator[str]:
    """Yield the table."""
    yield "| readings | stated | missed, um | promised, um | ratio | above 1.5 | withheld |"
    yield "|---|---|---|---|---|---|---|"
    for count in (16, 24):
        for words in STATED:
            case = case_of(words, count)
            places = proposed(case, Limits(count), 1000).plan.places
            off, promise, withheld = [], [], 0
            for seed in range(_MACHINES):
                readings, truth = read(case, places, seed)
                known = concluded(case, readings)
                off.append(missed(known, truth))
                promise.append(known.accuracy.rms)
                withheld += known.agreement.withheld
            sizes = [float(np.sqrt(np.mean(np.square(each)))) * _MICRO for each in (off, promise)]
            ratios = np.array(off) / promise
            figures = f"{sizes[0]:.2f} | {sizes[1]:.2f} | {np.median(ratios):.1f} | {np.sum(ratios > 1.5)} | {withheld}"
            yield f"| {count} | {words} | {figures} |"


def picture() -> str:
    """Return a stretch of one axis: the truth, and what is estimated with and without the pitch stated."""
    lines = {}
    shown = _DENSE[:, 0] <= 0.4
    for words, name in (("nothing", "period not stated"), ("`EXX_pitch`, two waves", "EXX_pitch stated")):
        case = case_of(words, 24)
        readings, truth = read(case, proposed(case, Limits(24), 1000).plan.places, 0)
        found = concluded(case, readings).estimate().deviation(_DENSE, np.ones_like(_DENSE))[:, 0]
        lines["truth"] = (_DENSE[shown, 0] * 1e3, (truth - truth.mean())[shown] * _MICRO)
        lines[name] = (_DENSE[shown, 0] * 1e3, (found - found.mean())[shown] * _MICRO)
    return svg({"x": "X, mm", "y": "um", "lines": lines})


if __name__ == "__main__":
    begin, end = "<!-- table: pitch -->\n", "<!-- end: pitch -->"
    with one_thread():
        table = "\n".join(rows())
        PICTURE.write_text(picture())
    before, rest = PAGE.read_text().split(begin)
    PAGE.write_text(before + begin + table + "\n" + end + rest.split(end, 1)[1])
