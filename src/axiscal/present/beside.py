"""What instruments show that is not the tool point's: angles, where they look beside it, and servos that lag."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.promise.feed import at_feed
from axiscal.language.spoken import listed
from axiscal.present.result import Finding
from axiscal.units import format_quantity, said_quantity

_HARDLY_TOLD = 0.5
"""Share of what was expected of angles: readings that leave more do not tell them."""


def beside_the_tool(estimation: Estimation) -> Iterator[Finding]:
    """Yield a warning for each set-up that looks beside the tool point, of angles that act there and are hardly known.

    They are expected by more than its noise, and readings have taken off less than half of that.
    """
    observation, errors, printed = estimation.case.observation, estimation.case.errors, estimation.printed.belief
    for index, setup in enumerate(observation.setups):
        read = [reading.pose for reading in estimation.readings if reading.setup == setup.name]
        if not read or not any(setup.offset or ()):
            continue
        poses = np.array(read)
        at_tool = np.einsum("fmc,c->fm", errors.levers(poses), np.array(setup.direction))
        levers = observation.levers(index, setup.places(poses))[0] - at_tool
        levers[[not set(setup.moves) & set(term.axes) for term in errors.terms]] = 0.0  # one value, as its zero
        rows = errors.along(levers, poses, np.zeros_like(poses))
        rows = rows - rows.mean(axis=0)
        before, after = (
            float(np.sqrt(np.mean(np.sum((rows @ factor[: errors.size]) ** 2, axis=1))))
            for factor in (estimation.case.prior.factor, printed.factor)
        )
        if after > max(setup.noise, _HARDLY_TOLD * before):
            names = [term.name for term, lever in zip(errors.terms, levers, strict=True) if np.any(lever)]
            far = format_quantity(math.dist(setup.offset or (0.0,), (0.0, 0.0, 0.0)), "mm", 2)
            size = said_quantity(BAND * after, "um", 2)
            named = {"setup": setup.name, "far": far, "names": listed(", ", names), "size": size}
            yield Finding.of("beside", **named)


def lagging(estimation: Estimation) -> Iterator[Finding]:
    """Yield a warning for each ball bar whose circles differ by the way round, as where two servos lag differently.

    Also where they go one way round: there such a lag is no other than squareness.
    """
    for circle in at_feed(estimation.case.observation, estimation.readings):
        if not circle.both:
            yield Finding.of("lag_once", code="lag", setup=circle.setup)
    if estimation.posterior is None:
        return
    problem, setups = estimation.posterior.draws[0].problem, estimation.case.description.setups
    passing = np.arange(len(problem.passing))
    servo = passing[(np.array(problem.passing) == "way") & (problem.size_at[passing] < 0)]
    for setup in np.unique(problem.setup[np.any(problem.rows[:, servo] != 0, axis=1)]).tolist():
        yield Finding.of("lag", setup=setups[setup].name)
