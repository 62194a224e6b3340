"""Readings of a case as one linear problem, as `problem` has it.

Causes of type B take part neither in the mean nor in the sizes (Schmidt's consider form; GUM 4.3: knowledge from
elsewhere, which readings cannot improve). Whether readings agree is judged with them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from axiscal_core.causes import adding_to_curves, columns_of
from axiscal_core.columns import Bent, Curves
from axiscal_core.eigen import unique_root
from axiscal_core.model import Model
from axiscal_core.places import Readings
from axiscal_core.problem import Problem
from axiscal_core.refusals import Array
from axiscal_core.sizes import sizes_of
from axiscal_core.splines import distances
from axiscal_core.terms import Term, covariance


def posed(case: Model, readings: Readings, about: Array | None = None) -> Problem:
    """Return readings as a problem.  about : (size,) the unknowns at which they are linear, None for zero"""
    sizes, n = sizes_of(case, len(readings.places)), case.numbers(readings, about)
    values = case.values(readings, "Case.estimate") - n.shown + (0.0 if about is None else n.rows @ about)
    asked = case, readings.places, n, clock_of(case, readings)
    adding, before = [*adding_to_curves(*asked)], [*columns_of(*asked)]
    before += [(e.kind, owner, (share * (n.rows[:, e.part] @ e.ramp))[:, None]) for owner, e, share in adding]
    at = [np.full(each.shape[1], sizes.index(kind, owner)) for kind, owner, each in before]
    own, own_at, curves, roots = _own(case, sum(map(len, at)))
    rows = np.hstack([*(each for _, _, each in before), n.rows])
    for start, root in roots:
        part = slice(start, start + len(root))
        rows[:, part] = rows[:, part] @ root
    groups = np.full(len(n.setup), -1) if readings.std is not None else sizes.indices("noise", case.setups)[n.setup]
    kinds = tuple(kind for kind, _, each in before[: -len(adding) or None] for _ in range(each.shape[1]))
    return Problem(
        rows / n.noise[:, None], values / n.noise, n.noise, n.place, n.setup, groups, sizes,
        np.concatenate([*at, own_at]).astype(np.intp), curves, roots, tuple(each for _, each, _ in adding), own,
        case.size - case.machine.size, np.zeros(own), (), len(kinds), (), kinds, n.type_b / n.noise[:, None],
        case.causes, np.ones(len(case.causes), dtype=bool),
    )  # fmt: skip


def _own(case: Model, start: int) -> tuple[int, np.ndarray, tuple[Bent, ...], tuple[tuple[int, Array], ...]]:
    """Return how many unknowns there are, the number of the θ of each, curves with a length, and roots of the others.

    start : where they begin among all columns
    """
    machine, sizes, at = case.machine, sizes_of(case), np.full(case.size, -1, dtype=np.intp)
    bent, roots = dict[tuple[int, float], list[Term]](), list[tuple[int, Array]]()
    for term in machine.curves:
        at[term.columns] = sizes.index("reversal" if term.kind == "reversal" else "std", term.name)
        if term.length is not None:
            bent.setdefault((term.spline.size, term.error.smoothness), []).append(term)
        else:  # its scale has a size of its own
            alone = covariance(replace(term.error, scale=None), term.spline)
            roots.append((start + term.columns.start, unique_root(alone)))
    others = machine.parts[len(machine.curves) :]
    roots += [(start + part.columns.start, unique_root(part.covariance)) for part in others]
    stds = [std for each in case.instruments for std in each.own.values()]
    roots += [(start + machine.size + i, np.array([[std]])) for i, std in enumerate(stds)]
    curves = tuple(
        Curves(
            start + np.array([np.arange(term.columns.start, term.columns.stop) for term in members]),
            sizes.indices("length", [term.name for term in members]), smoothness,
            np.array([term.std for term in members]), np.array([term.length for term in members], dtype=float),
            np.array([distances(term.spline) for term in members]),
        )
        for (_, smoothness), members in bent.items()
    )  # fmt: skip
    return case.size, at, curves, tuple(roots)


def clock_of(case: Model, readings: Readings) -> Array:
    """Return when each reading was taken, (m,) s: one after another where nobody looked at a clock."""
    if readings.time is not None:
        return readings.time
    return np.cumsum([case.instruments[case.setups.index(name)].costs for name in readings.places.instruments])
