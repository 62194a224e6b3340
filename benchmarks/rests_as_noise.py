"""What readings leave where the rests of cells count as noise of each of them: as figures elsewhere were counted.

The product knows that readings in one cell of an axis share its rest, and learns from it; a little less is then left.
"""

from __future__ import annotations

import numpy as np

from axiscal.estimation.case import Case
from axiscal.measurement.reading import Places
from axiscal.measurement.reading_rows import rows_at
from axiscal.numerics import Array


def left_with_rests_as_noise(case: Case, places: Places, without: str = "") -> float:
    """Return the RMS after readings at places, um, by C = L (1 + A'A)^-1 L', A the rows times L over their noise.

    without : a kind of errors that is taken to be zero, such as "reversal"
    """
    prior = np.array(case.prior.covariance)
    for term in case.errors.terms:
        if term.kind == without:
            prior[term.columns, :] = prior[:, term.columns] = 0.0
    found, size = rows_at(case.observation, places), len(prior)
    values, ways = np.linalg.eigh(prior)
    root = ways * np.sqrt(np.maximum(values, 0.0))
    seen = found.rows[:, :size] @ root / np.sqrt(found.variances)[:, None]
    covariance = root @ np.linalg.inv(np.eye(size) + seen.T @ seen) @ root.T
    yardstick: Array = np.asarray(case.yardstick.root.matrix)
    known = yardstick.shape[1]
    return 1e6 * case.yardstick.rms_of(float(np.sum((yardstick @ covariance[:known, :known]) * yardstick)))
