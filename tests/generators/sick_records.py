"""Records of machines and instruments that no model drew, right ones and those of instruments that are sick."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.inheritance import case_of
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from tests.generators.texts import Said, artefact_text, machine_text, setup_text

MILL = machine_text(
    "w-X'-Y'-b-Z-t", {"X": (0, 600), "Y": (0, 400), "Z": (0, 300)},
    {
        "EXX EYX EZX EYY EXY": 'std = "8 um", knots = 7, length = "200 mm"',
        "EXX_reversal EYX_reversal EXY_reversal": 'std = "2 um"',
        "EC0Y": 'std = "60 urad"',
        "ECX": 'std = "20 urad", knots = 7, length = "200 mm"',
    },
)  # fmt: skip


@dataclass(frozen=True)
class Job:
    """Set-ups as text, along which axis each reads, and the steps that displays have, m or rad."""

    text: str
    along: Sequence[int]
    noise: float
    steps: Sequence[float]
    size: float


def _dial(name: str, axis: str, direction: str, **more: str) -> str:
    reach: Said = {axis: ["50 mm", "350 mm"]}
    return setup_text(name, "straightedge", direction=direction, moves=[axis], approach="both", reach=reach, **more)


JOBS = {
    "dial": Job(_dial("dial", "X", "z"), (0,), 1e-6, (1e-6, 2e-7, 1e-7), 8e-6),
    "coarse dial": Job(_dial("dial", "X", "y", noise="4 um"), (0,), 4e-6, (1e-5, 5e-6, 2e-6), 8e-6),
    "laser": Job(
        setup_text("laser", "interferometer", direction="x", moves=["X"], approach="both"),
        (0,), 0.3e-6, (1e-6, 1e-7, 1e-8, 1e-9), 8e-6,
    ),
    "autocollimator": Job(
        setup_text("mirror", "autocollimator", direction="z", moves=["X"], approach="both"),
        (0,), 0.5e-6, (1e-6, 5e-7, 1e-7), 20e-6,
    ),
    "square": Job(
        artefact_text("square", turned="1 mrad")
        + _dial("leg along X", "X", "y", artefact="square")
        + _dial("leg along Y", "Y", "x", artefact="square"),
        (0, 1), 1e-6, (1e-6, 2e-7, 1e-7), 8e-6,
    ),
}  # fmt: skip


@cache
def case_for(job: str) -> Case:
    """Return the case of a job."""
    text = f'machine = "m"\n[target]\nreadings = 40\n{JOBS[job].text}'
    return case_of(campaign_from_texts(text, "c.toml", MILL, "m"))


def _shape(rng: np.random.Generator) -> Callable[[Array], Array]:
    """Return a sag, a step in slope and two waves, of a root mean square of one over 0 to 400 mm."""
    a, b, c, d = rng.normal(size=4)
    knee, first, second = rng.uniform(0.1, 0.3), rng.uniform(0, 7, 2), rng.uniform(0.08, 0.4, 2)

    def raw(x: Array) -> Array:
        waves = c * np.sin(x / second[0] * 6.3 + first[0]) + d * np.sin(x / second[1] * 6.3 + first[1])
        return np.asarray(a * (x / 0.4) ** 2 + b * np.abs(x - knee) / 0.2 + waves)

    over = raw(np.linspace(0.05, 0.35, 99))
    return lambda x: (raw(x) - over.mean()) / over.std()


def right_record(job: str, seed: int) -> list[Reading]:
    """Return what a right display shows: of a machine a third to three times as good as stated, as for its noise."""
    rng, of, case = np.random.default_rng((seed, 18)), JOBS[job], case_for(job)
    size, noise = of.size * 3 ** rng.uniform(-1, 1), of.noise * 3 ** rng.uniform(-1, 1)
    step, passes, each = rng.choice(of.steps), int(rng.choice([2, 4])), int(rng.integers(4, 9))
    readings = list[Reading]()
    for setup, axis in zip(case.description.setups, of.along, strict=True):
        shape, zero, back = _shape(rng), rng.uniform(-3e-4, 3e-4), rng.uniform(0, 4e-6)
        slope = rng.uniform(-2e-4, 2e-4) if setup.instrument == "straightedge" else 0.0
        even = np.linspace(0.06, 0.34, each)
        for run in range(passes):
            side = 1 if run % 2 == 0 else -1
            x = np.round(even if run < 2 or rng.random() < 0.5 else np.sort(rng.uniform(0.06, 0.34, each)), 3)[::side]
            shown = size * shape(x) + slope * x + zero - side * back / 2 + noise * rng.normal(size=each)
            for at, value in zip(x.tolist(), shown.tolist(), strict=True):
                pose, sides = list(setup.park), [0] * len(setup.park)
                pose[axis], sides[axis] = at, side
                readings.append(Reading(setup.name, tuple(pose), tuple(sides), value, number=len(readings) + 1))
        if rng.random() < 0.5:  # a display that was set to zero at the first place
            first = next(each.value for each in readings if each.setup == setup.name)
            readings = [replace(r, value=r.value - first) if r.setup == setup.name else r for r in readings]
    return [replace(r, value=float(np.round(r.value / step) * step)) for r in readings]


def _by_setup(readings: Sequence[Reading], change: Callable[[list[float]], list[float]]) -> list[Reading]:
    """Return readings with the values of their last set-up changed."""
    mine = [i for i, each in enumerate(readings) if each.setup == readings[-1].setup]
    new = dict(zip(mine, change([readings[i].value for i in mine]), strict=True))
    return [replace(each, value=new.get(i, each.value)) for i, each in enumerate(readings)]


def _digit(values: Sequence[float]) -> float:
    """Return the least difference between values."""
    return float(np.diff(np.unique(values)).min())


def _flickering(values: list[float]) -> list[float]:
    flicker = np.random.default_rng(len(values)).integers(0, 2, len(values)).tolist()
    return [values[0] + _digit(values) * each for each in flicker]


SICK: dict[str, Callable[[list[float]], list[float]]] = {
    "flicker": _flickering,
    "zeros": lambda values: [0.0] * len(values),
    "late": lambda values: [values[0], *values[:-1]],
    "early": lambda values: [*values[1:], values[-1]],
    "stuck": lambda values: [*values[: len(values) // 2], *[values[len(values) // 2]] * ((len(values) + 1) // 2)],
    "repeated": lambda values: [values[i - i % 2] for i in range(len(values))],
    "in mm": lambda values: [value / 1000 for value in values],
}


def sick_record(job: str, seed: int, sick: str) -> list[Reading]:
    """Return what a sick display shows in the last set-up of a right record."""
    return _by_setup(right_record(job, seed), SICK[sick])
