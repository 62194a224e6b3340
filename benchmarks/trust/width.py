"""U beside that of an oracle who knows every size, and how much of a machine U then covers.

`python -m benchmarks.trust.width` takes a minute. One axis of a metre under a perfect laser, 24 readings. The truth is
no curve of the program's simulator: numpy draws it from the kernel below, at the places themselves.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import brentq
from scipy.stats import norm

from axiscal.description.campaign import campaign_from_texts
from axiscal.description.type_b import type_b_names
from axiscal.estimation.accuracy.expanded import expanded
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from benchmarks.trust.attacks import EVERY, Attack
from benchmarks.trust.benches import Changes

MACHINE = """
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "1000 mm"]
[errors]
EXX = { std = "10 um", length = "200 mm" }
EXX_reversal = { std = "3 um" }
"""
CAMPAIGN = """
machine = "m"
usual = "on"
[target]
aligned = false
readings = COUNT
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
approach = "both"
noise = "0.5 um"
drift = "0 um/h"
unknowns = { zero = "1 mm" }
"""
PLACES = ("planned", "even", "random")
RIGHT = "nothing"
WRONG = (
    "step", "bump", "pitch of 10 mm, 5 µm", "pitch of 50", "sawtooth", "pitch of half", "reversal that varies",
    "reversal that needs 60", "reversal that needs 300",
)  # fmt: skip
_SMOOTH, _LENGTH, _DETAIL, _SHORT, _REVERSAL, _NOISE, _ZERO = 10.0, 0.2, 0.3, 0.01, 3.0, 0.5, 1e3
"""um and m: the truth's own sizes."""
_DENSE, _MINUTE, _PHASE, FIRST = 200, 60.0, 0.05, 1000
"""Places of the truth, s, m by which an attack is moved along, and the first seed."""


@dataclass(frozen=True, eq=False)
class Ways:
    """Places x (m,) in m and sides (m,) of approach."""

    x: Array
    side: Array


def true_covariance(one: Ways, other: Ways) -> Array:
    """Return the covariance of the machine's deviations, (m, n) um²."""
    apart = np.abs(one.x[:, None] - other.x)
    far = np.sqrt(5.0) * apart / _LENGTH
    smooth = _SMOOTH**2 * (1 + far + far**2 / 3) * np.exp(-far)
    covariance: Array = smooth + _DETAIL**2 * np.exp(-apart / _SHORT)
    return covariance + (_REVERSAL / 2) ** 2 * np.outer(one.side, other.side)


@cache
def case_of(count: int, changes: Changes = ()) -> Case:
    """Return what is calibrated, with a perfect laser.  changes : of what is stated"""
    machine, campaign = MACHINE, CAMPAIGN.replace("COUNT", str(count))
    for old, new in changes:
        machine, campaign = machine.replace(old, new), campaign.replace(old, new)
    described = campaign_from_texts(campaign, "campaign.toml", machine, "m")
    perfect = tuple((name, 0.0) for name in type_b_names("interferometer"))
    setups = tuple(replace(setup, at_20=False, stated=perfect) for setup in described.setups)
    return Case(replace(described, setups=setups))


@cache
def _planned(count: int, changes: Changes) -> Ways:
    places = proposed(case_of(count, changes), Limits(count)).plan.places
    return Ways(places.poses[:, 0], places.approaches[:, 0].astype(float))


def ways(places: str, count: int, changes: Changes, rng: np.random.Generator) -> Ways:
    """Return where a campaign reads: as planned, or even or random places out and back."""
    if places == "planned":
        return _planned(count, changes)
    half = count // 2
    out, back = (
        (np.linspace(0.01, 0.99, half),) * 2 if places == "even" else np.sort(rng.uniform(0, 1, (2, half)), axis=1)
    )
    return Ways(np.r_[out, back[::-1]], np.r_[np.ones(half), -np.ones(half)])


@dataclass(frozen=True, slots=True)
class Found:
    """U, m; over : U over the oracle's; inside : share of the axis within U; withheld : whether no U is printed."""

    expanded: float
    over: float
    inside: float
    withheld: bool


@one_thread()
def found(attack: Attack, places: str, seed: int, count: int = 24, changes: Changes = ()) -> Found:
    """Return what the readings of one machine promise, and what is true."""
    rng = np.random.default_rng((seed, 61))
    at, everywhere = ways(places, count, changes, rng), _everywhere(rng)
    both = Ways(np.r_[at.x, everywhere.x], np.r_[at.side, everywhere.side])
    covariance = true_covariance(both, both) + 1e-6 * np.eye(len(both.x))
    own = float(rng.uniform(0.2, 0.8))
    truth = np.linalg.cholesky(covariance) @ rng.standard_normal(len(both.x))
    truth += attack.field(both.x[:, None] + rng.uniform(0, _PHASE), both.side, own)
    along = np.linspace(0, 1, len(at.x))
    values = truth[: len(at.x)] + attack.passing(at.x[:, None], at.side, along)
    values = values + rng.normal(0, _NOISE, len(at.x)) + rng.normal(0, 100.0)
    known = concluded(case_of(count, changes), _readings(at, values))
    belief = known.printed.belief
    size = expanded(known.case.yardstick, belief).space
    poses, sides = everywhere.x[:, None], everywhere.side[:, None]
    left = truth[len(at.x) :] - 1e6 * known.estimate().deviation(poses, sides)[:, 0]
    inside = float(np.mean(np.abs(left - left.mean()) <= 1e6 * size))
    return Found(size, 1e6 * size / _oracle(at, everywhere), inside, known.agreement.withheld)


def _everywhere(rng: np.random.Generator) -> Ways:
    x = (np.arange(_DENSE) + rng.uniform()) / _DENSE
    return Ways(x, np.where(np.arange(_DENSE) % 2 == 0, 1.0, -1.0))


def _readings(at: Ways, values: Array) -> list[Reading]:
    rows = zip(at.x.tolist(), at.side.tolist(), values.tolist(), strict=True)
    return [Reading("laser", (x,), (int(s),), 1e-6 * v, time=_MINUTE * i) for i, (x, s, v) in enumerate(rows)]


def _oracle(at: Ways, everywhere: Ways) -> float:
    """Return U of who knows every size, um: the mean of the axis is no matter, as the zero is free."""
    k = true_covariance(at, at) + _NOISE**2 * np.eye(len(at.x)) + _ZERO**2
    cross = true_covariance(everywhere, at)
    left = true_covariance(everywhere, everywhere) - cross @ cho_solve(cho_factor(k), cross.T)
    centred = np.eye(len(left)) - 1 / len(left)
    stds = np.sqrt(np.diagonal(centred @ left @ centred))
    return float(brentq(lambda u: np.mean(2 * norm.cdf(u / stds)) - 1.95, 1e-3, 1e3))


def rows(machines: int, readings: int) -> Iterator[str]:
    """Yield the lines of the table."""
    for attack in (each for each in EVERY if each.words == RIGHT or each.words.startswith(WRONG)):
        seeds = range(FIRST, FIRST + machines)
        cells = [[found(attack, places, seed, readings) for seed in seeds] for places in PLACES]
        yield f"| {attack.words} | {' | '.join(map(_text, cells))} |"


def _text(cells: list[Found]) -> str:
    over = np.exp(np.mean([np.log(each.over) for each in cells]))
    inside = np.mean([each.inside for each in cells if not each.withheld] or [np.nan])
    withheld = sum(each.withheld for each in cells)
    return f"{inside:.2f}, × {over:.2f}" + (f", {withheld} withheld" if withheld else "")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.trust.width", description=__doc__)
    parser.add_argument("--machines", type=int, default=16, help="in each cell")
    parser.add_argument("--readings", type=int, default=24)
    args = parser.parse_args()
    sys.stdout.write("| share inside U, U over the oracle's | planned | even | random |\n|---|---|---|---|\n")
    for line in rows(args.machines, args.readings):
        sys.stdout.write(line + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
