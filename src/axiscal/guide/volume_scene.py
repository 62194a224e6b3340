"""The volume in space: how far the tool point is off, how well that is known, where readings are taken, and at what."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.guide.progress import coming
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames
from axiscal.numerics import Array
from axiscal.planning.promise import promised

_STEPS = 6
"""Points of the forecast; a matter of taste."""


@dataclass(frozen=True, eq=False, slots=True)
class VolumeScene:
    """Everything in the workpiece frame, m.

    points : (m, 3) over the volume; error, std : (m,) of the TCP there, without the shift that a zero takes away
    box : (n, 3) corners of the linear travels, rotary axes as near to nought as they come; edges : pairs of them
    way : (k, 3) where the readings are taken, those of `taken` first; balls : names and places of what is read at
    """

    points: Array
    error: Array
    std: Array
    box: Array
    edges: tuple[tuple[int, int], ...]
    way: Array
    taken: int
    balls: tuple[tuple[str, Array], ...]


def volume_scene(campaign: Campaign) -> VolumeScene:
    """Return the picture as the readings so far show the volume."""
    case, knowledge = campaign.known().banded
    yardstick, machine = case.yardstick, campaign.description.machine
    places, belief = yardstick.places, knowledge.belief
    deviation = yardstick.rows @ belief.mean[: case.errors.size]
    shift = deviation.mean(axis=0) if any(yardstick.zeroed) else np.zeros(3)
    square = np.sum((deviation - shift) ** 2, axis=1)
    readings = [reading.pose for reading in campaign.state.readings]
    poses = [*readings, *(place.pose for place in coming(campaign))]
    box, edges = _travels(machine)
    return VolumeScene(
        points=frames(machine, places).tcp,
        error=np.sqrt(_of_both_sides(square, len(places))),
        std=np.sqrt(_of_both_sides(yardstick.variances(belief.factor), len(places))),
        box=box,
        edges=edges,
        way=frames(machine, np.array(poses).reshape(-1, len(machine.axes))).tcp,
        taken=len(readings),
        balls=_balls(campaign),
    )


def forecast(campaign: Campaign) -> tuple[tuple[float, float], ...]:
    """Return seconds and RMS, m, after some of the readings to come, the last one among them."""
    places, (case, knowledge) = coming(campaign), campaign.known().banded
    counts = sorted({round(n) for n in np.linspace(0, len(places), _STEPS + 1)[1:]} - {0})
    return tuple((campaign.seconds(places[:n]), promised(case, knowledge, places[:n]).rms) for n in counts)


def _of_both_sides(figures: Array, count: int) -> Array:
    """Return the mean over the sides from which each of `count` places is approached.  figures : (sides · count,)"""
    means: Array = figures.reshape(-1, count).mean(axis=0)
    return means


def _travels(machine: Machine) -> tuple[Array, tuple[tuple[int, int], ...]]:
    linear = [k for k, axis in enumerate(machine.axes) if not axis.rotary]
    still = [min(max(0.0, axis.travel[0]), axis.travel[1]) for axis in machine.axes]
    corners = list(itertools.product((0, 1), repeat=len(linear)))
    poses = np.array([still] * len(corners))
    for row, corner in zip(poses, corners, strict=True):
        row[linear] = [machine.axes[k].travel[end] for k, end in zip(linear, corner, strict=True)]
    edges = tuple(
        (a, b) for a, b in itertools.combinations(range(len(corners)), 2) if _differ(corners[a], corners[b]) == 1
    )
    return frames(machine, poses).tcp, edges


def _differ(ones: Sequence[int], others: Sequence[int]) -> int:
    return sum(one != other for one, other in zip(ones, others, strict=True))


def _balls(campaign: Campaign) -> tuple[tuple[str, Array], ...]:
    setups = campaign.description.setups
    artefacts = {setup.artefact.name: setup.artefact for setup in setups if setup.artefact is not None}
    balls = [(ball.name, np.array(ball.place)) for artefact in artefacts.values() for ball in artefact.balls]
    stations = [(setup, place) for setup in setups if setup.artefact is None for place in setup.standing]
    return (*balls, *((setup.name, np.array(place)) for setup, place in stations))
