"""The scales of readings of which some stand out: are these slips, or is it the scales that are not as stated?

What stands out depends on the scales, so the two are compared by how probable they make all readings y, the ones that
stand out among them, each at its own most probable scales θ:

    scales:  log p(y | θ) + log p(θ)
    slips:   log p(y_t | θ_t) + log p(θ_t) + Σ_i log Σ_j π_j N(y_i; m_i, V_i + s_j²)

t the readings that are trusted, m_i, V_i what they predict of another one, s_j the sizes that a bad reading may have
and π_j how probable it is, one among n (`inference.contradiction`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.inference.contradiction import MODEL, PRIOR, SIZE_WEIGHTS, SIZES
from axiscal.inference.evidence import Evidence
from axiscal.inference.fit import Fit, drawn, fit
from axiscal.inference.scales import Scale, log_prior_precision
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import solution
from axiscal.numerics.gaussian import lower_root
from axiscal.numerics.threads import one_thread

_MOST = 300
"""Readings that are compared, as many as scales are learnt from: of time, for it grows with their cube."""


@one_thread()
def fit_without_slips(
    observation: Observation,
    trusted: Sequence[Reading],
    others: Sequence[Reading],
    scales: tuple[Scale, ...],
    prior: tuple[Array, Array] | None = None,
) -> Fit:
    """Return the most probable scales of all readings, or of the trusted ones where the others are likelier slips.

    trusted : those that do not stand out at the scales as stated; others : those that do; arguments else as of `fit`
    """
    found = fit(observation, trusted, scales, prior)
    if not others or len(trusted) + len(others) > _MOST:
        return found
    whole = fit(observation, [*trusted, *others], scales, prior)
    slips = _density(found) + _as_slips(observation, trusted, others, found, prior)
    return whole if _density(whole) >= slips else found


def _density(found: Fit) -> float:
    """Return log p(y | θ) + log p(θ) at the most probable scales, up to what all fits share."""
    logs = np.log(np.array(found.scales.factors))
    return found.found - 0.5 * float(logs @ log_prior_precision(found.scales.of) @ logs)


def _as_slips(
    observation: Observation,
    trusted: Sequence[Reading],
    others: Sequence[Reading],
    found: Fit,
    prior: tuple[Array, Array] | None,
) -> float:
    """Return the log probability of readings as slips, each predicted from the trusted ones."""
    together = Evidence(observation, [*drawn(trusted, _MOST), *others], found.scales.of, prior)
    together = together.with_smoothness(found.scales.smoothness)
    covariance = together.covariance(np.log(np.array(found.scales.factors)))
    seen = int(np.searchsorted(together.reading, len(trusted)))
    lower = lower_root(covariance[:seen, :seen])
    half = solution(lower, covariance[:seen, seen:])
    left = together.values[seen:] - half.T @ solution(lower, together.values[:seen])
    spread = covariance[seen:, seen:] - half.T @ half
    unit, owner = float(np.sqrt(np.median(together.noise))), together.reading[seen:]
    share = float(np.log(PRIOR["bad"] / MODEL / (len(trusted) + len(others))))
    each = [np.flatnonzero(owner == reading) for reading in np.unique(owner)]
    return sum(share + _slip(left[mine], spread[np.ix_(mine, mine)], unit) for mine in each)


def _slip(left: Array, spread: Array, unit: float) -> float:
    """Return the log density of how far one reading is off, averaged over the sizes of a slip."""
    found = []
    for size, weight in zip(unit * SIZES, SIZE_WEIGHTS, strict=True):
        lower = lower_root(spread + size**2 * np.eye(len(left)))
        white = solution(lower, left)
        normal = -0.5 * float(white @ white) - float(np.log(np.diag(lower)).sum()) - 0.5 * len(left) * np.log(2 * np.pi)
        found.append(float(np.log(weight)) + normal)
    return float(np.logaddexp.reduce(found))
