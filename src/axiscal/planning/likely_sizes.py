"""Sizes and lengths that errors may have: a plan is good for all of them, not for one size.

Before the first reading they are drawn from what is stated, lengths within 0.2 to 1 of the travel. Readings draw them
from their posterior; fewer than ten teach no length that a plan may trust, so lengths are then drawn as before.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from axiscal.description.usual import TEACH_LENGTHS, Kind, Size
from axiscal.estimation.accuracy.criterion import Root
from axiscal.estimation.case import Case
from axiscal.estimation.promise.posterior import Drawn
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array, even_points
from axiscal.numerics.from_scipy import normal_quantile, normal_share
from axiscal.planning.gains.covariance import Covariance

COUNT = 8
"""Draws of the sizes."""
_KINDS: frozenset[Kind] = frozenset({"std", "length", "together"})
"""What errors are like along their axes; of the others one size is as good as another for where to read."""
_LENGTHS = (0.2, 1.0)
"""Shares of the travel within which lengths are drawn, wider where the stated one lies outside."""
_MOST = 400
"""Unknowns up to which sizes are drawn: each draw costs as much as one size, and a person waits at the machine."""


def likely_states(
    case: Case, root: Root, readings: Sequence[Reading] = (), drawn: Sequence[Drawn] = ()
) -> tuple[Covariance, ...]:
    """Return what is known after readings at each of several sizes; none where sizes are known, or unknowns are many.

    root : V of the criterion; readings : that count; drawn : of their posterior
    """
    stated = case if case.sized_from is None else case.sized_from.linear_as(case)
    sizes = stated.sizes.of
    if not any(size.kind in _KINDS for size in sizes) or case.observation.size > _MOST:
        return ()
    thetas = _before(stated)
    if drawn:
        lengths = np.array([size.kind == "length" for size in sizes])
        taught = _resampled(drawn[0])
        thetas = np.where(lengths, thetas, taught) if len(readings) < TEACH_LENGTHS else taught
    found = []
    for theta in thetas:
        known = stated.rescaled(_factors(stated, theta)).knowledge.read(readings)
        found.append(Covariance.from_factor(known.observation, known.belief.factor, root))
    return tuple(found)


def _before(stated: Case) -> Array:
    """Return the logarithms of sizes before any reading, evenly over what is likely, (draws, k)."""
    sizes = stated.sizes
    thetas = np.zeros((COUNT, len(sizes)))
    varied = [index for index, size in enumerate(sizes.of) if size.kind in _KINDS]
    for index, shares in zip(varied, even_points(COUNT, len(varied)).T, strict=True):
        size = sizes.of[index]
        ends = size.spread * np.array([-1.0, 1.0])
        if size.kind == "length":
            share = float(np.median([*_shares(stated, size)]))
            ends = np.log([min(_LENGTHS[0], share), max(_LENGTHS[1], share)]) - np.log(share)
        low, high = normal_share(ends / size.spread)
        thetas[:, index] = size.spread * normal_quantile(low + shares * (high - low))
    return thetas


def _shares(stated: Case, size: Size) -> Iterator[float]:
    """Yield the stated lengths of errors as shares of the travel."""
    machine = stated.description.machine
    curves = [entry for entry in machine.errors if entry.name in size.owners]
    for entry in [*curves, *(side for plane in machine.planes if plane.name in size.owners for side in plane.sides)]:
        if entry.length is not None:
            yield entry.length / machine.axis(entry.axis).length


def _resampled(drawn: Drawn) -> Array:
    """Return as many draws of a posterior, each as often as its weight asks for, (draws, k)."""
    ends = np.cumsum(drawn.weights) / np.sum(drawn.weights)
    return np.asarray(drawn.thetas[np.searchsorted(ends, (np.arange(COUNT) + 0.5) / COUNT)])


def _factors(stated: Case, theta: Array) -> Mapping[tuple[Kind, str], float]:
    """Return sizes as factors by kind and owner.  theta : their logarithms, (k,)

    What two axes usually do together is as long, over what is usual, as what each of them does.
    """
    pairs = zip(stated.sizes.of, np.exp(theta).tolist(), strict=True)
    factors = {(size.kind, owner): factor for size, factor in pairs for owner in size.owners}
    lengths = [factor for (kind, _), factor in factors.items() if kind == "length"]
    usual = [plane.name for plane in stated.description.machine.planes if plane.usual]
    return factors | {("length", name): lengths[0] for name in usual if lengths}
