"""What servos do to circles of a ball bar, which run at feed: axes that lag differently, reversals that come late."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from axiscal.estimation.promise.causes import turning
from axiscal.estimation.promise.mistake import NAMED, Sought, of_kinds
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import places_of, times_of
from axiscal.numerics import Array
from axiscal_core.causes import WAY, WAYS
from axiscal_core.draws import sized
from axiscal_core.problem import Problem

_ONE_WAY = 0.5
"""Share by which one way round prevails: with a quarter of circles the other way a lag is told from squareness."""


_FEED = (3.0, 30.0), (1.0, 3.0)
"""Standard deviations at feed: of a lag, noises; of what is missing of a reversal that has just turned, itself."""


class AtFeed(NamedTuple):
    """What servos do to a circle of a ball bar, which runs at feed.

    setup : its name; both : whether it went round both ways: by one way alone a lag is squareness
    lag : (1, m) m of all numbers, of a noise; late : (q, m) what is missing of reversals, of as much as is stated
    """

    setup: str
    both: bool
    lag: Array
    late: Array


def at_feed(observation: Observation, readings: Sequence[Reading]) -> Iterator[AtFeed]:
    """Yield what servos do to each circle: axes that lag differently, and reversals that come some way after the turn.

    At a feed v axes lag by v τ. Along a bar at angle φ that shows ± v Δτ sin φ cos φ, the sign that of the way round.
    """
    places, times = places_of(observation.setups, readings), np.nan_to_num(times_of(readings))
    last = np.cumsum(observation.counts[places.setups])
    for index, chosen in places.by_setup():
        setup = observation.setups[index]
        if setup.site != "bar":
            continue
        which = np.arange(len(places))[chosen]
        turns = turning(observation, index, places.poses[which], places.approaches[which])
        seen = [turn for turn in turns if np.any(turn.effects)]
        if len(seen) != 2:  # of three, on a circle
            continue
        order, numbers = np.argsort(times[which], kind="stable"), last[which] - 1
        one, other = (turn.effects[0] / np.abs(turn.effects).max() for turn in seen)
        missing = [turn.missing(places.poses[which], order, way)[0] for turn in seen for way in range(len(WAYS))]
        lag, late = np.zeros((1, last[-1])), np.zeros((len(missing), last[-1]))
        lag[0, numbers] = setup.noise * one * np.abs(other)
        late[:, numbers] = 2 / WAY * np.array(missing)
        ways = lag[0, numbers] * one * seen[0].sides * other * seen[1].sides
        yield AtFeed(setup.name, bool(abs(ways.sum()) < _ONE_WAY * np.abs(ways).sum()), lag, late)


def with_feed(problem: Problem, circles: Iterable[AtFeed]) -> Problem:
    """Return the problem with what servos do to circles, of each that is 20 times as likely with it.

    The likeliest of both, of each size, is weighed with the sizes integrated out: a large noise looks like them. Then
    both count, and a reversal is as large as stated: what a circle shows of it does not teach its size.

    circles : of `problem`
    """
    for circle in (circle for circle in circles if circle.both):
        sought, both = Sought.of(problem), [some / problem.noise for some in (circle.lag, circle.late)]
        tried = [std * some for some, stds in zip(both, _FEED, strict=True) for std in stds]
        log_odds = [sought.log_odds_of_columns(some) for some in tried]
        likeliest = tried[int(np.argmax(log_odds))]
        if max(log_odds) > 0 and _evidence(problem.wider(likeliest, "way")) > _evidence(problem) + np.log(NAMED):
            wide = problem.wider(np.vstack([max(stds) * some for stds, some in zip(_FEED, both, strict=True)]), "way")
            problem = replace(wide, size_at=np.where(of_kinds(wide, "reversal"), -1, wide.size_at))
    return problem


def _evidence(problem: Problem) -> float:
    return sized(problem).log_evidence
