"""What the readings of a plan leave over what an even grid leaves: lines and maps of drawn shapes, and beds.

Beds are those of printers of many owners, each kept back: what is stated of its heights is what the other owners' beds
show. A thin-plate spline through the even grid stands beside both.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal_core.threads import one_thread
from benchmarks.trust.beds import Bed, available, beds, kept

COUNTS = (5, 7, 9, 16, 25)
LENGTHS = (0.1, 0.25, 0.5, 1.0)
"""Of the travel: how far what is drawn goes together."""
BEDS, WORST, OUTSIDE = {9: 0.95, 16: 0.90, 25: 0.87}, 1.15, 0.07
"""Readings of beds with the most that planned/even is to be, the most of any bed, and the most that may lie outside U.
"""
KEPT_BACK = 40
"""Beds of which each is kept back in turn."""
DRAWN = 12
"""Shapes of each length."""
_TRAVEL, _NODES = 300.0, 21
_LINE = f'chain = "w-b-X-t"\n[tool]\nlength = "100 mm"\n[axes.X]\ntravel = ["0 mm", "{_TRAVEL} mm"]\n[errors]\n'
_BED = _LINE.replace("b-X-t", "b-X-Y-t").replace("[errors]", f'[axes.Y]\ntravel = ["0 mm", "{_TRAVEL} mm"]\n[errors]')
_SETUP = """machine = "m"
[target]
readings = 1
[[setups]]
name = "gauge"
instrument = "{instrument}"
direction = "{direction}"
noise = "{noise} um"
unknowns = {unknowns}
"""
_REACH = f'reach = {{ X = ["0 mm", "{_TRAVEL} mm"], Y = ["0 mm", "{_TRAVEL} mm"] }}\n'


def cases() -> Iterator[tuple[str, Case, float]]:
    """Yield machines by name, with the standard deviation of their errors, m."""
    for noise in (0.2, 1.0, 3.0):
        setup = _SETUP.format(instrument="interferometer", direction="x", noise=noise, unknowns="{}")
        yield f"line, {noise} um", _case(setup, _LINE + 'EXX = { std = "10 um" }\n'), 1e-5
    errors = 'EZX = { std = "50 um" }\nEZY = { std = "50 um" }\nEAX = { std = "200 urad" }\n'
    for name, unknowns in (("bed", "{}"), ("bed, zero unknown", '{ zero = "5 mm" }')):
        setup = _SETUP.format(instrument="probe", direction="z", noise=2.0, unknowns=unknowns) + _REACH
        yield name, _case(setup, _BED + errors), 5e-5


def _case(campaign: str, machine: str) -> Case:
    return Case(campaign_from_texts(campaign, "campaign.toml", machine, "machine.toml"))


def shapes(axes: int) -> Iterator[RegularGridInterpolator]:
    """Yield shapes over [0, 1] along each axis, of standard deviation one or so, drawn afresh for each length."""
    rng, line = np.random.default_rng(77), np.linspace(0.0, 1.0, _NODES)
    nodes = np.stack(np.meshgrid(*[line] * axes, indexing="ij"), axis=-1).reshape(-1, axes)
    apart = np.linalg.norm(nodes[:, None] - nodes, axis=-1)
    for length in LENGTHS:
        near = np.sqrt(5) * apart / length
        root = np.linalg.cholesky((1 + near + near**2 / 3) * np.exp(-near) + 1e-8 * np.eye(len(nodes)))
        for _ in range(DRAWN):
            drawn = root @ rng.standard_normal(len(nodes)) * np.exp(rng.normal(0, 0.5))
            yield RegularGridInterpolator([line] * axes, (drawn - drawn.mean()).reshape([_NODES] * axes))


def even(axes: int, count: int) -> Array:
    """Return a grid of about as many places, shares of the travel, (m, axes)."""
    if axes == 1:
        return np.linspace(0.0, 1.0, count)[:, None]
    across = max(2, round(float(np.sqrt(count))))
    grid = np.meshgrid(np.linspace(0, 1, across), np.linspace(0, 1, max(2, count // across)))
    return np.stack(grid, axis=-1).reshape(-1, 2)


def left(case: Case, shares: Array, sides: Array, std: float) -> Array:
    """Return what readings at places leave of each shape, RMS, (shapes,) m."""
    axes, setup = shares.shape[1], case.description.setups[0]
    travel = np.array([axis.length for axis in case.description.machine.axes])
    at = np.stack(np.meshgrid(*[np.linspace(0, 1, 15)] * axes), axis=-1).reshape(-1, axes)
    direction, found = "xyz".index("x" if axes == 1 else "z"), []
    for number, shape in enumerate(shapes(axes)):
        noise = setup.noise * np.random.default_rng(1000 + number).standard_normal(len(shares))
        values = std * shape(np.clip(shares, 0, 1)) + noise
        rows = zip((shares * travel).tolist(), sides.astype(int).tolist(), values.tolist(), strict=True)
        known = concluded(case, [Reading("gauge", tuple(pose), tuple(side), value) for pose, side, value in rows])
        missed = std * shape(at) - known.estimate().deviation(at * travel, np.zeros_like(at))[:, direction]
        found.append(float(np.std(missed)) if setup.unknowns else float(np.sqrt(np.mean(missed**2))))
    return np.array(found)


def main() -> None:
    """Print the geometric mean of planned over even, what nine in ten shapes stay below, and how many are above 1."""
    print("| machine | " + " | ".join(map(str, COUNTS)) + " |\n|---" + "|---" * len(COUNTS) + "|")
    for name, case, std in cases():
        travel = np.array([axis.length for axis in case.description.machine.axes])
        cells = []
        for count in COUNTS:
            grid = even(len(travel), count)
            places = proposed(case, Limits(count), 1000).plan.places
            planned = left(case, places.poses / travel, places.approaches, std)
            ratio = np.log(planned / left(case, grid, np.zeros_like(grid), std))
            above = int(np.sum(ratio > 0))
            cells.append(f"{np.exp(ratio.mean()):.2f}, {np.exp(np.quantile(ratio, 0.9)):.2f}, {above}")
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)
    if available():
        for_beds()


def for_beds() -> None:
    """Print planned over even and over a thin-plate spline, the worst bed, what lies within U, and what falls short."""
    every = list(beds())
    chosen = [every[k] for k in np.linspace(0, len(every) - 1, KEPT_BACK).astype(int).tolist()]
    found = list[str]()
    print("\n| readings | beds | planned/even | worst | even/spline | planned/spline | inside U, planned | even |")
    print("|---" * 8 + "|")
    for count, goal in BEDS.items():
        each = [kept(bed, count, stated_by_others(every, bed)) for bed in chosen]
        planned, grid, spline = np.log([one.missed for one in each]).T
        inside = np.mean([one.inside for one in each], axis=0)
        figures = [
            ("planned/even", np.exp(np.mean(planned - grid)), goal),
            ("worst", np.exp(np.max(planned - grid)), WORST),
            ("planned/spline", np.exp(np.mean(planned - spline)), 1.0),
            ("outside U", 1 - inside[0], OUTSIDE),
        ]
        over, worst, beside, _ = (f"{value:.3f}" for _, value, _ in figures)
        alone = f"{np.exp(np.mean(grid - spline)):.3f}"
        print(f"| {count} | {len(each)} | {over} | {worst} | {alone} | {beside} | {inside[0]:.3f} | {inside[1]:.3f} |")
        found += [f"{count} readings: {name} {value:.3f}, not {most}" for name, value, most in figures if value > most]
    print("\nShort: " + ("; ".join(found) or "nothing"), flush=True)


def stated_by_others(every: Sequence[Bed], bed: Bed) -> str:
    """Return the median of what all beds but one are off their planes, which is then stated of each error."""
    others = [float(np.std(other.heights)) for other in every if other is not bed]
    return f"{1e6 * np.median(others):.0f} um"


if __name__ == "__main__":
    with one_thread():
        main()
