"""What readings suffer beside the errors of the machine: drift, growth, what a reversal lacks yet, causes of type B.

How much passes says `axiscal_core.causes`. Without what usually goes wrong a zero wanders as stated, and no more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.measurement.travel import feet_of
from axiscal.measurement.type_b import Read, TypeB
from axiscal.numerics import Array
from axiscal_core.causes import WAY, WAYS, OfOneSetup, absent, drift
from axiscal_core.eigen import of_rank
from axiscal_core.theta import Kind


def passing_columns(
    observation: Observation, places: Places, reading: NDArray[np.intp], clock: Array, usual: bool = True
) -> tuple[list[tuple[Kind, str, Array]], dict[str, Array]]:
    """Return the columns of what only readings suffer, and which share of each part of a reversal they miss.

    The shares by its name, (readings, ways).  reading : (m,) of each number, ascending; clock : (r,) s
    usual : with what usually goes wrong; else zeros wander as stated and nothing besides
    """
    found, lacking = list[tuple[Kind, str, Array]](), dict[str, Array]()
    for index, chosen in places.by_setup():
        setup, which = observation.setups[index], np.arange(len(places))[chosen]
        mine = np.flatnonzero(np.isin(reading, which))
        of, part = np.searchsorted(which, reading[mine]), mine - np.searchsorted(reading, reading[mine])
        sigma = np.full(len(mine), setup.noise)
        read = OfOneSetup(setup.name, len(reading), mine, part, clock[reading[mine]], sigma, setup.drift)
        if usual:
            poses, order, open_yet = places.poses[which], np.argsort(clock[which], kind="stable"), []
            for turn in turning(observation, index, poses, places.approaches[which]):
                missing, unsure = turn.absent(poses, order)
                lacking.setdefault(turn.name, np.zeros((len(places), len(WAYS))))[which] = missing
                open_yet.append((turn.name, WAY * turn.effects[part, of, None] * unsure[of]))
            found += read.passing((axis[part, of] for axis in growing(observation, index, poses)), open_yet)
        elif setup.drift > 0:
            ways = (of_rank(drift(read.clock[zero], 0.0, setup.drift)) for zero in read.zeros)
            found += (("drift", setup.name, read.wide(*each)) for each in zip(read.zeros, ways, strict=True))
    return found, lacking


def growing(observation: Observation, index: int, poses: Array) -> list[Array]:
    """Return what growth by one does to each number of readings of a set-up, (k, r), for each axis that may grow.

    A linear axis may if it moves in the set-up and its positions are an error.  poses : (r, q)
    """
    machine, levers, found = observation.machine, None, list[Array]()
    for k in observation.setups[index].moves:
        axis = machine.axes[k]
        term = next((i for i, t in enumerate(observation.errors.terms) if t.name == axis.positioning_error), None)
        if term is None or axis.rotary:
            continue
        levers = observation.levers(index, observation.setups[index].places(poses)) if levers is None else levers
        away = ((at[:, k] - np.mean(axis.travel), weight) for at, weight in feet_of(observation.setups[index], poses))
        along = sum(weight * far for far, weight in away) / axis.length
        found.append(np.array([lever[term] * along for lever in levers]))
    return found


@dataclass(frozen=True, eq=False)
class Turning:
    """A reversal of a linear axis that may need a way to be complete.

    name : of the error; axis : k; overrun : m, that the axis has come since it turned where it comes from another side
    sides : (r,) from where it comes; effects : (k, r) what one standard deviation does to each number when it is whole
    """

    name: str
    axis: int
    overrun: float
    sides: Array
    effects: Array

    def missing(self, poses: Array, order: NDArray[np.intp], way: int = 1) -> Array:
        """Return what is missing of each number of readings, (k, r) m or rad.

        poses : (r, q); order : (r,) in which they are taken; way : which of the parts it is
        """
        missing: Array = -WAY * self.absent(poses, order)[0, :, way] * self.effects
        return missing

    def absent(self, poses: Array, order: NDArray[np.intp]) -> Array:
        """Return what `axiscal_core.causes.absent` says, (2, r, ways).  poses : (r, q); order : (r,)"""
        return absent(poses[:, self.axis], self.sides, order, self.overrun)


def turning(observation: Observation, index: int, poses: Array, approaches: Array) -> list[Turning]:
    """Return the reversals of linear axes that readings of a set-up from both sides show.

    poses, approaches : (r, q)
    """
    setup, levers, found = observation.setups[index], None, list[Turning]()
    for number, term in enumerate(observation.errors.curves if len(setup.sides) > 1 else ()):
        if term.axis in setup.moves and term.kind == "reversal" and term.linear:
            levers = observation.levers(index, setup.places(poses)) if levers is None else levers
            sides, overrun = approaches[:, term.axis], observation.machine.axes[term.axis].overrun
            effects = 0.5 * float(np.sqrt(term.covariance[0, 0])) * sides * levers[:, number]
            found.append(Turning(term.name, term.axis, overrun, sides, effects))
    return found


@dataclass(frozen=True, eq=False)
class Contribution:
    """One cause that is there.

    owner : the set-up or instrument whose readings share it, "" for all; stated : whether its size is no default
    effects : what one standard deviation does to each number of the readings, (m,) m or rad
    """

    row: TypeB
    owner: str
    stated: bool
    effects: Array


def contributions(
    observation: Observation, places: Places, values: Sequence[tuple[float, ...]] | None = None, usual: bool = True
) -> list[Contribution]:
    """Return the type B contributions, causes without effect left out.

    values : of each reading, m or rad; None before they are read; usual : with sizes that nobody stated
    """
    found, each = dict[tuple[str, str], Contribution](), observation.counts[places.setups]
    first = np.cumsum(each) - each
    for index, chosen in places.by_setup():
        setup, mine = observation.setups[index], np.arange(len(places))[chosen]
        at = setup.places(places.poses[chosen], places.approaches[chosen])
        ways = setup.slopes(at).moved.swapaxes(0, 1)
        shown = np.zeros(ways.shape[:2]) if values is None else np.array([values[i] for i in mine], dtype=float).T
        read = Read(setup, at, ways, shown)
        owners = {"set-up": setup.name, "instrument": setup.instrument, "machine": ""}
        for row in setup.type_b:
            stated, key = row.name in dict(setup.stated), (row.name, owners[row.shared])
            if not row.met(setup) or not (usual or stated):
                continue
            before = found.get(key, Contribution(row, key[1], True, np.zeros(each.sum())))
            for number, effect in enumerate(row.column(read)):
                before.effects[first[mine] + number] += effect
            found[key] = replace(before, stated=stated and before.stated)
    return [each for each in found.values() if np.any(each.effects)]
