"""What an instrument sees of the machine: rows over all unknowns, A of the machine and b of the set-ups.

y = g(t)ᵀ A + f(t)ᵀ b + v (B&H eq. 29-30, and b). The columns are the machine's error coefficients, then the unknowns of
every set-up. Beside them are rests: an error's part that splines miss, one number in each short cell. Readings in one
cell share its rest, so repeating there does not average it away; `axiscal_core.state.State` has those of visited cells.

What has an owner is one quantity wherever it is met: all set-ups that read the same ball share the column of its place.

Where readings are linearised: about the machine that is believed, instead of about the nominal one.

    e_i(x) = f_i(x) − h_i x,    y_i ← y_i − e_i(x)                                                (chord iteration)

f_i what the instrument would show by the exact chain where errors and unknowns are x, h_i the row of the reading. Rows
stay those of the nominal machine: each round converges by the largest rotation, about 1e-3.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.kinematics import Deviation, actual_deviation, composed
from axiscal.measurement.reading import Places
from axiscal.measurement.setup import Setup, Unknown
from axiscal.measurement.travel import belongs, feet_of
from axiscal.numerics import Array
from axiscal_core.instrument import At, Slopes
from axiscal_core.machine import Machine
from axiscal_core.model import Numbers


def levers_of(errors: Machine, seen: Slopes, poses: Array) -> Array:
    """Return what a unit of each error adds to each number of readings, sides apart, (k, terms, m).  poses : (m, q)"""
    result = np.zeros((seen.moved.shape[1], len(errors.terms), len(poses)))
    for angular, ways in enumerate(seen):
        if ways.any():
            field = errors.levers(poses, bool(angular))
            for number, lever in enumerate(result):
                lever += np.einsum("fmc,mc->fm", field, ways[:, number])
    return result


def owned(setups: Sequence[Setup]) -> tuple[tuple[Unknown, ...], tuple[NDArray[np.intp], ...]]:
    """Return the unknowns of all set-ups, shared ones once, as set-ups name them; and where those of each stand."""
    found, columns = dict[tuple[str, str], tuple[int, Unknown]](), list[NDArray[np.intp]]()
    for number, setup in enumerate(setups):
        keys = [(unknown.owner or f"set-up {number}", unknown.name) for unknown in setup.unknowns]
        for key, unknown in zip(keys, setup.unknowns, strict=True):
            found.setdefault(key, (len(found), unknown))
        columns.append(np.array([found[key][0] for key in keys], dtype=np.intp))
    return tuple(unknown for _, unknown in found.values()), tuple(columns)


_AT_ONCE = 8000
"""Poses whose deviations are found together: of memory, not of the result."""


def deviations_of(model: Machine, machines: Array, poses: Array, approaches: Array) -> Iterator[Deviation]:
    """Yield how the tools of many machines deviate by the exact chain.  machines : (n, size) of coefficients"""
    at_once = max(_AT_ONCE // max(len(poses), 1), 1)
    rows = [term.rows(*term.at(poses)) for term in model.terms]
    for start in range(0, len(machines), at_once):
        some = machines[start : start + at_once]
        values = [own @ some[:, term.columns].T for own, term in zip(rows, model.terms, strict=True)]
        shape = len(model.terms), len(poses), len(some)
        moved = np.array(values).reshape(shape).swapaxes(1, 2).reshape(shape[0], -1)
        small = composed(model, moved, np.tile(approaches, (len(some), 1)))
        done = actual_deviation(model, np.tile(poses, (len(some), 1)), small)
        straight, turned = (part.reshape(len(some), len(poses), 3) for part in done)
        yield from (Deviation(*each) for each in zip(straight, turned, strict=True))


@dataclass(frozen=True, eq=False)
class Observation:
    """The linear map from all unknowns to readings.

    errors : the machine's error model; setups : in the order of the campaign
    about : (k,) errors, then unknowns of the set-ups, about which it is linear; None for the nominal machine
    """

    errors: Machine
    setups: tuple[Setup, ...]
    about: Array | None = None

    @property
    def machine(self) -> Machine:
        """The machine that is read."""
        return self.errors

    @cached_property
    def size(self) -> int:
        """Number of unknowns."""
        return self.errors.size + len(self.unknowns)

    def among(self, setups: Collection[int]) -> tuple[Observation, NDArray[np.intp]]:
        """Return the map where other set-ups have no unknowns of their own, and its columns among those here, (k,)."""
        mounted = (s if number in setups else replace(s, unknowns=()) for number, s in enumerate(self.setups))
        found = replace(self, setups=tuple(mounted))
        kept = np.arange(found.size)
        for setup in setups:
            kept[found.unknowns_of(setup)] = self.unknowns_of(setup)
        return replace(found, about=None if self.about is None else self.about[kept]), kept

    def prior_covariance(self) -> Array:
        """Return the covariance of all unknowns before the first reading, (size, size)."""
        result = np.diag([0.0] * self.errors.size + [unknown.std**2 for unknown in self.unknowns])
        result[: self.errors.size, : self.errors.size] = self.errors.covariance()
        return result

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The unknowns of all set-ups, those that several share once, in the order of their columns."""
        return self._owned[0]

    def unknowns_of(self, setup: int) -> NDArray[np.intp]:
        """Return the columns of one set-up's unknowns, in its order."""
        return self.errors.size + self._owned[1][setup]

    @cached_property
    def _owned(self) -> tuple[tuple[Unknown, ...], tuple[NDArray[np.intp], ...]]:
        return owned(self.setups)

    @cached_property
    def counts(self) -> NDArray[np.intp]:
        """How many numbers a reading of each set-up has, (setups,)."""
        return np.array([len(setup.names) for setup in self.setups], dtype=np.intp)

    def numbers(self, places: Places) -> Numbers:
        """Return what readings at places would tell (B&H eq. 29-30)."""
        each = self.counts[places.setups]
        first, place = np.cumsum(each) - each, np.repeat(np.arange(len(places)), each)
        rows, noise = np.zeros((len(place), self.size)), np.zeros(len(place))
        standing = max((len(feet_of(self.setups[i], places.poses[:0])) for i, _ in places.by_setup()), default=1)
        reach = np.zeros((len(place), standing * len(self.with_rest)))
        cell = np.zeros(reach.shape, dtype=np.intp)
        for index, mine in places.by_setup():
            setup, poses, approaches = self.setups[index], places.poses[mine], places.approaches[mine]
            at, to = setup.places(poses, approaches), first[mine][:, None] + np.arange(self.counts[index])
            levers = self.levers(index, at)
            rows[to, : self.errors.size] = self._error_rows(index, levers, poses, approaches).swapaxes(0, 1)
            rows[to[:, :, None], self.unknowns_of(index)] = setup.own_slopes(at)
            noise[to] = np.sqrt(setup.noise**2 + self._unknown_sides(setup, levers, poses, approaches)).T
            effects, cells = self._rests(setup, levers, poses, approaches)
            reach[to, : len(cells)], cell[to, : len(cells)] = effects.transpose(2, 0, 1), cells.T[:, None]
        part, nought = np.arange(len(place)) - first[place], np.zeros(len(place))
        return Numbers(rows, nought, reach, cell, noise, place, places.setups[place], part, nought[:, None][:, :0])

    def variances(self, n: Numbers) -> Array:
        """Return the variances of numbers, noise and rests, (n,) m² or rad²."""
        rests = np.tile(self.rests, n.reach.shape[1] // max(len(self.rests), 1))
        return np.asarray(n.noise**2 + np.sum((n.reach * rests) ** 2, axis=1))

    def _error_rows(self, index: int, levers: Array, poses: Array, approaches: Array) -> Array:
        """Return the rows of the errors, (k, m, errors)."""
        setup = self.setups[index]
        standing = feet_of(setup, poses)
        if len(standing) == 1:
            return self.errors.along(levers, poses, approaches)
        felt = ((weight, self.levers(index, setup.places(at)), at) for at, weight in standing)
        return np.asarray(sum(weight * self.errors.along(each, at, approaches) for weight, each, at in felt))

    def _unknown_sides(self, mounted: Setup, levers: Array, poses: Array, approaches: Array) -> Array:
        """Return what it adds to the variances that nobody said from which side a moving axis came, (k, m) m² or rad².

        A reversal then enters with +½ or −½ of its value, as likely one as the other, at each place.
        """
        added, standing = np.zeros((len(levers), len(poses))), feet_of(mounted, poses)
        if np.all(approaches[:, list(mounted.moves)] != 0):
            return added
        for index, function in enumerate(self.errors.curves):
            evened = mounted.mean_sides and not self.errors.axes[function.axis].rotary
            if function.kind == "reversal" and function.axis in mounted.moves and not evened:
                for at, weight in standing:
                    rows = function.spline.rows(at[:, function.axis])
                    spread = np.einsum("mi,ij,mj->m", rows, function.covariance, rows) + function.rest**2
                    shown = (weight * levers[:, index] / 2) ** 2 * spread
                    added += np.where(approaches[:, function.axis] == 0, shown, 0.0)
        return added

    def _rests(self, mounted: Setup, levers: Array, poses: Array, approaches: Array) -> tuple[Array, NDArray[np.intp]]:
        """Return what a unit of each rest adds to each number, (k, e, m), and in which cell it is, (e, m).

        Those of each foot stand behind those of the other.  levers : (k, terms, m)
        """
        functions, standing = np.array(self.with_rest, dtype=np.intp), feet_of(mounted, poses)
        effects = self.errors.effects(levers, approaches)[:, functions] if len(functions) else levers[:, :0]
        effects = effects * (mounted.base != 0)  # a base without length is refused where its way has a rest
        firsts = self.errors.firsts[functions]  # errors with the same cells have them once
        terms = {i: self.errors.terms[i] for i in {*firsts.tolist()}}
        found = [{i: term.cells(*term.at(foot.poses)) for i, term in terms.items()} for foot in standing]
        cells = np.array([each[i] for each in found for i in firsts.tolist()], dtype=np.intp).reshape(-1, len(poses))
        return np.concatenate([foot.weight * effects for foot in standing], axis=1), cells

    def nonlinear_part(self, setup: int, poses: Array, approaches: Array) -> Array:
        """Return what each number of readings shows beside rows times unknowns, where it is not linear, (m, k)."""
        if self.about is not None:
            shown = self.shown(setup, poses, approaches, self.about)
            return shown - self._first_order(setup, poses, approaches, self.about)
        mounted = self.setups[setup]
        at, found = mounted.places(poses), mounted.found_at
        linear: Array = mounted.own_slopes(at, [*found]) @ np.array([*found.values()])
        return mounted.shown(at, found) - linear

    def shown(self, setup: int, poses: Array, approaches: Array, point: Array) -> Array:
        """Return what each number of readings would show, nothing linearised, (m, k).

        point : (k,) errors, then unknowns; feet on a way see it to first order only
        """
        return next(self.shown_by_each(setup, poses, approaches, point[None]))

    def shown_by_each(self, setup: int, poses: Array, approaches: Array, points: Array) -> Iterator[Array]:
        """Yield the same for each of many machines and set-ups.  points : (n, k) errors, then unknowns"""
        mounted = self.setups[setup]
        if mounted.base is not None:
            yield from (self._first_order(setup, poses, approaches, point) for point in points)
            return
        at, names = mounted.places(poses, approaches), [unknown.name for unknown in mounted.unknowns]
        standing, machines = feet_of(mounted, poses), points[:, : self.errors.size]
        weights = np.array([foot.weight for foot in standing])
        done = (deviations_of(self.errors, machines, foot.poses, approaches) for foot in standing)
        for point, *actual in zip(points, *done, strict=True):
            moved, turned = (np.tensordot(weights, each, axes=1) for each in zip(*actual, strict=True))
            there = at._replace(moved=moved, turned=turned)
            own = point[self.unknowns_of(setup)].tolist()
            yield mounted.shown(there, dict(zip(names, own, strict=True)))

    def _first_order(self, setup: int, poses: Array, approaches: Array, point: Array) -> Array:
        """Return the rows of each number of readings times errors and unknowns, (m, k)."""
        at = self.setups[setup].places(poses, approaches)
        rows = self._error_rows(setup, self.levers(setup, at), poses, approaches)
        own: Array = self.setups[setup].own_slopes(at) @ point[self.unknowns_of(setup)]
        return own + (rows @ point[: self.errors.size]).T

    def levers(self, setup: int, at: At) -> Array:
        """Return what a unit of each error adds to each number of readings, sides apart, (numbers, terms, m)."""
        mounted = self.setups[setup]
        levers = levers_of(self.errors, mounted.slopes(at), at.poses)
        if mounted.base is not None:  # what stands on a way sees no other axis, and no carriage
            levers *= np.array([belongs(term, mounted.moves[0]) for term in self.errors.terms])[:, None]
        return levers

    @cached_property
    def with_rest(self) -> tuple[int, ...]:
        """The indices of the errors that have a rest."""
        return tuple(i for i, function in enumerate(self.errors.terms) if function.rest > 0)

    @cached_property
    def rests(self) -> Array:
        """The standard deviations of these, (e,) m or rad."""
        return np.array([self.errors.terms[i].rest for i in self.with_rest])
