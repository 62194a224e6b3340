"""An axis that no model of the product drew, and readings of it: a sag and two waves under a dial or a laser."""

from functools import cache

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.inheritance import case_of
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from tests.generators.texts import machine_text, setup_text

MACHINE = machine_text(
    "w-X'-b-Z-t", {"X": (0, 600), "Z": (0, 400)},
    {
        "EZX": 'std = "4 um", knots = 13, length = "150 mm", rest = "0.2 um"',
        "EXX": 'std = "10 um", knots = 13, length = "150 mm", rest = "0.4 um"',
        "EXX_reversal": 'std = "3 um"',
    },
)  # fmt: skip
DIAL = setup_text("dial", "straightedge", direction="z", moves=["X"], noise="1 um", approach="both")
LASER = setup_text("laser", "interferometer", direction="x", moves=["X"], noise="0.3 um", approach="both")


@cache
def foreign_case(setup: str) -> Case:
    """Return the case of one set-up, by its text."""
    text = f'machine = "m"\n[target]\nreadings = 40\n{setup}'
    return case_of(campaign_from_texts(text, "c.toml", MACHINE, "m"))


def foreign_readings(setup: str, count: int, seed: int, size: float = 10e-6) -> list[Reading]:
    """Return readings in four passes, two of few, of a sag and two waves of a root mean square size, m."""
    case, rng = foreign_case(setup), np.random.default_rng(seed)
    passes = np.array_split(np.arange(count), 4 if count >= 12 else 2)
    along = [np.sort(rng.uniform(0.05, 0.55, len(each)))[:: 1 if i % 2 == 0 else -1] for i, each in enumerate(passes)]
    x: Array = np.round(np.concatenate(along).astype(float), 3)
    side = np.repeat([1, -1, 1, -1][: len(passes)], [len(a) for a in along])
    a, phase = rng.normal(size=3), rng.uniform(0, 6.28, 2)

    def truth(at: Array) -> Array:
        waves = a[1] * np.sin(at / 0.095 + phase[0]) + 0.5 * a[2] * np.sin(at / 0.06 + phase[1])
        return np.asarray(a[0] * (at / 0.6) ** 2 + waves)

    shape = truth(np.linspace(0.05, 0.55, 99))
    noise = case.description.setups[0].noise
    values = size * truth(x) / shape.std() + noise * rng.normal(size=count)
    if setup is LASER:
        values += 1.5e-6 * side
    park = case.description.setups[0].park
    return [
        Reading(case.description.setups[0].name, (float(at), *park[1:]), (int(way), 0), float(value), number=i + 1)
        for i, (at, way, value) in enumerate(zip(x, side, values - values[0], strict=True))
    ]


def named(known: Estimation) -> list[tuple[str, int]]:
    """Return the mistakes that readings name, each with the index of its first reading."""
    return [(each.mistake, each.reading) for each in known.agreement.explained]
