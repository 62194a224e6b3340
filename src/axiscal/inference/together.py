"""What axes do together and no sum of their curves holds: learnt as noise, and no noise.

Readings over two axes or more of which a sum of curves cannot follow all have nowhere to leave the difference but in
the noise. What is learnt beyond the stated noise, and beyond the scatter of readings repeated in one place, is then a
misfit: it counts in the bands as a rest of the error that the readings see the most of.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from axiscal.error_model.plane import PlaneError
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

_AXES = 2
"""One axis alone does nothing together."""
_MOVED = 1e-9
"""m or rad: rounding of a position, and of a lever."""


def unfollowed(observation: Observation, readings: Sequence[Reading], learnt: Mapping[str, float]) -> dict[str, float]:
    """Return the rest, m or rad, by the name of the error that is to carry it.

    learnt : root mean square of the noise by set-up, m or rad
    """
    found = dict[str, float]()
    for index, setup in enumerate(observation.setups):
        mine = [reading for reading in readings if reading.setup == setup.name and reading.std is None]
        if setup.name not in learnt or not mine:
            continue
        poses = np.array([reading.pose for reading in mine])
        beyond = learnt[setup.name] ** 2 - max(setup.noise**2, _repeated(mine))
        if beyond <= 0 or np.sum(np.ptp(poses, axis=0) > _MOVED) < _AXES:
            continue
        for name, lever in _carriers(observation, index, mine):
            found[name] = float(np.hypot(found.get(name, 0.0), np.sqrt(beyond) / lever))
    return found


def _repeated(readings: Sequence[Reading]) -> float:
    """Return the variance of readings repeated in one place, m² or rad²; 0 where there are none."""
    groups: dict[tuple[tuple[float, ...], tuple[int, ...]], list[tuple[float, ...]]] = {}
    for reading in readings:
        groups.setdefault((reading.pose, reading.approach), []).append(reading.values)
    several = [np.array(group) for group in groups.values() if len(group) > 1]
    if not several:
        return 0.0
    squares = sum(float(np.sum((group - group.mean(axis=0)) ** 2)) for group in several)
    return squares / float(sum((len(group) - 1) * group.shape[1] for group in several))


def _carriers(observation: Observation, setup: int, readings: Sequence[Reading]) -> list[tuple[str, float]]:
    """Return for each number of a reading the motion error that it sees the most of, and by which RMS lever."""
    found = []
    for direction in directions_of(observation.setups[setup]):
        levers = _levers(observation, setup, readings, direction)
        of = list(zip(observation.errors.terms, levers.tolist(), strict=True))
        term, lever = max(of, key=lambda each: (each[1], isinstance(each[0], PlaneError)), default=(None, 0.0))
        if term is not None and lever > 0:
            found.append((term.name, lever))
    return found


def _levers(observation: Observation, setup: int, readings: Sequence[Reading], direction: Array | None) -> Array:
    """Return the RMS effect of each error on readings, nought for those that are no curve of a displacement or turn."""
    poses, approaches = np.array([r.pose for r in readings]), np.array([r.approach for r in readings], dtype=float)
    effects = observation.effects(setup, poses, approaches, direction)
    terms = observation.errors.terms
    straight = np.array([isinstance(t, PlaneError) or (t.kind == "motion" and t.basis.size > 1) for t in terms])
    angular = np.array([t.angular for t in terms])
    reads_angle = bool(np.all(angular[np.any(np.abs(effects) > _MOVED, axis=1)]))
    usable = straight & (angular == reads_angle)
    levers: Array = np.sqrt(np.mean(effects**2, axis=1)) * usable
    return levers
