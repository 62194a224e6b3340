"""What is attacked: an axis under a laser, two axes under a probe, five axes under an R-test; where each is read."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Literal

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.measurement.candidates import spread
from axiscal.measurement.reading import Places
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed

Name = Literal["axis", "plate", "five axes"]
Visits = tuple[tuple[tuple[float, ...], tuple[int, ...]], ...]
"""Poses with the sides from which each axis comes, in the order in which they are read."""
Changes = tuple[tuple[str, str], ...]
"""What stands in the texts of a bench, and what stands there instead."""

PLACES = ("planned", "even", "random")
_ANYWHERE = 4000


@dataclass(frozen=True, slots=True)
class Bench:
    """machine, setup : texts; readings : how many are taken unless an attack says otherwise

    candidates : among which a plan chooses; as many as the program takes where that costs seconds
    head : what stands at the top of the campaign
    """

    machine: str
    setup: str
    readings: int
    candidates: int
    head: str = ""


_AXIS = """
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "1000 mm"]
[errors]
EXX = { std = "STD", length = "LENGTH", knots = 21, rest = "0.3 um" }
EXX_reversal = { std = "3 um" }
"""
_LASER = """
[[setups]]
name = "it"
instrument = "interferometer"
direction = "x"
approach = "both"
noise = "NOISE"
unknowns = { zero = "1 mm" }
"""
_PLATE = """
chain = "w-b-X-Y-t"
[axes.X]
travel = ["0 mm", "400 mm"]
[axes.Y]
travel = ["0 mm", "400 mm"]
[errors]
EZX = { std = "STD", length = "LENGTH", knots = 9, rest = "0.3 um" }
EZY = { std = "STD", length = "LENGTH", knots = 9, rest = "0.3 um" }
"""
_PROBE = """
[[setups]]
name = "it"
instrument = "probe"
direction = "z"
approach = "+"
reach = { X = ["0 mm", "400 mm"], Y = ["0 mm", "400 mm"] }
noise = "NOISE"
unknowns = { zero = "1 mm" }
"""
_FIVE = """
chain = "w-C'-B'-b-Y-X-Z-t"
[tool]
length = "120 mm"
[axes.X]
travel = ["-300 mm", "300 mm"]
[axes.Y]
travel = ["-250 mm", "250 mm"]
[axes.Z]
travel = ["0 mm", "500 mm"]
[axes.B]
travel = ["-30 deg", "120 deg"]
origin = ["0 mm", "0 mm", "-200 mm"]
[axes.C]
travel = ["0 deg", "360 deg"]
origin = ["0 mm", "0 mm", "-200 mm"]
[errors]
EXX = { std = "STD", knots = 7, length = "LENGTH", rest = "0.3 um" }
EYY = { std = "STD", knots = 7, length = "LENGTH", rest = "0.3 um" }
EZZ = { std = "STD", knots = 7, length = "LENGTH", rest = "0.3 um" }
EBB = { std = "25 urad", knots = 7, length = "45 deg" }
ECC = { std = "25 urad", knots = 9, length = "60 deg" }
EXC = { std = "3 um", knots = 9, length = "60 deg" }
C0Y = { std = "25 urad" }
B0Z = { std = "25 urad" }
A0Z = { std = "25 urad" }
X0B = { std = "15 um" }
Z0B = { std = "15 um" }
A0B = { std = "30 urad" }
C0B = { std = "30 urad" }
X0C = { std = "15 um" }
Y0C = { std = "15 um" }
A0C = { std = "30 urad" }
B0C = { std = "30 urad" }
"""
_NEST = """
[[artefacts]]
name = "three spheres"
placed = "1 mm"
[artefacts.balls]
low = ["200 mm", "0 mm", "-80 mm"]
high = ["-100 mm", "170 mm", "120 mm"]
third = ["-100 mm", "-170 mm", "20 mm"]
[[setups]]
name = "it"
instrument = "rtest"
artefact = "three spheres"
approach = "both"
raster = { B = "15 deg", C = "15 deg" }
noise = "NOISE"
"""
BENCHES = {
    "axis": Bench(_AXIS, _LASER, 24, 4000),
    "plate": Bench(_PLATE, _PROBE, 24, 400),
    "five axes": Bench(_FIVE, _NEST, 24, 400, 'tool_length = "TOOL"\ntool_certificate = "drawn"\n'),
}
_USUAL: Changes = (("STD", "10 um"), ("LENGTH", "200 mm"), ("NOISE", "0.5 um"), ("TOOL", "5 um"))


@cache
def case_of(name: Name, scales: str, changes: Changes = (), usual: str = "on") -> Case:
    """Return what is calibrated, as stated or with changes.

    scales : how well sizes are known: "stated" or "estimate", as campaigns say it
    usual : "on" with what usually goes wrong, "off" with what is stated alone
    """
    bench = BENCHES[name]
    machine, setup = bench.machine, bench.setup
    head = f'usual = "{usual}"\nscales = "{scales}"\n{bench.head}'
    text = f'machine = "m"\n{head}[target]\nreadings = {bench.readings}\n{setup}'
    for old, new in (*changes, *_USUAL):
        machine, text = machine.replace(old, new), text.replace(old, new)
    return Case(campaign_from_texts(text, "campaign.toml", machine, "m"))


def visits(name: Name, scales: str, places: str, count: int, seed: int) -> Visits:
    """Return where so many readings are taken: as planned; evenly, out and back; or anywhere, out and back."""
    if places == "planned":
        return _planned(name, scales, count)
    rng = np.random.default_rng((seed, 6))
    if name == "five axes":
        return _of_five(places, count, rng)
    if name == "plate":
        grid = np.linspace(0.02, 0.38, 5)
        spots = list(product(grid, grid)) if places == "even" else rng.uniform(0, 0.4, (25, 2)).tolist()
        return tuple(((float(x), float(y)), (1, 1)) for x, y in spots)
    even = np.linspace(0.01, 0.99, (count + 1) // 2)
    out = even if places == "even" else np.sort(rng.uniform(0, 1, (count + 1) // 2))
    back = even if places == "even" else np.sort(rng.uniform(0, 1, count // 2))
    ways = [((float(x),), (1,)) for x in out] + [((float(x),), (-1,)) for x in back[::-1]]
    return tuple(ways[:count] if count % 2 else ways)


@cache
def _planned(name: Name, scales: str, count: int) -> Visits:
    """Return the places that a plan asks for, in its order."""
    return _rows(proposed(case_of(name, scales), Limits(count), BENCHES[name].candidates).places)


def _of_five(places: str, count: int, rng: np.random.Generator) -> Visits:
    """Return places at the balls, spread evenly or drawn from many."""
    described = case_of("five axes", "stated").description
    found = spread(described.machine, described.setups, count if places == "even" else _ANYWHERE)
    if places == "random":
        found = found.within(rng.choice(len(found), count, replace=False))
    return _rows(found)[:count]


def _rows(places: Places) -> Visits:
    rows = zip(places.poses.tolist(), places.approaches.tolist(), strict=True)
    return tuple((tuple(pose), tuple(int(side) for side in sides)) for pose, sides in rows)
