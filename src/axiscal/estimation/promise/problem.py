"""The readings of a campaign as one linear problem over their noise, as `axiscal_core.problem` has it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from axiscal.estimation.promise.causes import contributions, passing_columns
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import places_of, seen, times_of
from axiscal.numerics import Array
from axiscal_core.causes import WAY, cell_root
from axiscal_core.columns import Scale, priors_of
from axiscal_core.criterion import Goal
from axiscal_core.machine import Machine
from axiscal_core.model import Numbers
from axiscal_core.normal import Normal
from axiscal_core.problem import MOST_NUMBERS, Problem
from axiscal_core.splines import ramp
from axiscal_core.state import State
from axiscal_core.theta import MANY, Sizes

MOST_COLUMNS = 620
"""Beyond so many columns rests of the weakest errors count as noise: the cost grows with the cube.

Of 2,000 readings on five axes the true RMS is then 1.03 times the promised one, with rests three times as large 1.07.
"""
_ROUNDING = 1e-12
"""A lever of this size is rounding: m/rad, 1, or rad/rad."""


def problem(
    observation: Observation,
    readings: Sequence[Reading],
    sizes: Sizes,
    inherited: Normal | None = None,
    usual: bool = True,
) -> Problem:
    """Return readings as a problem.

    observation : before any cell is visited; sizes : that vary
    inherited : the prior of the errors where an earlier campaign left one
    usual : with what readings alone usually suffer, else with what is stated of it
    """
    sizes = replace(sizes, share=min(1.0, len(readings) / MANY))
    machine, places, setups = observation.errors, places_of(observation.setups, readings), observation.setups
    reading = np.repeat(np.arange(len(places)), observation.counts[places.setups])
    causes = contributions(observation, places, [each.values for each in readings], usual)
    passing, lacking = passing_columns(observation, places, reading, np.nan_to_num(times_of(readings)), usual)
    before, start = [*passing], sum(columns.shape[1] for _, _, columns in passing)
    (found, values), roots = seen(observation, readings), list[Array]()
    opened = _cells(observation, found, start + sum(shares.shape[1] for shares in lacking.values()))
    cells = [(observation.with_rest[rest], cell) for rest, cell in opened]
    state = State(np.zeros((observation.size + len(cells), 0)), Goal(np.zeros((0, 0))), observation.rests, cells=opened)
    visited = state.wide(found)[:, observation.size :]
    for term in dict.fromkeys(term for term, _ in cells):
        mine = [number for number, (of, _) in enumerate(cells) if of == term]
        of, at = machine.terms[term], np.array([cells[each][1] for each in mine])
        roots.append(of.rest * (cell_root(of, at) if usual else np.eye(len(at))))
        before.append(("rest", of.name, visited[:, mine] @ roots[-1]))
    scales = [*_scales(machine, lacking, inherited=inherited is not None)]
    for owner, scale, missing in scales:
        share = 1.0 if missing is None else 1 - missing[reading]
        before.append((scale.kind, owner, (share * (found.rows[:, scale.part] @ scale.ramp))[:, None]))
    own, first = observation.size, start + len(cells) + len(scales)
    stds, left = [unknown.std for unknown in observation.unknowns], None if inherited is None else inherited.covariance
    priors = priors_of(machine, sizes, stds, first, left)
    rows = np.hstack([np.zeros((len(reading), 0)), *(columns for _, _, columns in before), found.rows])
    priors.apply(rows[:, first:], first)
    mean = np.zeros(own)
    mean[: 0 if inherited is None else machine.size] = 0.0 if inherited is None else inherited.mean
    noise = np.sqrt(found.noise**2 + np.sum(state.unread(found) ** 2, axis=1))
    rows /= noise[:, None]
    stated = np.array([each.std is not None for each in readings], dtype=bool)[reading]
    groups = sizes.indices("noise", [setup.name for setup in setups])[places.setups[reading]]
    sized = [np.full(columns.shape[1], sizes.index(kind, owner)) for kind, owner, columns in before]
    type_b = np.column_stack([np.zeros((len(reading), 0)), *(each.effects for each in causes)])
    return Problem(
        rows, (values - found.rows @ mean) / noise, noise, reading, places.setups[reading],
        np.where(stated, -1, groups), sizes, np.concatenate([*sized, priors.size_at]).astype(np.intp), priors.curves,
        priors.roots, tuple(scale for _, scale, _ in scales), own, len(observation.unknowns), mean, tuple(cells), start,
        tuple(roots), tuple(kind for kind, _, columns in passing for _ in range(columns.shape[1])),
        type_b / noise[:, None], tuple(causes), np.array([not cause.row.of_values for cause in causes], dtype=bool),
    )  # fmt: skip


def _cells(observation: Observation, numbers: Numbers, others: int) -> list[tuple[int, int]]:
    """Return the cells that have a column: of which rest, and their numbers along it.

    Those of the errors that move readings least have none where all would be too many.
    numbers : of all readings; others : columns of what only readings suffer, and of parts of reversals
    """
    rests, count = np.abs(numbers.reach), max(len(observation.rests), 1)
    at, column = np.nonzero(rests > _ROUNDING)
    found = np.unique(np.column_stack([column % count, numbers.cell[at, column]]), axis=0)
    if len(rests) > MOST_NUMBERS:
        of_place = np.maximum.reduceat(rests, np.flatnonzero(np.diff(numbers.place, prepend=-1)))
        effect = np.sum(of_place**2, axis=0).reshape(-1, count).sum(axis=0) * observation.rests**2
        order, each = np.argsort(-effect, kind="stable"), np.bincount(found[:, 0], minlength=count)
        room, kept = MOST_COLUMNS - observation.size - others, np.zeros(count, dtype=bool)
        for rest in order:
            kept[rest] = each[rest] <= room
            room -= each[rest] * kept[rest]
        found = found[kept[found[:, 0]]]
    return [(rest, cell) for rest, cell in found.tolist()]


def _scales(
    errors: Machine, absent: Mapping[str, Array], *, inherited: bool
) -> Iterator[tuple[str, Scale, Array | None]]:
    """Yield what adds to curves: owner, what it adds, and which share of it readings lack, (r,), None for none.

    absent : as of `passing_columns`; inherited : a belief, which has the scales of axes
    """
    for term in errors.terms:
        if not inherited and term.error.scale:
            yield term.name, Scale("scale", term.columns, term.error.scale * ramp(term.spline)), None
        for share in absent.get(term.name, np.zeros((0, 0))).T:
            yield term.name, Scale("way", term.columns, WAY * np.sqrt(np.diagonal(term.covariance))), share
