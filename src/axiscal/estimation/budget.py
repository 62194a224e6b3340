"""Where the uncertainty of the tool point comes from: the budget of an estimate, a sum of squares.

The error of an estimate is linear in all unknowns x, in the noise v of y = H x + v and in causes b of type B. With the
gain G of the readings

    x̂ − x = −(1 − G H)(x − x₀) + G v + Σ G b_j w_j,    u² = Σ of the mean squares of these over the volume

(Joseph's form; Bierman, Factorization Methods, 1977; GUM 5.1). The draws of the sizes differ in G, and each term is its
mean over them. "sizes" is by how much their estimates differ.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from axiscal.estimation.estimation import Estimation
from axiscal.estimation.promise.causes import Contribution
from axiscal.estimation.promise.posterior import Drawn
from axiscal.measurement.setup import Unknown
from axiscal.numerics import Array
from axiscal_core.theta import Kind
from axiscal_core.threads import one_thread

_PASSING: dict[Kind, str] = {"drift": "drift", "cycle": "drift", "growth": "growth", "way": "way"}


class BudgetShare(NamedTuple):
    """One source.

    kind : as reports name it; setup : whose readings they are, for "instrument"; rms : m, over the volume
    cause : what no reading shows, for "type B"
    """

    kind: str
    setup: str
    rms: float
    cause: Contribution | None = None


@one_thread()
def budget(known: Estimation) -> list[BudgetShare]:
    """Return the shares of the RMS standard uncertainty over the volume; their squares add up to its square."""
    yardstick = known.case.yardstick
    if known.posterior is None:
        parts = {"detail": yardstick.rest, "unseen": yardstick.unseen_rms**2}
        parts["prior"] = max(known.accuracy.rms**2 - sum(parts.values()), 0.0)
        return [BudgetShare(kind, "", float(np.sqrt(each))) for kind, each in parts.items()]
    figures = np.zeros((len(yardstick.root), len(known.posterior.mean)))
    figures[:, : yardstick.errors.size] = yardstick.root
    squares, whole = dict.fromkeys(_OF_ALL, 0.0), known.accuracy.rms**2
    for drawn in known.posterior.draws:
        for source, square in _squares(known, drawn, figures):
            squares[source] = squares.get(source, 0.0) + known.widening * square
    squares[_PRIOR] -= yardstick.total(known.printed.belief.factor) - (whole - yardstick.rest)
    squares[_UNSEEN] = float(np.clip(known.case.yardstick_as_sized.unseen_rms**2, 0.0, max(squares[_PRIOR], 0.0)))
    squares[_PRIOR] -= squares[_UNSEEN]
    squares["detail", "", None] += yardstick.rest
    squares["sizes", "", None] = whole - sum(squares.values())
    return [BudgetShare(kind, setup, float(np.sqrt(max(each, 0.0))), cause)
            for (kind, setup, cause), each in squares.items()]  # fmt: skip


_Source = tuple[str, str, Contribution | None]
_PRIOR: _Source = ("prior", "", None)
_UNSEEN: _Source = ("unseen", "", None)
_OF_ALL: tuple[_Source, ...] = tuple((kind, "", None) for kind in (
    "set-up", "drift", "growth", "way", "temperature", "artefact", "detail", "prior",
))  # fmt: skip


def _squares(known: Estimation, drawn: Drawn, figures: Array) -> Iterator[tuple[_Source, float]]:
    """Yield what each source leaves of figures of the answered unknowns, m².  figures : F (k, answered)"""
    problem, observation = drawn.problem, known.knowledge.observation
    found = drawn.sources(figures)
    for index, square in zip(np.unique(problem.setup).tolist(), found.setups.tolist(), strict=True):
        yield ("instrument", observation.setups[index].name, None), square
    kinds = [_PASSING[kind] for kind in problem.passing] + ["detail"] * len(problem.cells)
    kinds += ["way" if scale.kind == "way" else "prior" for scale in problem.scales]
    kinds += ["prior"] * (problem.answered - problem.unknowns) + [_kind(unknown) for unknown in observation.unknowns]
    for kind, square in zip(kinds, found.columns.tolist(), strict=True):
        yield (kind, "", None), square
    for cause, square in zip(problem.causes, found.causes.tolist(), strict=True):
        yield ("type B", "", cause), square


def _kind(unknown: Unknown) -> str:
    if unknown.name == "growth":
        return "temperature"
    return "artefact" if unknown.owner and unknown.owner != "tool" else "set-up"
