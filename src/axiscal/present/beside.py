"""What instruments show that is not the tool point's: angles, where they look beside it, and servos that lag."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from axiscal.description.usual import BAD
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.promise.agreement import NAMED, PRIOR
from axiscal.estimation.promise.mistaken import as_stated_or_larger, gains_of_columns, log_odds_of
from axiscal.language.spoken import listed, said
from axiscal.measurement.instrument import instrument_of
from axiscal.present.summary import Finding
from axiscal.units import format_quantity, said_quantity

_HARDLY_TOLD = 0.5
"""Share of what was expected of angles: readings that leave more do not tell them."""


def beside_the_tool(estimation: Estimation) -> Iterator[Finding]:
    """Yield a warning for each set-up that looks beside the tool point, of angles that act there and are hardly known.

    They are expected by more than its noise, and readings have taken off less than half of that.
    """
    text = (
        '"{setup}" looks {far} beside the tool point. There {names} count as well, by ± {size} (95 %), and these '
        "readings do not tell them from what the tool point does. Read these angles with a level, or read the same "
        "places at the tool point itself."
    )
    observation, errors, printed = estimation.case.observation, estimation.case.errors, estimation.printed.belief
    for index, setup in enumerate(observation.setups):
        read = [reading.pose for reading in estimation.readings if reading.setup == setup.name]
        if not read or not any(setup.offset or ()):
            continue
        poses = np.array(read)
        at_tool = np.einsum("fmc,c->fm", errors.levers(poses), np.array(setup.direction))
        levers = observation.levers(index, poses)[0] - at_tool
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
            yield Finding("beside", None, said(text, **named))


def lagging(estimation: Estimation) -> Iterator[Finding]:
    """Yield a warning for each ball bar whose circles differ by the way round, as where two servos lag differently.

    At a feed v axes lag by v τ. Along a bar at angle φ that shows ± v Δτ sin φ cos φ, the sign that of the way round.
    """
    text = (
        'Circles of "{setup}" differ by the way round, as if one axis lagged {size} behind the other. Such a lag is no '
        "geometry, and backlash seems larger by it. Read them at a quarter of that feed: what stays is the machine."
    )
    errors, posterior = estimation.case.errors, estimation.posterior
    for index, setup in enumerate(estimation.case.description.setups):
        if instrument_of(setup).site != "bar" or posterior is None:
            continue
        problem = posterior.draws[0].problem
        of_errors = problem.rows[:, -problem.answered :] * (problem.setup == index)[:, None]
        sides = [of_errors[:, term.columns].sum(axis=1) for term in errors.functions if term.kind == "reversal"]
        moved = [side / np.abs(side).max() for side in sides if side.any()]
        if len(moved) != 2:  # of three, on a circle
            continue
        column, each = moved[0] * np.sqrt(1 - moved[0] ** 2), as_stated_or_larger(problem)  # sin φ cos φ, with its sign
        gains = [gains_of_columns(given, column[None, None], problem.values, [BAD.size])[0] for given in each]
        if log_odds_of(each, np.array(gains))[0] > math.log(NAMED / PRIOR):
            weighed = each[-1].judged(column[:, None])[:, 0]
            lag = abs(float(weighed @ problem.values / (weighed @ column))) * setup.noise
            yield Finding("lag", None, said(text, setup=setup.name, size=said_quantity(lag, "um", 2)))
