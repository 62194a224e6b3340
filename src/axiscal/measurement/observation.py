"""What an instrument sees of the machine: rows over all unknowns, A of the machine and b of the set-ups.

y = g(t)ᵀ A + f(t)ᵀ b + v (B&H eq. 29-30, and b). The columns are the machine's error coefficients, then the unknowns of
every set-up. Then follow, as they come, the rests of visited cells. Readings in one cell share its rest, so repeating
there does not average it away.

Whose an unknown is: that of one set-up, or of an artefact, a bar or a tool which several set-ups share.

What has an owner is one quantity wherever it is met: all set-ups that read the same ball share the column of its place.

Where readings are linearised: about the machine that is believed, instead of about the nominal one.

    e_i(x) = f_i(x) − h_i x,    y_i ← y_i − e_i(x)                                                (chord iteration)

f_i what the instrument would show by the exact chain where errors and unknowns are x, h_i the row of the reading. Rows
stay those of the nominal machine: each round converges by the largest rotation, about 1e-3.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.volume import deviations_of
from axiscal.measurement.artefact import Artefact
from axiscal.measurement.cells import Cell, CellColumns, RestEffects, add_rests, rest_effects
from axiscal.measurement.setup import Setup, Unknown
from axiscal.measurement.travel import belongs, feet_of
from axiscal.numerics import Array
from axiscal_core.instrument import At, Slopes
from axiscal_core.machine import Machine


def levers_of(errors: Machine, seen: Slopes, poses: Array) -> Array:
    """Return what a unit of each error adds to each number of readings, sides apart, (k, terms, m).  poses : (m, q)"""
    result = np.zeros((seen.moved.shape[1], len(errors.terms), len(poses)))
    for angular, ways in enumerate(seen):
        if ways.any():
            field = errors.levers(poses, bool(angular))
            for number, lever in enumerate(result):
                lever += np.einsum("fmc,mc->fm", field, ways[:, number])
    return result


Key = tuple[str, str]
"""Owner and name; the owner of what belongs to one set-up is that set-up."""


@dataclass(frozen=True, eq=False, slots=True)
class Owned:
    """The unknowns beside the machine's errors.

    unknowns : each of them once, in the order in which set-ups name them; columns : per set-up, where its own stand
    """

    unknowns: tuple[Unknown, ...]
    columns: tuple[NDArray[np.intp], ...]

    @classmethod
    def by(cls, setups: Sequence[Setup]) -> Owned:
        """Return the unknowns of all set-ups, shared ones once."""
        found: dict[Key, tuple[int, Unknown]] = {}
        columns = []
        for number, setup in enumerate(setups):
            keys = [(unknown.owner or f"set-up {number}", unknown.name) for unknown in setup.unknowns]
            for key, unknown in zip(keys, setup.unknowns, strict=True):
                found.setdefault(key, (len(found), unknown))
            columns.append(np.array([found[key][0] for key in keys], dtype=np.intp))
        return cls(tuple(unknown for _, unknown in found.values()), tuple(columns))


def unknowns_at(artefact: Artefact, balls: tuple[int, ...]) -> tuple[Unknown, ...]:
    """Return what set-ups at some balls of an artefact leave open of where these are."""
    each = [(artefact.balls[i].name, axis) for i in balls for axis in "xyz"]
    if artefact.calibrated is None:
        return tuple(Unknown(f"{ball}_{axis}", artefact.placed, artefact.standing) for ball, axis in each)
    whole = [Unknown(f"place_{axis}", artefact.placed, artefact.standing) for axis in "xyz"]
    whole += [Unknown(f"turn_{axis}", artefact.turned, artefact.standing) for axis in "xyz"]
    whole += [Unknown("scale", artefact.scale, artefact.name)] if artefact.scale > 0 else []
    return (*whole, *(Unknown(f"{ball}_{axis}", artefact.calibrated, artefact.name) for ball, axis in each))


class Rows(NamedTuple):
    """rows : (m, size) over all unknowns; variances : (m,) noise and the rests of cells not visited yet, m² or rad²."""

    rows: Array
    variances: Array


class JointRows(NamedTuple):
    """All numbers of readings of a set-up.  rows : (m, k, size); covariances : (m, k, k) of noise and fresh rests."""

    rows: Array
    covariances: Array


@dataclass(frozen=True, eq=False)
class Observation:
    """The linear map from all unknowns to readings.

    errors : the machine's error model; setups : in the order of the campaign
    about : (k,) errors, then unknowns of the set-ups, about which it is linear; None for the nominal machine
    cells : column of the rest of each visited cell
    """

    errors: Machine
    setups: tuple[Setup, ...]
    about: Array | None = None
    cells: Mapping[Cell, int] = field(default_factory=dict)

    @property
    def machine(self) -> Machine:
        """The machine that is read."""
        return self.errors

    @cached_property
    def size(self) -> int:
        """Number of unknowns."""
        return self.errors.size + len(self.unknowns) + len(self.cells)

    @property
    def bare(self) -> Observation:
        """The map before any cell was visited."""
        return replace(self, cells=MappingProxyType({}))

    def among(self, setups: Collection[int]) -> tuple[Observation, NDArray[np.intp]]:
        """Return the map where other set-ups have no unknowns of their own, and its columns among those here, (k,)."""
        mounted = (s if number in setups else replace(s, unknowns=()) for number, s in enumerate(self.setups))
        bare = replace(self.bare, setups=tuple(mounted))
        kept, first = np.arange(bare.size), self.bare.size
        for setup in setups:
            kept[bare.unknowns_of(setup)] = self.unknowns_of(setup)
        about = None if self.about is None else self.about[kept]
        shift = first - bare.size
        cells = {cell: column - shift for cell, column in self.cells.items()}
        return replace(bare, about=about, cells=cells), np.append(kept, np.arange(first, self.size))

    def prior_covariance(self) -> Array:
        """Return the covariance of all unknowns before the first reading, (size, size)."""
        result = np.zeros((self.size, self.size))
        result[: self.errors.size, : self.errors.size] = self.errors.covariance()
        own = [unknown.std**2 for unknown in self.unknowns]
        tail = np.arange(self.errors.size, self.size)
        result[tail, tail] = [*own, *self.bare.rest_variances(self)]
        return result

    def rest_variances(self, after: Observation) -> Array:
        """Return the prior variances of the columns that `after` has beyond this map."""
        result = np.zeros(after.size - self.size)
        for cell, column in after.cells.items():
            if cell not in self.cells:
                result[column - self.size] = self.errors.terms[cell[0]].rest ** 2
        return result

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The unknowns of all set-ups, those that several share once, in the order of their columns."""
        return self._owned.unknowns

    def prior_variances(self) -> Array:
        """Return the variances of errors and unknowns before the first reading, (errors and unknowns,)."""
        own = [unknown.std**2 for unknown in self.unknowns]
        return np.concatenate([np.diagonal(self.errors.covariance()), own])

    def unknowns_of(self, setup: int) -> NDArray[np.intp]:
        """Return the columns of one set-up's unknowns, in its order."""
        return self.errors.size + self._owned.columns[setup]

    @cached_property
    def _owned(self) -> Owned:
        return Owned.by(self.setups)

    def rows(self, setup: int, poses: Array, approaches: Array) -> Rows:
        """Return what the first number of readings of a set-up would tell (B&H eq. 29-30); arguments as of all."""
        return self.rows_each(setup, poses, approaches)[0]

    def rows_each(self, setup: int, poses: Array, approaches: Array) -> list[Rows]:
        """Return what each number of readings of a set-up would tell.  poses, approaches : (m, q)"""
        return list(map(Rows, *self._rows(setup, poses, approaches)[:2]))

    def _rows(self, setup: int, poses: Array, approaches: Array) -> tuple[Array, Array, Array]:
        """Return rows (k, m, size), variances (k, m) and levers (k, terms, m) of the numbers of each reading."""
        mounted, at = self.setups[setup], self.setups[setup].places(poses, approaches)
        levers = self._levers(setup, at)
        rows = np.zeros((len(levers), len(poses), self.size))
        rows[:, :, : self.errors.size] = self._error_rows(setup, levers, poses, approaches)
        rows[:, :, self.unknowns_of(setup)] = self.setups[setup].own_slopes(at).swapaxes(0, 1)
        variances = mounted.noise**2 + self._unknown_sides(mounted, levers, poses, approaches)
        effects = self._rest_effects(mounted, levers, poses, approaches)
        add_rests(effects, self._stated_rests[effects.functions], self.cell_columns.visited(effects), rows, variances)
        return rows, variances, levers

    def _error_rows(self, setup: int, levers: Array, poses: Array, approaches: Array) -> Array:
        standing = feet_of(self.setups[setup], poses)
        if len(standing) == 1:
            return self.errors.along(levers, poses, approaches)
        each = (weight * self.errors.along(self.levers(setup, at), at, approaches) for at, weight in standing)
        return np.asarray(sum(each))

    def numbers(self, setup: int, poses: Array, approaches: Array) -> JointRows:
        """Return what readings of a set-up would tell with all their numbers; arguments as for `rows`.

        The rest of a cell not visited yet shows in all numbers of a reading at once.
        """
        rows, variances, levers = self._rows(setup, poses, approaches)
        if len(levers) == 1:
            return JointRows(rows[0][:, None], variances[0][:, None, None])
        covariances, every = self._fresh_rests(setup, poses, approaches, levers), np.arange(len(levers))
        covariances[:, every, every] = variances.T
        return JointRows(rows.swapaxes(0, 1), covariances)

    def _fresh_rests(self, setup: int, poses: Array, approaches: Array, levers: Array) -> Array:
        """Return the covariances that rests of cells not visited yet give the numbers of each reading, (m, k, k)."""
        effects = self._rest_effects(self.setups[setup], levers, poses, approaches)
        rests = np.where(self.cell_columns.visited(effects) < 0, self._stated_rests[effects.functions][:, None], 0.0)
        reach = (effects.reach * rests).transpose(2, 0, 1)
        return reach @ reach.transpose(0, 2, 1)

    def _unknown_sides(self, mounted: Setup, levers: Array, poses: Array, approaches: Array) -> Array:
        """Return what it adds to the variances that nobody said from which side a moving axis came, (k, m) m² or rad².

        A reversal then enters with +½ or −½ of its value, as likely one as the other, at each place.
        """
        added, standing = np.zeros((len(levers), len(poses))), feet_of(mounted, poses)
        if np.all(approaches[:, list(mounted.moves)] != 0):
            return added
        if mounted.lag:
            added += np.where(np.any(approaches[:, list(mounted.moves)] == 0, axis=1), mounted.lag**2, 0.0)
        for index, function in enumerate(self.errors.curves):
            evened = mounted.mean_sides and not self.errors.axes[function.axis].rotary
            if function.kind == "reversal" and function.axis in mounted.moves and not evened:
                for at, weight in standing:
                    rows = function.spline.rows(at[:, function.axis])
                    spread = np.einsum("mi,ij,mj->m", rows, function.covariance, rows) + function.rest**2
                    shown = (weight * levers[:, index] / 2) ** 2 * spread
                    added += np.where(approaches[:, function.axis] == 0, shown, 0.0)
        return added

    def nonlinear_part(self, setup: int, poses: Array, approaches: Array) -> Array:
        """Return what each number of readings shows beside rows times unknowns, where it is not linear, (m, k)."""
        if self.about is not None:
            point = self.about
            return self.shown(setup, poses, approaches, point) - self._first_order(setup, poses, approaches, point)
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
        rows = self._error_rows(setup, self._levers(setup, at), poses, approaches)
        own: Array = self.setups[setup].own_slopes(at) @ point[self.unknowns_of(setup)]
        return own + (rows @ point[: self.errors.size]).T

    def rest_effects(self, setup: int, poses: Array, approaches: Array) -> RestEffects:
        """Return what the rests do to the numbers of readings, (k, e, m), of cells that were visited or not.

        poses, approaches : (m, q)
        """
        return self._rest_effects(self.setups[setup], self.levers(setup, poses), poses, approaches)

    def _rest_effects(self, mounted: Setup, levers: Array, poses: Array, approaches: Array) -> RestEffects:
        return rest_effects(self.errors, mounted, levers, poses, approaches, self.with_rest)

    def levers(self, setup: int, poses: Array) -> Array:
        """Return what a unit of each error adds to each number of readings, sides apart, (numbers, terms, m)."""
        return self._levers(setup, self.setups[setup].places(poses))

    def _levers(self, setup: int, at: At) -> Array:
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
    def _stated_rests(self) -> Array:
        return np.array([term.rest for term in self.errors.terms])

    @cached_property
    def cell_columns(self) -> CellColumns:
        """The columns of the rests of all cells."""
        return CellColumns(self.errors, self.with_rest, self.cells)
