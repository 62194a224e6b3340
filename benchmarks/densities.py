"""`python -m benchmarks.densities`: the tables and the picture of docs/evidence/densities.md, in two minutes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal_core.threads import one_thread
from tests.docs.pictures import svg
from tests.generators.one_axis import MACHINE

PAGE = Path(__file__).parents[1] / "docs" / "evidence" / "densities.md"
PICTURE = PAGE.parents[1] / "pictures" / "densities.svg"
_MICRO = 1e6
_MACHINES = 40
_PLACES = np.linspace(0.02, 0.98, 13)
_DENSE = np.linspace(0.0, 1.0, 101)[:, None]
_NORMAL = 1e-6
Rule = Literal["ignored", "variance", "density"]
RULES: tuple[Rule, ...] = ("ignored", "variance", "density")

_CAMPAIGN = """machine = "m"
[target]
readings = 26
[[setups]]
name = "dial"
instrument = "indicator"
direction = "x"
noise = "1 um"
unknowns = {}
"""


def case_of(keys: str, more: str = "") -> Case:
    """Return one axis of 1 m with a dial along it.  keys : of the set-up; more : errors"""
    return Case(campaign_from_texts(f"{_CAMPAIGN}{keys}\n", "c.toml", f"{MACHINE}{more}\n", "m.toml"))


def taken(stated: Case, rule: Rule) -> Case:
    """Return the case as a rule takes its readings: all normal, with or without a wider variance, or as they are."""
    if rule == "density":
        return stated
    (setup,) = stated.description.setups
    plain = replace(setup, noise=_NORMAL if rule == "ignored" else setup.noise, bound=0.0)
    return Case(replace(stated.description, setups=(plain,)))


def read(stated: Case, seed: int, sides: tuple[int, ...] = (1, 1)) -> tuple[list[Reading], Array]:
    """Return two readings at each of thirteen places and the true curve, (101,) m."""
    machine = Simulator(stated.description.machine, stated.description.setups).drawn(seed)
    rng = np.random.default_rng((seed, 9))
    (setup,) = stated.description.setups
    readings = [
        Reading("dial", (float(x),), (side,), machine.read_all(setup, (float(x),), (side,), rng)[0])
        for side in sides
        for x in (_PLACES if side == sides[0] else _PLACES[::-1])
    ]
    return readings, machine.deviation(_DENSE, np.zeros_like(_DENSE))[:, 0]


def measured(case: Case, readings: list[Reading], truth: Array, name: str = "EXX") -> tuple[float, float, float]:
    """Return share of a curve in its 95 % band, mean squares of truth less estimate and of the band, m²."""
    curve = concluded(case, readings).estimate().curve(name, _DENSE[:, 0])
    off = truth - curve.mean
    return float(np.mean(np.abs(off) <= 1.96 * curve.std)), float(np.mean(off**2)), float(np.mean(curve.std**2))


def summed(found: list[tuple[float, float, float]]) -> str:
    """Return the cells of a table for some machines."""
    share, missed, band = np.mean(found, axis=0)
    return f"{share:.1%} | {np.sqrt(missed) * _MICRO:.2f} | {np.sqrt(band) * _MICRO:.2f}"


def bounds() -> Iterator[str]:
    """Yield the table of readings that may be off by anything within a bound."""
    yield "| bound | " + " | ".join(f"{rule}: held | missed, um | band, um" for rule in RULES) + " |"
    yield "|---" * (1 + 3 * len(RULES)) + "|"
    for size in ("2 um", "5 um", "10 um", "20 um"):
        stated, cells = case_of(f'bound = "{size}"'), []
        for rule in RULES:
            each = (read(stated, seed) for seed in range(_MACHINES))
            cells.append(summed([measured(taken(stated, rule), readings, truth) for readings, truth in each]))
        yield f"| {size} | " + " | ".join(cells) + " |"


def chipped(readings: list[Reading], size: float, seed: int) -> list[Reading]:
    """Return the readings at seven of the places, two of them shifted by a chip.  size : m"""
    rng, kept = np.random.default_rng((seed, 5)), [r for r in readings if r.pose[0] in _PLACES[::2]]
    hit = rng.choice(len(kept), 2, replace=False)
    return [replace(r, value=r.value + size * (1 + 0.3 * rng.uniform()) * (i in hit)) for i, r in enumerate(kept)]


def chips() -> Iterator[str]:
    """Yield the table of chips: two of fourteen readings, two at each of seven places, are shifted to one side."""
    yield "| chips of about | held | missed, um | band, um |"
    yield "|---|---|---|---|"
    case = case_of("")
    for size in (5, 10, 20, 50):
        found = []
        for seed in range(_MACHINES):
            readings, truth = read(case, seed)
            found.append(measured(case, chipped(readings, size / _MICRO, seed), truth))
        yield f"| {size} um | {summed(found)} |"


def lags() -> Iterator[str]:
    """Yield the table of a dead band, of what a reversal is taken for and of a curve read from one side."""
    yield "| what is estimated | dead band stated | held | missed, um | band, um |"
    yield "|---|---|---|---|---|"
    reversal = 'EXX_reversal = { std = "6 um" }'
    stated = case_of('dead_band = "3 um"\napproach = "both"', reversal)
    for words, name, sides in (
        ("reversal, read from both sides", "EXX_reversal", (1, -1)),
        ("curve, read from both sides", "EXX", (1, -1)),
        ("curve, read from one side", "EXX", (1, 1)),
    ):
        for keys in ("", 'dead_band = "3 um"'):
            case, found = case_of(f'{keys}\napproach = "both"', reversal), []
            for seed in range(_MACHINES):
                machine = Simulator(stated.description.machine, stated.description.setups).drawn(seed)
                names = [term.name for term in machine.model.terms]
                truth = machine.values(_DENSE)[names.index(name)]
                found.append(measured(case, read(stated, seed, sides)[0], truth, name))
            yield f"| {words} | {'yes' if keys else 'no'} | {summed(found)} |"


def picture() -> str:
    """Return a curve read within a bound of 10 um, and the band by each rule."""
    stated = case_of('bound = "10 um"')
    readings, truth = read(stated, 3)
    x = _DENSE[:, 0] * 1e3
    lines, band = {"truth": (x, truth * _MICRO)}, None
    words: dict[Rule, str] = {"variance": "normal, of the same variance", "density": "bounded"}
    for rule, said in words.items():
        curve = concluded(taken(stated, rule), readings).estimate().curve("EXX", _DENSE[:, 0])
        lines[said] = (x, curve.mean * _MICRO)
        band = (x, (curve.mean - 1.96 * curve.std) * _MICRO, (curve.mean + 1.96 * curve.std) * _MICRO)
    points = ([r.pose[0] * 1e3 for r in readings], [r.value * _MICRO for r in readings])
    return svg({"x": "X, mm", "y": "um", "lines": lines, "band": band, "points": {"readings": points}})


TABLES: dict[str, Callable[[], Iterator[str]]] = {"bounds": bounds, "chips": chips, "lags": lags}


def filled(page: str) -> str:
    """Return the page with the tables between their marks made anew."""
    for name, table in TABLES.items():
        begin, end = f"<!-- table: {name} -->\n", f"<!-- end: {name} -->"
        before, rest = page.split(begin)
        page = before + begin + "\n".join(table()) + "\n" + end + rest.split(end, 1)[1]
    return page


if __name__ == "__main__":
    with one_thread():
        PAGE.write_text(filled(PAGE.read_text()))
    PICTURE.write_text(picture())
