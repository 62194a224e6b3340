"""Displays that froze, and right ones: which of them an estimate names as stuck."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from axiscal.estimation.estimate import estimated
from axiscal.estimation.promise.slip import repeats
from axiscal.measurement.reading import Reading
from axiscal_core.threads import one_thread
from benchmarks.reliability.trial import Trial
from tests.generators.foreign_axis import DIAL, LASER, foreign_case, foreign_readings

STEPS = (1e-7, 1e-6, 2.54e-6, 5e-6)
"""Of displays, m; one of them in ten-thousandths of an inch."""
_COUNTS, _SIZES = (9, 12, 15, 18, 28), (0.1, 0.5, 1.0, 2.0)
"""Readings, and how large the errors of a machine are beside what is stated."""
_OFF = 3.7e-6
"""m: what a display shows first. Of nothing but zeros nobody can say that it froze."""


def _shown(seed: int, step: float) -> tuple[str, list[Reading]]:
    """Return a set-up, and what its display shows of a drawn machine."""
    setup, count = (DIAL, LASER)[seed % 2], _COUNTS[seed // 2 % len(_COUNTS)]
    size = _SIZES[seed // 3 % len(_SIZES)] * (4e-6 if setup is DIAL else 10e-6)
    readings = foreign_readings(setup, count, 50_000 + seed, size)
    return setup, [replace(each, value=round(each.value / step) * step) for each in readings]


def _named(setup: str, readings: Sequence[Reading]) -> bool:
    case = foreign_case(setup)
    if not list(repeats(case.description.setups, readings)):
        return False
    return any(each.mistake == "stuck" for each in estimated(case, readings).agreement.explained)


@one_thread()
def named(count: int) -> Trial:
    """Look at right records, by each display, and at those of a display of 0.1 um that froze at once, or fifth."""
    called = [step for step in STEPS for seed in range(count) if _named(*_shown(seed, step))]
    frozen = 0
    for seed in range(count):
        setup, readings = _shown(seed, STEPS[0])
        first = (0, 4)[seed // 2 % 2]
        stuck = [replace(each, value=readings[min(i, first)].value + _OFF) for i, each in enumerate(readings)]
        frozen += _named(setup, stuck)
    told = f"of {count} displays that froze {frozen} are named"
    return Trial("right records, and an instrument is called stuck", count * len(STEPS), len(called), told)
