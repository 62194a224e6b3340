"""Readings of a case as one linear problem, as `problem` has it.

Causes of type B take part neither in the mean nor in the sizes (Schmidt's consider form; GUM 4.3: knowledge from
elsewhere, which readings cannot improve). Whether readings agree is judged with them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from axiscal_core.causes import adding_to_curves, columns_of
from axiscal_core.columns import priors_of
from axiscal_core.model import Model
from axiscal_core.places import Readings
from axiscal_core.problem import Problem
from axiscal_core.refusals import Array
from axiscal_core.theta import MANY


def posed(case: Model, readings: Readings, about: Array | None = None) -> Problem:
    """Return readings as a problem.  about : (size,) the unknowns at which they are linear, None for zero"""
    machine, n = case.machine, case.numbers(readings, about)
    sizes = replace(case.sizes, share=min(1.0, len(readings.places) / MANY))
    values = case.values(readings, "Case.estimate") - n.shown + (0.0 if about is None else n.rows @ about)
    asked = case, readings.places, n, clock_of(case, readings)
    adding, before = [*adding_to_curves(*asked)], [*columns_of(*asked)]
    before += [(e.kind, owner, (share * (n.rows[:, e.part] @ e.ramp))[:, None]) for owner, e, share in adding]
    at = [np.full(each.shape[1], sizes.index(kind, owner)) for kind, owner, each in before]
    start, own = sum(map(len, at)), case.size
    priors = priors_of(machine, sizes, [std for each in case.instruments for std in each.own.values()], start)
    rows = np.hstack([*(each for _, _, each in before), n.rows])
    priors.apply(rows[:, start:], start)
    groups = np.full(len(n.setup), -1) if readings.std is not None else sizes.indices("noise", case.setups)[n.setup]
    kinds = tuple(kind for kind, _, each in before[: -len(adding) or None] for _ in range(each.shape[1]))
    return Problem(
        rows / n.noise[:, None], values / n.noise, n.noise, n.place, n.setup, groups, sizes,
        np.concatenate([*at, priors.size_at]).astype(np.intp), priors.curves, priors.roots,
        tuple(each for _, each, _ in adding), own,
        case.size - machine.size, np.zeros(own), (), len(kinds), (), kinds, n.type_b / n.noise[:, None],
        case.causes, np.ones(len(case.causes), dtype=bool),
    )  # fmt: skip


def clock_of(case: Model, readings: Readings) -> Array:
    """Return when each reading was taken, (m,) s: one after another where nobody looked at a clock."""
    if readings.time is not None:
        return readings.time
    return np.cumsum([case.instruments[case.setups.index(name)].costs for name in readings.places.instruments])
