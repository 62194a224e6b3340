"""From readings to what is known: timed, judged, averaged over sizes, linearised where the machine is.

    known = estimated(case, readings)
    known = concluded(case, readings)

Both are the same for readings that are linear enough, as nearly all are. `concluded` also tests whether a station may
as well stand elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

from axiscal.estimation.case import Case, timed
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.judged import Doubt, judged
from axiscal.estimation.located import history, located, refuse_mirrors
from axiscal.estimation.promise.agreement import Another
from axiscal.estimation.promise.feed import at_feed, with_feed
from axiscal.estimation.promise.mistake import Explained
from axiscal.estimation.promise.posterior import sorted_out
from axiscal.estimation.promise.problem import problem
from axiscal.estimation.promise.slip import repeats
from axiscal.estimation.stations import progressed
from axiscal.language.stages import stage
from axiscal.measurement.instruments.distance import Nest
from axiscal.measurement.reading import Reading
from axiscal.record.accepted import in_workpiece
from axiscal_core.problem import Problem
from axiscal_core.threads import one_thread


@one_thread()
@stage("what the readings make known")
def estimated(stated: Case, readings: Sequence[Reading]) -> Estimation:
    """Return what readings make known while others are to follow."""
    case = stated.shown_by(readings)
    times = timed(case, readings)
    implausible = judged(case, times.readings)
    if not times.readings:
        return Estimation(stated, times, implausible, {}, history(case, ()))
    case = progressed(case, times.readings, implausible) if case.bends else case
    sure = [index for index, reading in enumerate(times.readings) if reading.accepted]
    kept = sorted_out(posed(case, times.readings), implausible, sure)
    implausible = {index: each for index, each in implausible.items() if index not in kept.judged[0].problem.reading}
    bad = {index: Doubt(index, each.z) for index, each in kept.bad.items()}
    known = located(history(case.rescaled(kept.sizes), times.readings, [*implausible, *bad]))
    at, taken = case.linear_as(known.case), known.normal
    if taken is known.readings and at.about is case.about and at.description == case.description:
        at = case
    else:
        kept = kept.where(posed(at, taken))
    again = repeats(at.description.setups, taken)
    posterior = kept.posterior(turned(at, taken), framed(at, taken), again, at.about_volume)
    return Estimation(stated, times, implausible, bad, known, posterior)


@one_thread()
def concluded(stated: Case, readings: Sequence[Reading], so_far: Estimation | None = None) -> Estimation:
    """Return what readings make known if none is to follow.

    so_far : what the same readings make known while others are to follow
    Raises AmbiguityError where a station may as well stand elsewhere.
    """
    known = so_far or estimated(stated, readings)
    refuse_mirrors(known.history, known.implausible)
    return known


def posed(case: Case, readings: Sequence[Reading]) -> Problem:
    """Return readings as a problem, linear where a case has them so.  case : with the sizes as stated"""
    plain = problem(case.observation, readings, case.sizes, case.inherited, case.description.usual)
    circles = [*at_feed(case.observation, readings)] if case.description.usual else []
    return with_feed(plain, circles) if circles else plain


def framed(case: Case, readings: Sequence[Reading]) -> Iterator[Another]:
    """Yield the readings as a problem for each set-up whose three values may be along the machine's own x, y, z.

    They are other values only where its workpiece turns from reading to reading.
    """
    machine = case.description.machine
    for index, setup in enumerate(case.description.setups):
        mine = [reading for reading in readings if reading.setup == setup.name]
        turns = any(machine.axes[k].rotary and machine.axes[k].workpiece_side for k in setup.moves)
        if mine and turns and isinstance(setup, Nest):
            yield Explained("frame", 0.0, (index,)), posed(case, in_workpiece(machine, readings, setup.name))


def turned(case: Case, readings: Sequence[Reading]) -> Iterator[Another]:
    """Yield the readings as a problem for each choice of rotary axes that count the other way than described."""
    axes = [axis.name for axis in case.description.machine.axes if axis.rotary]
    for count in range(1, len(axes) + 1):
        for chosen in combinations(axes, count):
            yield Explained("direction", 0.0, (), axes=chosen), posed(case.turned(chosen), readings)
