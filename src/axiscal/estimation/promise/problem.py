"""The readings of a campaign as one linear problem over their noise, as `axiscal_core.problem` has it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.promise.causes import contributions, passing_columns
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places, Reading
from axiscal.measurement.reading_rows import (
    cells_shown,
    places_of,
    seen,
    times_of,
    visited,
    with_cells,
)
from axiscal.numerics import Array
from axiscal_core.causes import WAY, cell_root
from axiscal_core.columns import Scale, priors_of
from axiscal_core.machine import Machine
from axiscal_core.problem import MOST_NUMBERS, Problem, by_blocks
from axiscal_core.splines import ramp
from axiscal_core.terms import Term
from axiscal_core.theta import MANY, Sizes

MOST_COLUMNS = 620
"""Beyond so many columns rests of the weakest errors count as noise: the cost grows with the cube.

Of 2,000 readings on five axes the true RMS is then 1.03 times the promised one, with rests three times as large 1.07.
"""


class Inherited(NamedTuple):
    """The prior of the errors where an earlier campaign left one: mean (size,), covariance (size, size)."""

    mean: Array
    covariance: Array


def problem(
    observation: Observation,
    readings: Sequence[Reading],
    sizes: Sizes,
    inherited: Inherited | None = None,
    usual: bool = True,
) -> Problem:
    """Return readings as a problem.

    observation : before any cell is visited; sizes : that vary
    usual : with what readings alone usually suffer, else with what is stated of it
    """
    sizes = replace(sizes, share=min(1.0, len(readings) / MANY))
    places = places_of(observation.setups, readings)
    clock = np.nan_to_num(times_of(readings))
    reading = np.repeat(np.arange(len(places)), observation.counts[places.setups])
    causes = contributions(observation, places, [each.values for each in readings], usual)
    type_b = np.column_stack([np.zeros((len(reading), 0)), *(each.effects for each in causes)])
    passing, lacking = passing_columns(observation, places, reading, clock, usual)
    kinds = tuple(kind for kind, _, columns in passing for _ in range(columns.shape[1]))
    start = len(kinds)
    cells = _cells(observation, places, len(reading), start + sum(shares.shape[1] for shares in lacking.values()))
    opened = with_cells(observation, cells)
    found = seen(opened, readings)
    setups, stated = places.setups[reading], np.array([each.std is not None for each in readings])[reading]
    terms = observation.errors.terms
    roots = [_root_of_cells(terms[term], np.array(own), usual) for term, own in _by_term(cells).items()]
    noise = np.sqrt(found.variances)
    names = [setup.name for setup in observation.setups]
    groups = np.where(stated, -1, sizes.indices("noise", names)[setups])
    answered = observation.errors.size + len(observation.unknowns)
    adding = [*_scales(observation.errors, lacking, inherited=inherited is not None)]
    scales = tuple(scale for _, scale, _ in adding)
    scale_size = np.array([sizes.index(scale.kind, owner) for owner, scale, _ in adding], dtype=np.intp)
    rest_size = sizes.indices("rest", [terms[term].name for term, _ in cells])
    first = start + len(cells)
    rows = np.empty((len(reading), first + len(scales) + answered))  # many readings make gigabytes: in no second copy
    rows[:, :start] = np.hstack([np.zeros((len(reading), 0)), *(columns for _, _, columns in passing)])
    rows[:, start:first] = by_blocks(found.rows[:, [opened.cells[cell] for cell in cells]], roots)
    for at, (_, scale, missing) in enumerate(adding, start=first):
        rows[:, at] = (1.0 if missing is None else 1 - missing[reading]) * (found.rows[:, scale.part] @ scale.ramp)
    own = rows[:, first + len(scales) :]
    own[:] = found.rows[:, :answered]
    stds, left = [unknown.std for unknown in observation.unknowns], None if inherited is None else inherited.covariance
    priors = priors_of(observation.errors, sizes, stds, first + len(scales), left)
    priors.apply(own, first + len(scales))
    rows /= noise[:, None]
    mean = np.zeros(answered)
    if inherited is not None:
        mean[: len(inherited.mean)] = inherited.mean
    values = (found.values - found.rows[:, :answered] @ mean) / noise
    passing_size = [np.full(columns.shape[1], sizes.index(kind, owner)) for kind, owner, columns in passing]
    size_at = np.concatenate([*passing_size, rest_size, scale_size, priors.size_at]).astype(np.intp)
    judging = np.array([not cause.row.of_values for cause in causes], dtype=bool)
    return Problem(
        rows, values, noise, reading, setups, groups, sizes, size_at, priors.curves, priors.roots, scales, answered,
        len(observation.unknowns), mean, tuple(cells), start,
        tuple(roots), kinds, type_b / noise[:, None], tuple(causes), judging,
    )  # fmt: skip


def _cells(observation: Observation, places: Places, numbers: int, others: int) -> list[tuple[int, int]]:
    """Return the cells that have a column, by error and then as they lie along it.

    Those of the errors that move readings least have none where all would be too many.
    numbers : of all readings; others : columns of what only readings suffer, and of parts of reversals
    """
    of_term = _by_term(visited(observation, places).cells)
    if numbers <= MOST_NUMBERS:
        return [(term, cell) for term, mine in of_term.items() for cell in sorted(mine)]
    effect, kept = np.zeros(len(observation.errors.terms)), list[tuple[int, int]]()
    for setup, mine in places.by_setup():
        shown = cells_shown(observation, setup, places.poses[mine])
        effect[shown.functions] += np.sum(shown.reach**2, axis=1)
    effect *= [term.rest**2 for term in observation.errors.terms]
    room = MOST_COLUMNS - observation.errors.size - len(observation.unknowns) - others
    for term in sorted(of_term, key=lambda each: (-effect[each], each)):
        if len(of_term[term]) <= room:
            kept += [(term, cell) for cell in sorted(of_term[term])]
            room -= len(of_term[term])
    return kept


def _by_term(cells: Iterable[tuple[int, int]]) -> dict[int, list[int]]:
    """Return cells by their error."""
    result = dict[int, list[int]]()
    for term, cell in cells:
        result.setdefault(term, []).append(cell)
    return result


def _root_of_cells(term: Term, cells: NDArray[np.intp], usual: bool) -> Array:
    """Return the root of the prior of cells of one error; apart if not usual.  cells : (q,)"""
    return term.rest * (cell_root(term, cells) if usual else np.eye(len(cells)))


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
