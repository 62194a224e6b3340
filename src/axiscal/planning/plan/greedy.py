"""Which set-ups to use, and how many readings each is worth: greedily by gain, over sets of set-ups that grow."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import islice, takewhile

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.reading import Places
from axiscal.numerics import even_subset
from axiscal.numerics.remembered import remembered
from axiscal.planning.plan.run import first_seconds
from axiscal.planning.plan.scores import Scores
from axiscal.planning.plan.task import Clock, Limits, Task, clock
from axiscal_core.state import unexplained
from axiscal_core.ties import ALIKE, first_best

_TRIED = 150
_WORTH = 1e-3
"""Share of J that a set-up more must bring, or it is mounted for nothing."""
_SIZES = 4
"""Sets that are looked at before larger ones are made: of time where each is worth less than the one before."""
_LOOKED = 24
"""Parts that are looked at in each round at least: of time where a part takes away less than it did before."""
_ROUNDING = 1e-9
"""Share of a budget: what takes longer by less fits."""

Setups = tuple[int, ...]
_TOLD = 0.5
"""Of an unknown's variance: a reading that takes more of it away tells of little else."""


@remembered
def chosen_setups(task: Task, limits: Limits) -> Setups:
    """Return the set-ups that are worth their mounting for so many readings, by picks from a coarse lattice.

    One set of each size is tried, see `_growing`.
    """
    everything = tuple(int(s) for s in np.unique(task.lattice.setups))
    if len(everything) == 1:
        return everything
    coarse, most = task.coarse, min(limits.readings or _TRIED, _TRIED)

    def left(setups: Setups) -> float:
        return filled(scores_among(coarse, setups), most, setups).value

    return of_best_size(_growing(coarse, _parts(task, everything), limits, clock(task)), left)


def sets_within(task: Task, limits: Limits) -> Iterator[Setups]:
    """Yield sets of set-ups that grow, all of which a budget can mount and read; none where it is too short."""
    most, first = np.inf if limits.budget is None else limits.budget * (1 + _ROUNDING), first_seconds(task)

    def fits(setups: Setups) -> bool:
        return sum(first[setup] for setup in setups) <= most

    everything = tuple(setup for setup in first if fits((setup,)))
    parts = [part for part in _parts(task, everything) if fits(part)]
    sets = iter(parts) if len(parts) < 2 else _growing(task.coarse, parts, limits, clock(task))
    return takewhile(fits, sets)


def worth_most(task: Task) -> int:
    """Return the set-up of the candidate with the most gain in its time, mounting included where it is not mounted."""
    times, scores = clock(task), Scores(task.coarse)
    of = scores.lattice.setups
    return int(of[first_best(scores.gains / (times.mounting(of) + times.reading(of)), ALIKE)])


def _parts(task: Task, everything: Setups) -> list[Setups]:
    """Return each set-up alone, and those together that share an unknown, as the legs of a square do."""
    own = {setup: set(task.observation.unknowns_of(setup).tolist()) for setup in everything}
    linked = {tuple(other for other in everything if own[setup] & own[other]) for setup in everything}
    return sorted({(setup,) for setup in everything} | linked - {()})


def _growing(task: Task, parts: Sequence[Setups], limits: Limits, times: Clock) -> Iterator[Setups]:
    """Yield sets that grow part by part: by the part with which readings, dealt out evenly, leave least."""
    state, lattice = task.state, task.lattice
    every = {setup: _in_a_row(lattice, setup) for setup in np.unique(lattice.setups).tolist()}
    weighted, (rows, owner) = state.weighted, task.whitened(lattice)
    numbers = np.searchsorted(owner, np.arange(len(lattice) + 1))

    def remaining(setups: Setups) -> float:
        shares = np.array_split(np.arange(_most_readings(limits, times, setups)), len(setups))
        dealt = list[NDArray[np.intp]]()
        for turn, (setup, share) in enumerate(zip(setups, map(len, shares), strict=True)):  # each elsewhere in its row
            at = (np.arange(share) + turn / len(setups)) * len(every[setup]) / max(share, 1)
            dealt.append(every[setup][at.astype(np.intp)])
        told = [rows[numbers[index] : numbers[index + 1]] for index in np.concatenate(dealt)]
        return float(np.sum(unexplained(weighted, np.concatenate(told)) * weighted)) if told else state.value

    found: Setups = ()
    now, gained, setups_of = state.value, dict.fromkeys(parts, np.inf), task.observation.setups
    kinds = {part: tuple(replace(setups_of[setup], name="") for setup in part) for part in parts}
    while more := [part for part in parts if not {*part} <= {*found}]:
        left = dict[Setups, float]()
        one_of_each = {kinds[part]: part for part in reversed(more)}.values()
        for part in sorted(one_of_each, key=lambda part: -gained[part]):
            if len(left) >= _LOOKED and gained[part] < now - min(left.values()):
                break  # each takes away less, the more there are: no other one is likely to win
            left[part] = remaining(tuple(sorted({*found, *part})))
            gained[part] = now - left[part]
        best = min((part for part in more if part in left), key=left.__getitem__)
        found, now = tuple(sorted({*found, *best})), left[best]
        yield found


def _in_a_row(lattice: Places, setup: int) -> NDArray[np.intp]:
    """Return the candidates of a set-up in a row, of which every n-th stand for all."""
    mine = np.flatnonzero(lattice.setups == setup)
    return mine[even_subset(np.hstack([lattice.poses[mine], lattice.approaches[mine]]), len(mine))]


def of_best_size(sets: Iterable[Setups], left: Callable[[Setups], float]) -> Setups:
    """Return the best of sets that grow: every next one leaves less up to it, and hardly less behind it.

    Sets of more set-ups are made only where the largest of those there are is still worth its last part.
    """
    growing = iter(sets)

    def worth(size: int) -> bool:
        return left(known[size + 1]) < (1 - _WORTH) * left(known[size])

    known = list(islice(growing, _SIZES))
    while len(known) >= _SIZES and worth(len(known) - 2) and (more := list(islice(growing, len(known)))):
        known += more
    low, high = 0, len(known) - 1
    while low < high:
        middle = (low + high) // 2
        low, high = (middle + 1, high) if worth(middle) else (low, middle)
    return known[low]


def _most_readings(limits: Limits, times: Clock, setups: Setups) -> int:
    """Return how many readings the limits allow, but no more than are tried."""
    most = min(limits.readings or _TRIED, _TRIED)
    if limits.budget is None:
        return most
    left = limits.budget - float(times.mounting(setups).sum())
    return min(most, int(max(left, 0.0) / float(times.reading(setups).min())))


def filled(scores: Scores, readings: int, setups: Setups) -> Scores:
    """Return the gains after so many readings: those that open the set-ups, then the candidate with the most gain."""
    scores, _ = (scores, []) if len(scores.places) else openings(scores, setups, readings)
    while len(scores.places) < readings:
        scores.put(first_best(scores.gains, ALIKE))
    return scores


def scores_among(task: Task, setups: Setups) -> Scores:
    """Return the gains of the candidates of some set-ups, before the first reading of a plan."""
    return Scores(task.among(setups))


def openings(scores: Scores, setups: Sequence[int], readings: int) -> tuple[Scores, list[int]]:
    """Return the gains after readings that make known what set-ups leave open of themselves, and these candidates.

    The first reading of a set-up tells little but its zero, the next one on a square how that lies turned: no gain
    would ever open them. One unknown alone is opened by any reading.
    readings : so many there may be at most; where more are needed there are none
    """
    columns = np.unique(np.concatenate([scores.task.observation.unknowns_of(setup) for setup in setups]))
    if len(columns) < 2:
        return scores, []
    told, found = scores.telling(columns), list[int]()
    while (gains := told.gains)[best := first_best(gains, ALIKE)] > _TOLD:
        if len(found) == readings:
            return scores, []
        told.enter(best)
        found.append(best)
    ahead = scores.fork()
    for best in found:
        ahead.put(best)
    return ahead, found
