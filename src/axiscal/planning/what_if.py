"""What if: the same machine with each set-up alone, with all of them, and measured the traditional way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from axiscal.estimation.case import Case
from axiscal.estimation.knowledge import blocks
from axiscal.exceptions import PlanError
from axiscal.measurement.instrument import values_of
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics.threads import one_thread
from axiscal.planning.plan.plan import Plan
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import Thoroughness, proposed

PLANNED = "planned, all set-ups"
TRADITIONAL = "traditional: one axis at a time, evenly spaced"


@dataclass(frozen=True, slots=True)
class Alternative:
    """One way to measure: seconds, RMS and worst after each reading, the first without any; m.

    bound : RMS that no plan of these set-ups with as many readings can beat; None where that is not known
    setups : names of those that are mounted, in order
    """

    name: str
    seconds: tuple[float, ...]
    rms: tuple[float, ...]
    worst: tuple[float, ...]
    setups: tuple[str, ...]
    bound: float | None = None

    @property
    def readings(self) -> int:
        """How many readings it takes."""
        return len(self.rms) - 1


@one_thread()
def alternatives(
    case: Case, limits: Limits, how: Thoroughness, progress: Callable[[str], None]
) -> tuple[Alternative, ...]:
    """Return the planned way first, then each instrument and each set-up alone, then the traditional way.

    The traditional way takes as many readings as the planned one. Every way is judged over the same volume, with what
    all set-ups together could see as the yardstick, and each as the best for its model.
    """
    progress(PLANNED)
    plan = proposed(case, limits, how).plan
    found = [_of_plan(case, PLANNED, plan)]
    for name, only in _choices(case):
        progress(name)
        alone = plan if tuple(only) == plan.among else _alone(case, only, limits, how)
        found += [] if alone is None else [_of_plan(case, name, alone)]
    progress(TRADITIONAL)
    return (*found, traditional(case, found[0].readings))


def _choices(case: Case) -> list[tuple[str, list[int]]]:
    """Return the instruments that several set-ups use, if there are others too, and the set-ups, if there are more."""
    setups = case.description.setups
    kinds = {kind: [i for i, s in enumerate(setups) if s.instrument == kind] for kind in (s.instrument for s in setups)}
    several = [(f"only {kind}, {len(of)} set-ups", of) for kind, of in kinds.items() if 1 < len(of) < len(setups)]
    return [*several, *((f"only {s.name}", [i]) for i, s in enumerate(setups) if len(setups) > 1)]


def _alone(case: Case, only: list[int], limits: Limits, how: Thoroughness) -> Plan | None:
    """Return the plan with some set-ups; None where they can do nothing within the limits."""
    try:
        return proposed(case, limits, how, only=only).plan
    except PlanError:
        return None


def _of_plan(case: Case, name: str, plan: Plan) -> Alternative:
    after, bounded = plan.readings, case.description.target.criterion == "volume"
    return Alternative(
        name,
        (0.0, *(r.seconds for r in after)),
        (plan.before.rms, *(r.accuracy.rms for r in after)),
        (plan.before.worst, *(r.accuracy.worst for r in after)),
        tuple(dict.fromkeys(case.description.setups[setup].name for setup in plan.places.setups)),
        case.yardstick.rms_of(plan.bound.value) if bounded and plan.bound is not None else None,
    )


def traditional(case: Case, count: int) -> Alternative:
    """Return what the same number of readings brings, shared evenly between the axes of the set-ups."""
    readings = traditional_readings(case, count)
    known, seconds = [case.yardstick.measure(case.prior)], [0.0]
    for part in blocks(case.knowledge, readings):
        known += part.accuracies(case.yardstick)
    for before, reading in zip([None, *readings], readings, strict=False):
        seconds.append(seconds[-1] + case.seconds_of(before, reading))
    rms, worst = tuple(k.rms for k in known), tuple(k.worst for k in known)
    mounted = tuple(dict.fromkeys(reading.setup for reading in readings))
    return Alternative(TRADITIONAL, tuple(seconds), rms, worst, mounted)


def traditional_readings(case: Case, count: int) -> list[Reading]:
    """Return readings evenly spaced along one axis after another, the others parked; their values are zero."""
    lines = [(setup, k) for setup in case.description.setups if setup.chart is None for k in setup.moves]
    if not lines:
        return []
    shares = [count // len(lines) + (i < count % len(lines)) for i in range(len(lines))]
    return [
        reading
        for (setup, axis), share in zip(lines, shares, strict=True)
        for reading in _line(case, setup, axis, share)
    ]


def _line(case: Case, setup: Setup, axis: int, count: int) -> list[Reading]:
    moved = case.description.machine.axes[axis]
    middle = [sum(a.travel) / 2 if k in setup.moves else setup.park[k] for k, a in enumerate(case.errors.machine.axes)]
    low, high = setup.span(moved, axis)
    step = (high - low) / max(count, 1)
    readings = []
    for i in range(count):
        pose = list(middle)
        pose[axis] = low + (i + 0.5) * step
        approach = tuple((setup.sides[0] if k in setup.moves else 0) for k in range(len(pose)))
        others = (0.0,) * (values_of(setup) - 1)
        readings.append(Reading(setup.name, tuple(pose), approach, 0.0, others=others))
    return readings
