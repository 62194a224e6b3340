"""Ways of being wrong, each tried on planned, even and random places, with stated and with learnt priors."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import product

import numpy as np

from axiscal.accuracy.expanded import expanded
from axiscal.description.campaign import campaign_from_texts
from axiscal.design.plan.task import Limits
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.ruled import ruled, ruling_of
from axiscal.estimation.wrong_unit import refuse_implausible
from axiscal.exceptions import ReadingError
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.planning.proposal import Thoroughness, proposed
from axiscal.simulation import Simulator

PLACES = ("planned", "even", "random")
PRIORS = ("stated", "estimate")
_WORSE = 1.5
"""A truth of so many times the promise, without a word, is a silent failure."""
_POSES, _CANDIDATES, _MINUTE = 200, 400, 60.0
_AXIS = """
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "1000 mm"]
[errors]
EXX = { std = "STD", length = "LENGTH", knots = 21, rest = "0.3 um" }
EXX_reversal = { std = "3 um" }
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
_LASER = 'instrument = "interferometer"\ndirection = "x"\napproach = "both"\n'
_REACH = 'reach = { X = ["0 mm", "400 mm"], Y = ["0 mm", "400 mm"] }'
_PROBE = f'instrument = "probe"\ndirection = "z"\napproach = "+"\n{_REACH}\n'


@dataclass(frozen=True, slots=True)
class Attack:
    """words : what is wrong; truth : what is not as stated; field : what the machine does besides, um, along the first
    direction that is read, of place (m, q), side (m,) and a place of its own; shown : what becomes of the readings
    """

    words: str
    truth: tuple[tuple[str, str], ...] = ()
    field: Callable[[Array, Array, float], Array] = lambda x, side, place: 0.0 * side
    shown: Callable[[Array, Array, np.random.Generator], Array] = lambda values, along, rng: values
    plate: bool = False
    count: int = 24


def _bad(count: int) -> Callable[[Array, Array, np.random.Generator], Array]:
    def shown(values: Array, _along: Array, rng: np.random.Generator) -> Array:
        which = rng.choice(len(values), count, replace=False)
        wrong: Array = values + 8.0 * np.isin(np.arange(len(values)), which) * rng.choice([-1.0, 1.0], len(values))
        return wrong

    return shown


def _hump(x: Array, centre: float, width: float) -> Array:
    hump: Array = np.exp(-(((x[:, 0] - centre) / width) ** 2))
    return hump


ATTACKS = (
    Attack("nothing"),
    Attack("errors five times as large as stated", (("STD", "50 um"),)),
    Attack("errors a fifth as large", (("STD", "2 um"),)),
    Attack("five times as smooth", (("LENGTH", "1000 mm"),)),
    Attack("a fifth as smooth", (("LENGTH", "40 mm"), ("knots = 21", "knots = 51"))),
    Attack("noise five times as stated", (("NOISE", "2.5 um"),)),
    Attack("drift, 10 µm", shown=lambda v, t, rng: v + 10 * t),
    Attack("drift that levels off, 10 µm", shown=lambda v, t, rng: v + 10 * (1 - np.exp(-3 * t))),
    Attack("one bad reading, 8 µm", shown=_bad(1)),
    Attack("three bad readings, 8 µm", shown=_bad(3)),
    Attack("4 K too warm", field=lambda x, side, c: 11.7 * 4 * (x[:, 0] - 0.5)),
    Attack("step, 15 µm", field=lambda x, side, c: np.where(x[:, 0] > c, 15.0, 0.0)),
    Attack("pitch of 10 mm, 5 µm", field=lambda x, side, c: 5 * np.sin(2 * np.pi * x[:, 0] / 0.01)),
    Attack("pitch of 50 mm, 5 µm", field=lambda x, side, c: 5 * np.sin(2 * np.pi * x[:, 0] / 0.05)),
    Attack("bump of 30 mm, 12 µm", field=lambda x, side, c: 12 * _hump(x, c, 0.03)),
    Attack("reversal that varies, 8 µm", field=lambda x, side, c: 4 * side * _hump(x, c, 0.25)),
    Attack("values in mm, read as µm", shown=lambda v, t, rng: v / 1000),
    Attack("7 readings", count=7),
    Attack("sign turned", shown=lambda v, t, rng: -v),
    Attack("twist of two axes, 20 µm", field=lambda x, side, c: 20 * _twist(x), plate=True),
    Attack("sag between two axes, 20 µm", field=lambda x, side, c: 20 * _sag(x), plate=True),
)


def _twist(x: Array) -> Array:
    twist: Array = (x[:, 0] / 0.2 - 1) * (x[:, 1] / 0.2 - 1)
    return twist


def _sag(x: Array) -> Array:
    sag: Array = np.sin(np.pi * x[:, 0] / 0.4) * np.sin(np.pi * x[:, 1] / 0.4)
    return sag


@cache
def case_of(plate: bool, scales: str, changes: tuple[tuple[str, str], ...] = ()) -> Case:
    """Return an axis or a plate, as stated or with changes."""
    usual = {"STD": "10 um", "LENGTH": "200 mm", "NOISE": "0.5 um"}
    machine, setup = (_PLATE, _PROBE) if plate else (_AXIS, _LASER)
    text = f'machine = "m"\nscales = "{scales}"\n[target]\nreadings = 24\n[[setups]]\nname = "it"\n{setup}'
    text += 'noise = "NOISE"\nunknowns = { zero = "1 mm" }\ndrift = "0 um/h"\n'
    for name, value in (*changes, *usual.items()):
        machine, text = machine.replace(name, value), text.replace(name, value)
    return Case(campaign_from_texts(text, "campaign.toml", machine, "m"))


@cache
def planned(plate: bool, scales: str, count: int) -> tuple[tuple[tuple[float, ...], tuple[int, ...]], ...]:
    """Return the places that a plan asks for, in its order, with the sides."""
    made = proposed(case_of(plate, scales), Limits(count), Thoroughness(_CANDIDATES)).plan.places
    rows = zip(made.poses.tolist(), made.approaches.tolist(), strict=True)
    return tuple((tuple(pose), tuple(int(side) for side in sides)) for pose, sides in rows)


def _visits(places: str, attack: Attack, scales: str, seed: int) -> Sequence[tuple[tuple[float, ...], tuple[int, ...]]]:
    """Return where readings are taken: as planned; evenly, out and back; or anywhere, out and back."""
    if places == "planned":
        return planned(attack.plate, scales, attack.count)
    rng, count = np.random.default_rng((seed, 6)), attack.count
    if attack.plate:
        grid = np.linspace(0.02, 0.38, 5)
        spots = list(product(grid, grid)) if places == "even" else rng.uniform(0, 0.4, (25, 2)).tolist()
        return [((float(x), float(y)), (1, 1)) for x, y in spots]
    even = np.linspace(0.01, 0.99, (count + 1) // 2)
    out = even if places == "even" else np.sort(rng.uniform(0, 1, (count + 1) // 2))
    back = even if places == "even" else np.sort(rng.uniform(0, 1, count // 2))
    ways = [((float(x),), (1,)) for x in out] + [((float(x),), (-1,)) for x in back[::-1]]
    return ways[:count] if count % 2 else ways


@dataclass(frozen=True, slots=True)
class Outcome:
    """ratio : of true to promised RMS, as the headline promises it; inside : share of the volume no farther off than U

    word : the verdict
    """

    ratio: float
    inside: float
    word: str

    @property
    def silent(self) -> bool:
        """Whether it is much worse than promised, and nothing says so."""
        return self.ratio > _WORSE and self.word == "holds"


def outcome(attack: Attack, places: str, scales: str, seed: int) -> Outcome:
    """Return what one machine's readings promise, and what is true."""
    stated = case_of(attack.plate, scales)
    actual = case_of(attack.plate, scales, attack.truth)
    machine, setup = Simulator(actual.description.machine, actual.description.setups).drawn(seed), actual.description
    rng = np.random.default_rng((seed, 4))
    own, column = float(rng.uniform(0.2, 0.8)), 2 if attack.plate else 0
    visits = _visits(places, attack, scales, seed)
    poses, sides = (np.array([visit[part] for visit in visits], dtype=float) for part in (0, 1))
    read = np.array([machine.read(setup.setups[0], *visit, rng) for visit in visits]) * 1e6
    values = read + attack.field(poses, sides[:, 0], own)
    values = attack.shown(values, np.linspace(0, 1, len(values)), rng) * 1e-6
    readings = [
        Reading("it", *visit, float(value), time=_MINUTE * index)
        for index, (visit, value) in enumerate(zip(visits, values, strict=True))
    ]
    try:
        refuse_implausible([replace(each, line=1) for each in readings], stated.description, "readings")
    except ReadingError:
        return Outcome(np.nan, np.nan, "refused")
    known = ruled(concluded(stated, readings))
    ruling, alone = ruling_of(known), expanded(known.banded.case.yardstick, known.banded.knowledge.belief)
    promised = known.accuracy.rms * max(ruling.expanded.space / alone.space, 1.0)
    low, high = np.array(stated.description.target.volume).T
    where = np.random.default_rng(1).uniform(low, high, (_POSES, len(low)))
    ways = np.where(np.arange(_POSES)[:, None] % 2 == 0, 1.0, -1.0) * np.ones_like(where)
    left = machine.deviation(where, ways) - known.estimate().deviation(where, ways)
    left[:, column] += 1e-6 * attack.field(where, ways[:, 0], own)
    left -= left.mean(axis=0)
    size = np.linalg.norm(left, axis=1)
    inside = float(np.mean(size <= ruling.expanded.space))
    return Outcome(float(np.sqrt(np.mean(size**2))) / promised, inside, ruling.verdict)


def attack_rows(machines: int) -> Iterator[str]:
    """Yield the lines of the table: one for each attack, a cell for each of places and priors."""
    for attack in ATTACKS:
        cells = [_cell(attack, places, scales, machines) for places, scales in product(PLACES, PRIORS)]
        yield f"| {attack.words} | {' | '.join(cells)} |"


def _cell(attack: Attack, places: str, scales: str, machines: int) -> str:
    found = [outcome(attack, places, scales, seed) for seed in range(machines)]
    told = [each for each in found if each.word != "refused"]
    if not told:
        return "refused"
    ratio = float(np.exp(np.mean(np.log([each.ratio for each in told]))))
    inside, silent = np.mean([each.inside for each in told]), np.mean([each.silent for each in found])
    return f"{ratio:.1f}, {inside:.0%}, {silent:.0%}"
