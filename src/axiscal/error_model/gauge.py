"""What no allowed reading can see: the combinations of errors that stay unknown however long one measures.

They are found as the posterior after a million readings spread over everything that is allowed, in the prior's own
metric, and said in words that name the errors which only show together.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from axiscal.error_model.iso230 import words
from axiscal.error_model.model import ErrorFunction, ErrorModel
from axiscal.numerics import Array
from axiscal.numerics.cubic import NaturalSpline, quadrature

MANY_READINGS = 1e6
_WHOLE = 0.9
_PART = 0.02
_LEFT = 0.05
_PARTNER = 0.03
_WHOLLY = 0.999
_PARTNERS = 4


def unseen_factor(factor: Array, rows: Array) -> Array:
    """Return F (n, r) with F Fᵀ the covariance that a million readings would leave.

    factor : (n, n) with the prior covariance = factor factorᵀ
    rows : (m, n) allowed readings, spread evenly, each divided by its noise
    Singular values of the readings in the prior's metric decide: s = 0 is not seen at all.
    """
    if not len(rows):
        return factor
    seen = rows @ factor / np.sqrt(len(rows))
    triangle = np.linalg.qr(seen).R if len(seen) > len(factor) else seen
    _, values, right = np.linalg.svd(triangle, full_matrices=True)
    information = np.zeros(len(factor))
    information[: len(values)] = values**2
    result: Array = (factor @ right.T) / np.sqrt(1.0 + MANY_READINGS * information)
    return result


@dataclass(frozen=True, slots=True)
class Hidden:
    """One combination that cannot be seen.

    names : the errors that take part; text : the sentence for a person
    """

    names: tuple[str, ...]
    text: str


@dataclass(frozen=True, eq=False, slots=True)
class _Feature:
    """One aspect of an error function, its constant or its slope.

    shadow : (r,) its unseen part; prior : its standard deviation before the first reading
    """

    function: ErrorFunction
    aspect: str
    shadow: Array
    prior: float

    @property
    def text(self) -> str:
        """The aspect in words."""
        name = self.function.name
        return name if self.function.basis.size == 1 else f"the {self.aspect} of {name}"


def hidden(model: ErrorModel, unseen: Array) -> tuple[Hidden, ...]:
    """Return what cannot be seen, in words.

    unseen : (size, r) factor of the unseen covariance of the machine's own errors
    A curve is never seen when its shape beyond constant and slope stays as wide as the prior. Constants and slopes
    that stay open are taken one combination at a time: the one least known, with those it cannot be told from, is
    then held fixed, until nothing is left open. Their number is the number of conventions a gauge has to make.
    """
    never = [f for f in model.functions if _shape_share(f, unseen[f.columns]) > _WHOLE]
    features = [
        feature
        for function in model.functions
        if function not in never
        for feature in _aspects(function, unseen[function.columns])
        if np.linalg.norm(feature.shadow) > np.sqrt(_PART) * feature.prior
    ]
    return (*(_never(function) for function in never), *_combinations(features))


def _shape_share(function: ErrorFunction, unseen: Array) -> float:
    """The part of the prior variance of a curve's shape, beyond constant and slope, that stays unseen."""
    if function.basis.size <= 2:
        return 0.0
    straight = np.vander(np.linspace(-1, 1, function.basis.size), 2)
    shape = np.eye(function.basis.size) - straight @ np.linalg.pinv(straight)
    return float(np.sum((shape @ unseen) ** 2) / np.trace(shape @ function.covariance @ shape))


def _aspects(function: ErrorFunction, unseen: Array) -> Iterator[_Feature]:
    slopes = isinstance(function.basis, NaturalSpline)
    for degree, aspect in enumerate(("constant", "slope") if slopes else ("constant",)):
        row = _projection(function, degree)
        yield _Feature(function, aspect, row @ unseen, float(np.sqrt(row @ function.covariance @ row)))


def _projection(function: ErrorFunction, degree: int) -> Array:
    """The row (size,) that reads the mean, or half the mean rise over the travel, off the control values."""
    if function.basis.size == 1:
        return np.ones(1)
    points, weights = quadrature(function.basis)
    ends = (function.basis.knots[0], function.basis.knots[-1])
    legendre = np.polynomial.legendre.Legendre.basis(degree, domain=ends)(points)
    row: Array = (weights * legendre) @ function.basis.rows(points) / (weights @ legendre**2)
    return row


def _never(function: ErrorFunction) -> Hidden:
    along = "xyz"[function.component % 3]
    reading = f"a reading of the rotation about {along}" if function.angular else f"a reading along {along}"
    axis = function.name.removesuffix("_reversal")[2:]
    text = f"{function.name} ({words(function.name)}): no allowed reading sees it; {reading} while {axis} moves would."
    return Hidden((function.name,), text)


def _combinations(features: list[_Feature]) -> Iterator[Hidden]:
    """Yield one combination after another by pivoted elimination in the prior's metric."""
    open_parts = [feature.shadow / feature.prior for feature in features]
    while open_parts:
        sizes = np.array([part @ part for part in open_parts])
        pivot = int(sizes.argmax())
        if sizes[pivot] < _LEFT:
            return
        unit = open_parts[pivot] / np.sqrt(sizes[pivot])
        shares = np.array([(part @ unit) ** 2 for part in open_parts])
        partners = [int(i) for i in np.argsort(-shares, kind="stable") if i != pivot and shares[i] > _PARTNER]
        yield _sentence(features[pivot], [features[i] for i in partners])
        open_parts = [part - (part @ unit) * unit for part in open_parts]


def _sentence(first: _Feature, partners: list[_Feature]) -> Hidden:
    names = tuple(dict.fromkeys(f.function.name for f in (first, *partners)))
    subject = first.text[0].upper() + first.text[1:] + f" ({words(first.function.name)})"
    if first.shadow @ first.shadow > _WHOLLY * first.prior**2:
        return Hidden(names[:1], f"{subject}: no allowed reading sees it.")
    if not partners:
        return Hidden(names, f"{subject} only shows mixed with constants and slopes of other errors.")
    named = [partner.text for partner in partners[:_PARTNERS]]
    more = len(partners) - len(named)
    listed = ", ".join(named) + (f" and {more} more" if more else "")
    return Hidden(names, f"{subject} cannot be told from {listed}: they act on the readings together.")
