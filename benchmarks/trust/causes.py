"""Departures put into machines or their readings: are the readings said to contradict the model, and by what?"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

import numpy as np
from axiscal.inference.contradiction import SURE, compared

from axiscal.description.campaign import campaign_from_texts
from axiscal.error_model.model import ErrorModel
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.simulation import Simulator
from benchmarks.trust.kept import Trial, Tried, one_by_one

MACHINE = """
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "1000 mm"]
[errors]
EXX = { std = "10 um", length = "200 mm", rest = "0.3 um" }
EXX_reversal = { std = "3 um" }
"""
_SETUP = (
    'name = "it"\ninstrument = "interferometer"\ndirection = "x"\napproach = "both"\nnoise = "0.5 um"\ndrift = "0"\n'
)
_MINUTE = 60.0
_BAD = 7


class Attack(NamedTuple):
    """words : what is put in; names : the families that are right"""

    words: str
    names: frozenset[str]


ATTACKS = {
    "none": Attack("nothing", frozenset()),
    "drift": Attack("drift, 10 µm over the readings", frozenset({"drift", "levelling"})),
    "levelling": Attack("drift that levels off, 10 µm", frozenset({"drift", "levelling"})),
    "jump": Attack("zero set anew on the way, 8 µm off", frozenset({"jump"})),
    "step": Attack("step, 15 µm", frozenset({"step"})),
    "pitch 10": Attack("pitch of 10 mm, 5 µm", frozenset({"pitch"})),
    "pitch 33": Attack("pitch of 33 mm, in no list, 5 µm", frozenset({"pitch"})),
    "pitch 50": Attack("pitch of 50 mm, 5 µm", frozenset({"pitch"})),
    "bump": Attack("bump of 30 mm, 12 µm", frozenset({"bump", "detail", "step"})),
    "bad": Attack("one bad reading, 8 µm", frozenset({"bad"})),
}


@cache
def axis() -> Observation:
    """Return what an interferometer sees of one axis."""
    text = f'machine = "m"\n[target]\nreadings = 1\n[[setups]]\n{_SETUP}'
    described = campaign_from_texts(text, "campaign.toml", MACHINE, "m")
    return Observation(ErrorModel(described.machine), described.setups)


def attacked(observation: Observation, seed: int, count: int, attack: str = "none") -> list[Reading]:
    """Return readings out and back at random places, one a minute."""
    rng = np.random.default_rng((seed, 4))
    machine, place = Simulator(observation.errors.machine, observation.setups).drawn(seed), float(rng.uniform(0.2, 0.8))
    out, back = np.sort(rng.uniform(0, 1, count // 2)), np.sort(rng.uniform(0, 1, count - count // 2))[::-1]
    readings = []
    for index, x in enumerate(np.concatenate([out, back])):
        side = 1 if index < count // 2 else -1
        value = machine.read(observation.setups[0], (float(x),), (side,), rng) + _added(attack, index, count, x, place)
        readings.append(Reading("it", (float(x),), (side,), float(value), time=_MINUTE * index))
    return readings


def _added(attack: str, index: int, count: int, x: float, place: float) -> float:
    """Return what an attack adds to one reading, m."""
    kind, _, millimetres = attack.partition(" ")
    period = float(millimetres or 1.0) * 1e-3
    return {
        "drift": 10e-6 * index / count,
        "levelling": 10e-6 * float(1 - np.exp(-3 * index / count)),
        "jump": 8e-6 * (index > place * count),
        "step": 15e-6 * (x > place),
        "pitch": 5e-6 * float(np.sin(2 * np.pi * x / period)),
        "bump": 12e-6 * float(np.exp(-(((x - place) / 0.03) ** 2))),
        "bad": 8e-6 * (index == _BAD),
    }.get(kind, 0.0)


def said_of(trial: Trial) -> dict[str, str | None]:
    """Return the family of the likeliest cause, none where the readings do not contradict the model.

    trial : attack, count of readings, seed
    """
    attack, count, seed = trial
    observation = axis()
    found = compared(observation, attacked(observation, seed, count, attack))
    return {"family": found.explanations[0].family if found.highest >= SURE else None}


def cause_rows(machines: int, count: int, tried: Tried = one_by_one) -> Iterator[str]:
    """Yield the lines of the table.  count : readings of each machine"""
    for name, attack in ATTACKS.items():
        found = [each["family"] for each in tried(said_of, [(name, count, seed) for seed in range(machines)])]
        surely = [family for family in found if family is not None]
        right = f"{sum(each in attack.names for each in surely) / len(surely):.0%}" if attack.names and surely else "–"
        yield f"| {attack.words} | {len(surely) / machines:.0%} | {right} |"
