"""`python -m benchmarks.shapes`: the table and the picture of docs/shapes.md, in some minutes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from axiscal.estimation.ruled import ruled, ruling_of

from axiscal.accuracy.expanded import expanded
from axiscal.description.campaign import campaign_from_texts
from axiscal.design.plan.task import Limits
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread
from axiscal.planning.proposal import Thoroughness, proposed
from axiscal.simulation import Simulator
from tests.docs.pictures import svg

PAGE = Path(__file__).parents[1] / "docs" / "shapes.md"
PICTURE = PAGE.parent / "pictures" / "shapes.svg"
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


def case_of(words: str, readings: int) -> Case:
    """Return an axis of a metre under a laser, of which something is stated."""
    period, more = STATED[words]
    machine = _MACHINE.replace("PERIOD", period) + more
    text = f'machine = "m"\n[target]\nreadings = {readings}\n{_LASER}'
    return Case(campaign_from_texts(text, "campaign.toml", machine, "m"))


def read(case: Case, places: Places, seed: int) -> tuple[list[Reading], Array]:
    """Return readings at planned places, and the true curve at dense ones, m, a pitch of 50 mm in both."""
    plain = case_of("nothing", len(places)).description
    machine, rng = Simulator(plain.machine, plain.setups).drawn(seed), np.random.default_rng((seed, 1))
    phase = rng.uniform(0, 2 * np.pi)
    readings = [
        Reading("it", (x,), (1,), machine.read(plain.setups[0], (x,), (1,), rng) + _wave(x, phase), time=60.0 * index)
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
    yield "| readings | stated | missed, um | promised, um | ratio | said: widened, contradicted, unchecked | silent |"
    yield "|---|---|---|---|---|---|---|"
    for count in (16, 24):
        for words in STATED:
            case = case_of(words, count)
            places = proposed(case, Limits(count), Thoroughness(1000)).plan.places
            off, promise, verdicts, silent = [], [], [], 0
            for seed in range(_MACHINES):
                readings, truth = read(case, places, seed)
                known = ruled(concluded(case, readings))
                ruling = ruling_of(known)
                alone = expanded(known.banded.case.yardstick, known.banded.knowledge.belief)
                off.append(missed(known, truth))
                promise.append(known.accuracy.rms * max(ruling.expanded.space / alone.space, 1.0))
                verdicts.append(ruling.verdict)
                silent += off[-1] > 1.5 * promise[-1] and verdicts[-1] == "holds"
            said = ", ".join(str(verdicts.count(v)) for v in ("widened", "contradicted", "unchecked"))
            sizes = [float(np.sqrt(np.mean(np.square(each)))) * _MICRO for each in (off, promise)]
            ratio = np.median(np.array(off) / promise)
            yield f"| {count} | {words} | {sizes[0]:.2f} | {sizes[1]:.2f} | {ratio:.1f} | {said} | {silent} |"


def picture() -> str:
    """Return a stretch of one axis: the truth, and what is estimated with and without the pitch stated."""
    lines = {}
    shown = _DENSE[:, 0] <= 0.4
    for words, name in (("nothing", "period not stated"), ("`EXX_pitch`, two waves", "EXX_pitch stated")):
        case = case_of(words, 24)
        readings, truth = read(case, proposed(case, Limits(24), Thoroughness(1000)).plan.places, 0)
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
