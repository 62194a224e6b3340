"""One axis of a metre, a laser whose zero is open, and readings of it out and back: for the tests of verdicts."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.numerics import Array
from tests.generators.texts import machine_text

MACHINE = machine_text(
    "w-b-X-t",
    {"X": (0, 1000)},
    {"EXX": 'std = "10 um", length = "200 mm", knots = 21, rest = "0.3 um"', "EXX_reversal": "3 um"},
)
CAMPAIGN = """machine = "m"
[target]
rms = "3 um"
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
noise = "0.5 um"
approach = "both"
unknowns = { zero = "1 mm" }
drift = "0 um/h"
"""
CASE = Case(campaign_from_texts(CAMPAIGN, "c.toml", MACHINE, "m"))


def machine(seed: int) -> VirtualMachine:
    """Return a machine drawn from the prior."""
    return Simulator(CASE.description.machine, CASE.description.setups).drawn(seed)


def read(drawn: VirtualMachine, count: int) -> list[Reading]:
    """Return readings out and back, unevenly, one a minute; one side on each way."""
    rng, setup = np.random.default_rng(7), CASE.description.setups[0]
    along = np.linspace(0.005, 0.995, count) + 4e-3 * np.sin(3.0 * np.arange(count))
    order = [(float(x), 1) for x in along[::2]] + [(float(x), -1) for x in along[1::2][::-1]]
    return [
        Reading("laser", (x,), (side,), drawn.read_all(setup, (x,), (side,), rng)[0], time=60.0 * index)
        for index, (x, side) in enumerate(order)
    ]


def closed(taken: list[Reading]) -> list[Reading]:
    """Return readings out and back, and then one half way and one at the turn once more: nothing comes and goes."""
    out, (before, last) = [each for each in taken if each.approach == (1,)], taken[-2:]
    apart = (last.time or 0.0) - (before.time or 0.0)
    again = [
        replace(each, time=(last.time or 0.0) + apart * i) for i, each in enumerate([out[len(out) // 2], out[-1]], 1)
    ]
    return [*taken, *again]


def plus(readings: Sequence[Reading], added: Sequence[float] | Array) -> list[Reading]:
    """Return readings with something added to each."""
    return [replace(each, value=each.value + float(more)) for each, more in zip(readings, added, strict=True)]
