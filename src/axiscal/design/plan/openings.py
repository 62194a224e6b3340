"""The first readings of a plan: one of every set-up, and of every ball, that has something to be found out first.

The first reading of a ball tells little but where the ball is, and that of a set-up its zero: no gain would ever open
it. So a plan begins with one near home in each of those that it may use.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.design.gains.running_gains import Scores
from axiscal.machine.kinematics import frames
from axiscal.measurement.setup import Setup

_FRESH = 0.99
"""Share of a fresh reading's variance: where none is opened, it is one to rounding."""


class _Group(NamedTuple):
    """Candidates that find out the same thing first.  columns : of the unknowns that make it up"""

    candidates: NDArray[np.intp]
    columns: NDArray[np.intp]


def openings(scores: Scores, setups: Sequence[int], readings: int) -> list[int]:
    """Return one candidate for each set-up and ball that is not known yet, near home; none where these are too many.

    readings : so many there may be at most
    """
    groups = [group for setup in setups for group in _groups(scores, setup)]
    if len(groups) == 1 or readings < len(groups):
        return []
    return [_near_home(scores, group) for group in groups if not _known(scores, group)]


def _groups(scores: Scores, setup: int) -> Iterator[_Group]:
    mounted, lattice = scores.state.observation.setups[setup], scores.pool.lattice
    mine, columns = np.flatnonzero(lattice.setups == setup), scores.state.observation.unknowns_of(setup)
    if mounted.artefact is None or len(mounted.balls) < 2 or mounted.artefact.calibrated is not None:
        if len(columns) and len(mine):
            yield _Group(mine, columns)
        return
    at = mounted.artefact.nearest(frames(scores.state.observation.machine, lattice.poses[mine]).tcp, mounted.balls)
    for ball in mounted.balls:
        if np.any(at == ball):
            yield _Group(mine[at == ball], columns[_of_ball(mounted, mounted.artefact.balls[ball].name)])


def _of_ball(setup: Setup, ball: str) -> NDArray[np.bool_]:
    return np.array([unknown.name.rpartition("_")[0] == ball for unknown in setup.unknowns])


def _near_home(scores: Scores, group: _Group) -> int:
    """Return the candidate nearest to where the axes are parked; on a chart linear axes follow, and do not count."""
    lattice, observation = scores.pool.lattice, scores.state.observation
    setup = observation.setups[int(lattice.setups[group.candidates[0]])]
    axes = observation.machine.axes
    counted = [k for k, axis in enumerate(axes) if setup.chart is None or axis.rotary]
    spans = np.array([axes[k].length for k in counted])
    away = (lattice.poses[group.candidates][:, counted] - np.array(setup.park)[counted]) / spans
    return int(group.candidates[np.sum(away**2, axis=1).argmin()])


def _known(scores: Scores, group: _Group) -> bool:
    """Whether one of the unknowns is better known than when it was mounted."""
    state = scores.state
    variances = np.sum(state.factor[group.columns] ** 2, axis=1)
    fresh = state.observation.prior_variances()[group.columns]
    return bool(np.any(variances < _FRESH * fresh))
