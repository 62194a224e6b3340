"""What readings can vouch for: the largest of the promise, of damages that they would not show, of what gaps bear, and
of what a promise needs that rests on statements.

    found = defence(case, readings, promise, stated)
    found.u_def, found.weakest, found.departures[0].damage

Everything follows from where readings were taken and when; their values do not matter.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby, takewhile

import numpy as np

from axiscal.accuracy.damage import KAPPA, Harm, bearable, hidden
from axiscal.accuracy.expanded import LEVEL
from axiscal.estimation.case import Case
from axiscal.estimation.effect_map import LARGEST_SHIFT, TOGETHER, EffectMap, prior_root
from axiscal.estimation.scatter import Scatter, open_rests, scattered
from axiscal.estimation.statements import Resting, resting, singles
from axiscal.inference.fit import drawn
from axiscal.inference.reading_set import ReadingSet
from axiscal.machine.description import Machine
from axiscal.measurement.departures import (
    COME_AND_GO,
    EVERYWHERE,
    IN_PLANS,
    Departure,
    Family,
    departures,
)
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread

COUNTED: frozenset[Family] = frozenset(
    {"drift", "levelling", "excursion", "growth", "step", "pitch", "bump", "detail", "together"}
)
"""Families that a promise must be defended against; the others are named, for the prior or the test holds them."""
OPEN = 1.25
"""What readings vouch for may be larger than their promise by a quarter before the promise counts as unchecked."""
RAISED = KAPPA / OPEN
"""A promise that would be checked so many times as large is made so large: what readings vouch for is then no more than
1.5 times what the model promises, and whether they hold does not hang on its last digit.
"""
_ANYWHERE: frozenset[Family] = frozenset({"step", "bump", "together"})
"""Families that may be anywhere, in a gap or off a line of readings too. What is narrower hides between any two."""
_BETWEEN = replace(IN_PLANS, steps=EVERYWHERE.steps)
"""Of few places a step between two readings is none."""
_MOST = 400
"""Readings that are looked at, spread over all: fewer show less, so that nothing is promised that is not held."""
_FEWEST = 3
"""Two readings fit any line."""


@dataclass(frozen=True, slots=True)
class Departed:
    """One family of departures of one set-up or error, over all places that it may be at.

    power : probability that readings show it where it makes the truth 1.5 times the promise, the mean over places
    seen_from : size that they show with 90 %, m or rad; infinite where they cannot at some place
    damage : m, what it does when it is just seen, the root mean square over places; worst : where most, m or rad
    counted : whether the promise has to be defended against it
    hidden : of a family that may be anywhere, the probability that one as large as its curve usually is makes the truth
        1.5 times the promise and is not shown; 0 where that was not asked
    bearable : m, the least promise of which that would be no more than 5 %
    """

    family: Family
    owner: str
    power: float
    seen_from: float
    damage: float
    worst: float
    counted: bool
    hidden: float = 0.0
    bearable: float = 0.0

    @property
    def least(self) -> float:
        """The least promise that can be vouched for beside it, m."""
        return max(self.damage, self.bearable) if self.counted else 0.0

    @property
    def held_from(self) -> float:
        """The least promise that is defended against it, m."""
        return max(self.damage / OPEN, self.bearable) if self.counted else 0.0

    def exceeds(self, promise: float) -> bool:
        """Return whether a promise, m, is not defended against it."""
        return self.held_from > promise


@dataclass(frozen=True, slots=True)
class Defence:
    """What readings can vouch for.

    u_def : m; promise : RMS over the volume as it is promised, m; readings : how many
    departures : the most damaging first; rests_on : statements that no reading shows, None where nothing rests on any
    scatter : a noise that they do not tell from the machine, None where they tell
    """

    u_def: float
    promise: float
    readings: int
    departures: tuple[Departed, ...]
    rests_on: Resting | None = None
    scatter: Scatter | None = None

    def promising(self, promise: float) -> Defence:
        """Return what the same readings can vouch for where a wider model promises less.  promise : m"""
        return replace(self, u_def=max(promise, self._shown, self._stated), promise=promise)

    def at_least(self, size: float) -> Defence:
        """Return it vouching for no less than a headline that is wider than the model; what is open stays so to that.

        size : m. Bands and tables are the model's then, and it is the model's promise that the verdict is about.
        """
        return replace(self, u_def=max(self.u_def, size))

    @property
    def _shown(self) -> float:
        """The least promise that can be vouched for beside what readings may not show, m."""
        return max((each.least for each in self.departures), default=0.0)

    @property
    def _stated(self) -> float:
        """The least promise that can be vouched for beside what it rests on, m."""
        return max((each.bearable for each in (self.rests_on, self.scatter) if each is not None), default=0.0)

    @property
    def held_from(self) -> float:
        """The least promise that would not be `unchecked`, m."""
        return max([self.promise, self._stated, *(each.held_from for each in self.departures)])

    @property
    def hides(self) -> bool:
        """Whether there is room for what makes the truth 1.5 times the promise, unseen."""
        return any(each.counted and each.bearable > self.promise for each in self.departures)

    @property
    def rests(self) -> bool:
        """Whether so much of the promise is as somebody stated it that one machine in fifty is far worse unseen."""
        return self._stated > self.promise

    @property
    def leaves(self) -> bool:
        """Whether readings could not have shown a departure that would make the promise much too good."""
        return any(each.exceeds(self.promise) for each in self.departures)

    @property
    def unchecked(self) -> bool:
        """Whether readings could not have shown what would make the promise much too good."""
        return self.leaves or self.rests

    @property
    def weakest(self) -> Departed | None:
        """The departure that does most damage among those that count; None where the promise is the larger."""
        counted = [each for each in self.departures if each.least > self.promise]
        return counted[0] if counted else None


@one_thread()
def defence(case: Case, readings: Sequence[Reading], promise: float, stated: Machine) -> Defence:
    """Return what readings with their times can vouch for.

    promise : RMS over the volume that they leave, m; stated : the machine before scales were learnt
    """
    chosen = drawn(readings, _MOST)
    if len(chosen) < _FEWEST:
        return vouched(case.observation, chosen, None, promise)
    numbers, root = ReadingSet(case.observation, chosen), prior_root(case)
    made = EffectMap.of_numbers(case, numbers, root)
    found = vouched(case.observation, chosen, made, promise)
    found = with_gaps(found, case.observation, chosen, made, stated)
    rests_on = _rests_on(case, numbers, root, made, (promise, stated))
    scatter = scattered(case.observation, readings, numbers, case.yardstick, open_rests(case, stated))
    return replace(found, readings=len(readings), rests_on=rests_on, scatter=scatter).promising(promise)


def _rests_on(
    case: Case, numbers: ReadingSet, root: Array, effects: EffectMap, said: tuple[float, Machine]
) -> Resting | None:
    """Return what of a promise rests on statements.

    root : (size, r) of the errors before the first reading; said : the promise, m, and the machine as it was stated
    """
    promise, stated = said
    found = list(singles(case.observation, root @ root.T, stated))
    if not found:
        return None
    columns = np.array([each.column for each in found]).T
    left = effects.left_open(numbers.rows @ columns, root, columns[: len(root)])
    model = min(case.yardstick.rms_of(effects.remaining), promise)
    return resting(found, left, model**2, promise)


def with_gaps(
    found: Defence, observation: Observation, readings: Sequence[Reading], effects: EffectMap, stated: Machine
) -> Defence:
    """Return what the same readings can vouch for with what may stay hidden between them.

    stated : the machine before scales were learnt. A curve found to be smaller says nothing of a step where it was not
    read, nor of what two axes do together where one alone was moved, so that both stay as large as stated.
    """
    possible = takewhile(lambda each: each.family != "bad", departures(observation, readings, _BETWEEN))
    told = [each for each in possible if each.family in _ANYWHERE]
    entries, open_ones = (observation.errors.machine.errors, stated.errors), {}
    for key, members in groupby(told, key=lambda each: (each.family, each.owner)):
        group = list(members)
        harms = effects.each(group)
        index = group[0].function
        assert index is not None
        own = observation.errors.functions[index].name
        std = max(entry.std for machine in entries for entry in machine if entry.name == own)
        std *= TOGETHER if key[0] == "together" else 1.0
        open_ones[key] = hidden(harms, std, found.promise), bearable(harms, std, 1 - LEVEL)
    seen = []
    for each in found.departures:
        share, least = open_ones.get((each.family, each.owner), (0.0, 0.0))
        seen.append(replace(each, hidden=share, bearable=least))
    order = tuple(sorted(seen, key=lambda each: -max(each.damage, each.bearable)))
    return replace(found, departures=order).promising(found.promise)


def vouched(
    observation: Observation, readings: Sequence[Reading], effects: EffectMap | None, promise: float
) -> Defence:
    """Return what readings with these effects can vouch for; without effects they are too few to show anything."""
    found = _unseen(observation) if effects is None else _departed(observation, readings, effects, promise)
    order = tuple(sorted(found, key=lambda each: -each.damage))
    return Defence(promise, promise, len(readings), order).promising(promise)


def _departed(
    observation: Observation, readings: Sequence[Reading], effects: EffectMap, promise: float
) -> Iterator[Departed]:
    possible = takewhile(lambda each: each.family != "bad", departures(observation, readings, IN_PLANS))
    told = [each for each in possible if each.family != "scale"]
    for _, members in groupby(told, key=lambda each: (each.family, each.owner, each.setup)):
        group = list(members)
        if group[0].family in COME_AND_GO and not any(np.any(each.columns) for each in group):
            yield _unresolved(group[0])
        else:
            yield _family(group, effects.each(group), promise)


def _family(group: Sequence[Departure], effects: Sequence[Harm], promise: float) -> Departed:
    first, damages = group[0], [each.damage for each in effects]
    return Departed(
        first.family,
        first.owner,
        float(np.mean([each.power(promise) for each in effects])),
        max(each.seen_from for each in effects),
        float(np.sqrt(np.mean(np.square(damages)))),
        group[int(np.argmax(damages))].place,
        first.family in COUNTED,
    )


def _unresolved(each: Departure) -> Departed:
    """Return what comes and goes between two times: the readings know of no other, and may be anywhere in its wave.

    The largest one then does what it does to places read one after another once along: ∫ of the squared wave about its
    mean is 1/8, of the straight line that an axis has grown by 1/12.
    """
    square = 8.0 if each.family == "excursion" else 12.0
    return Departed(each.family, each.owner, 0.0, math.inf, LARGEST_SHIFT / math.sqrt(square), each.place, counted=True)


def _unseen(observation: Observation) -> Iterator[Departed]:
    """Yield a drift of each set-up: with less than three readings nothing contradicts anything."""
    for setup in observation.setups:
        yield Departed("drift", setup.name, 0.0, math.inf, LARGEST_SHIFT / math.sqrt(12.0), 0.0, counted=True)
