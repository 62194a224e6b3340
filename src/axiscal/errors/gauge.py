"""What no allowed reading can see: the combinations of errors that stay unknown however long one measures.

They are found as the posterior after a million readings spread over everything that is allowed, in the prior's own
metric, and come in two kinds. Some do not move the tool point at all, or only with the workpiece zero: they are a
matter of how the errors are defined. The others do move it, and need a reading that the campaign does not have.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from axiscal.errors.iso230 import words
from axiscal.errors.volume import Volume, even_poses, whole_travel
from axiscal.language.spoken import capital, joined, later, listed, put, said
from axiscal.machine.axis import letter_direction
from axiscal.numerics import Array
from axiscal.units import said_quantity
from axiscal_core.axes import Axis
from axiscal_core.errors import COMPONENTS
from axiscal_core.from_scipy import solution, triangle_over
from axiscal_core.machine import Machine
from axiscal_core.splines import NaturalSpline, gauss
from axiscal_core.terms import Term

_LISTED = 5
"""Sentences that are read; the others are counted."""


@dataclass(frozen=True, slots=True)
class Hidden:
    """One combination, or one group of combinations, that cannot be seen.

    names : the errors that take part; text : the sentence for a person
    effect : RMS over the volume of what it does to the tool point, m; 0 where it is a matter of definition
    """

    names: tuple[str, ...]
    text: str
    effect: float = 0.0


class Aspect(NamedTuple):
    """What stays open of one error.

    kind : "constant", "slope", or "curve" for what is neither
    share : of the prior variance that is unseen; std : unseen, m or rad
    """

    function: Term
    kind: str
    share: float
    std: float


def missing_words(model: Machine, found: list[tuple[Aspect, float]]) -> Iterator[Hidden]:
    """Yield what moves the tool point unseen, joined by the reading that would show it, the worst first."""
    groups: dict[str, list[tuple[Aspect, float]]] = {}
    for aspect, effect in sorted(found, key=lambda pair: -pair[1]):
        groups.setdefault(reading_that_shows(model, aspect.function), []).append((aspect, effect))
    told = list(groups.items())
    others = [member for _, members in told[_LISTED:] for member in members]
    for reading, members in [*told[:_LISTED], *([("", others)] if others else [])]:
        what = (
            "No allowed set-up shows {subject}. It moves the tool point by {effect} (RMS over the volume); {reading} "
            "would show it."
        )
        names, subject = (
            tuple(aspect.function.name for aspect, _ in members),
            [_phrase(aspect) for aspect, _ in members],
        )
        if not reading:
            what = "Nor does any allowed set-up show {names}; together they move it by {effect} (RMS over the volume)."
        far = float(np.sqrt(sum(effect**2 for _, effect in members)))
        values = {"subject": joined(subject, _LISTED), "names": joined(names), "reading": reading}
        yield Hidden(names, said(what, effect=said_quantity(far, "um", 2), **values), far)


def reading_that_shows(model: Machine, function: Term) -> str:
    """Return in words which reading would show an error that no allowed one shows."""
    axis, component = model.axes[function.axis], function.component % 3
    if function.kind == "location" and not axis.rotary:
        across = "xyz"[3 - component - letter_direction(axis.letter)]
        return said("a reading along {way} {when}", way=across, when=_moving(axis))
    when = _moving(axis)
    if len(function.axes) > 1:
        when = said("while {axes} move", axes=joined([model.axes[k].name for k in function.axes]))
    if function.kind == "reversal":
        when = said("{when} and comes from both sides", when=when)
    text = "a reading of the rotation about {way} {when}" if function.angular else "a reading along {way} {when}"
    return said(text, way="xyz"[component], when=when)


def _moving(axis: Axis) -> str:
    return said("while {axis} turns", axis=axis.name) if axis.rotary else said("while {axis} moves", axis=axis.name)


def _phrase(aspect: Aspect) -> str:
    function = aspect.function
    name = put("{name} ({words})", name=function.name, words=words(function.name))
    if function.spline.size == 1 or aspect.kind == "curve":
        return name
    return said("the constant of {name}" if aspect.kind == "constant" else "the slope of {name}", name=name)


_ABOUT = {"XY": "C", "XZ": "B", "YZ": "A"}


def undescribed(machine: Machine) -> str | None:
    """Return in one sentence which of the six errors of each axis, and which squarenesses, are not described.

    None where all are. A squareness may be that of either axis: C0Y or C0X.
    """
    named, missing = {error.name for error in machine.errors}, list[str]()
    for axis in machine.axes:
        absent = [name for component in COMPONENTS if (name := f"E{component}{axis.name}") not in named]
        missing += absent if len(absent) < len(COMPONENTS) else [said("all six of {axis}", axis=axis.name)]
    linear = sorted((axis for axis in machine.axes if not axis.rotary), key=lambda axis: axis.name)
    for first, second in combinations(linear, 2):
        about = _ABOUT.get(first.letter + second.letter)
        if about and not {f"{about}0{first.name}", f"{about}0{second.name}"} & named:
            missing.append(f"{about}0{second.name}")
    return said("Not described, taken as zero: {names}.", names=listed(", ", missing)) if missing else None


__all__ = ["Hidden", "hidden", "machine_check", "unseen_factor"]

MANY_READINGS = 1e6
_POSES = 1500
"""Poses drawn to see what none shows: some times the unknowns of the largest machine."""
_NOISE = 1e-6
"""m; a million readings of any instrument leave what none shows."""
_IDLE = 1e-3
"""Of the prior's effect on the tool: a combination that does less does nothing."""
_COUNTS = 0.02
"""Of the largest effect: an error that is less a part of it is not named."""
_CURVE = 0.3
"""Share of an error's curve that has to be hidden before it is named as a whole."""
_SHARE = 0.02
"""Share of an offset or a slope that has to be hidden before it is named."""


def unseen_factor(factor: Array, rows: Array) -> Array:
    """Return F (n, r) with F Fᵀ the covariance that a million readings would leave.

    factor : (n, q) with the prior covariance = factor factorᵀ
    rows : (m, n) allowed readings, spread evenly, each divided by its noise
    F = factor R⁻¹ with RᵀR = 1 + seenᵀ seen, of what a million readings show in the prior's metric.
    """
    if not len(rows):
        return factor
    triangle = triangle_over(np.ones(factor.shape[1]), rows @ factor * np.sqrt(MANY_READINGS / len(rows)))
    return solution(triangle.T, factor.T).T


def machine_check(machine: Machine) -> tuple[str, ...]:
    """Return what no reading of the tool point shows: along x, y and z, at any pose, from both directions."""
    model = machine
    if not model.size:
        return ()
    rng = np.random.default_rng(0)
    low, high = np.array([axis.travel for axis in machine.axes]).T
    poses = rng.uniform(low, high, (_POSES, len(low)))
    rows = model.rows_at(poses, rng.choice([-1.0, 1.0], poses.shape)).reshape(-1, model.size)
    unseen = unseen_factor(model.root(), rows / _NOISE)
    return tuple(one.text for one in hidden(model, unseen, none=later("no reading of the tool point")))


def hidden(
    model: Machine, unseen: Array, volume: Volume | None = None, none: str = later("no allowed reading")
) -> tuple[Hidden, ...]:
    """Return what cannot be seen, in words: first what moves the tool point, the worst first, then what does not.

    unseen : (size, r) factor of the unseen covariance of the machine's own errors
    volume : in which the tool point counts; the whole travel without
    none : of which readings none shows what is unseen
    """
    volume = volume or Volume(model, even_poses(whole_travel(model), 3 * _POSES))
    shift = volume.moments.mean[list(volume.counted)]
    beyond = volume.moments.gram - shift.T @ shift  # without the part that is one shift of the whole volume
    before = float(np.sum(beyond * model.covariance()))
    acting, idle = _split(unseen, beyond, _IDLE**2 * before)
    missing = list[tuple[Aspect, float]]()
    for term in model.terms:
        own = acting[term.columns]
        effect = float(np.sqrt(max(np.sum(own * (beyond[term.columns, term.columns] @ own)), 0.0)))
        if effect > _COUNTS * np.sqrt(before):
            missing.append((_missing(term, acting), effect))
    # The tool point does not depend on which of these it is.
    curves = (term for term in model.terms if not term.stated_shape)
    names = tuple(term.name for term in curves if any(_open(each) for each in _candidates(term, idle)))
    text = "{none} tells {names} from others that act alike; the tool point does not depend on it."
    alike = said(text, none=capital(said(none)), names=joined(names, _LISTED))
    return (*missing_words(model, missing), *([Hidden(names, alike)] if names else []))


def _split(unseen: Array, beyond: Array, floor: float) -> tuple[Array, Array]:
    """Return the factors of what moves the tool point by more than `floor` (m²) and of what does not.

    beyond : (size, size) E[HᵀH] less the part that is one shift of the whole volume
    """
    effects, directions = np.linalg.eigh(unseen.T @ beyond @ unseen)
    turned = unseen @ directions
    return turned[:, effects > floor], turned[:, effects <= floor]


def _missing(function: Term, acting: Array) -> Aspect:
    """Return the aspect of an error that is missed most: all of the curve, or only its slope or constant."""
    if function.stated_shape:
        unseen, whole = float(np.sum(acting[function.columns] ** 2)), float(np.trace(function.covariance))
        return Aspect(function, "curve", unseen / whole, float(np.sqrt(unseen / len(function.covariance))))
    return max(_candidates(function, acting), key=lambda a: (a.kind == "curve" and a.share > _CURVE, a.std))


def _open(aspect: Aspect) -> bool:
    """Return whether an aspect stays open by more than a rounding of the prior."""
    return aspect.share > (_CURVE if aspect.kind == "curve" else _SHARE)


def _candidates(function: Term, unseen: Array) -> Iterator[Aspect]:
    """Yield constant, slope and the rest of the curve, as far as the spline has them."""
    own = unseen[function.columns]
    rows = [("constant", _projection(function, 0))]
    if isinstance(function.spline, NaturalSpline):
        rows.append(("slope", _projection(function, 1)))
    for kind, row in rows:
        left = float(np.sum((row @ own) ** 2))
        yield Aspect(function, kind, left / float(row @ function.covariance @ row), float(np.sqrt(left)))
    if function.spline.size > len(rows):
        straight = np.array([row for _, row in rows])
        shape = np.eye(function.spline.size) - np.linalg.pinv(straight) @ straight
        left, prior = float(np.sum((shape @ own) ** 2)), float(np.trace(shape @ function.covariance @ shape.T))
        yield Aspect(function, "curve", left / prior, float(np.sqrt(left / function.spline.size)))


def _projection(function: Term, degree: int) -> Array:
    """The row (size,) that reads the mean, or half the mean rise over the travel, off the control values."""
    if function.spline.size == 1:
        return np.ones(1)
    points, weights = (each.ravel() for each in gauss(function.spline.knots, 5))
    ends = (function.spline.knots[0], function.spline.knots[-1])
    legendre = np.polynomial.legendre.Legendre.basis(degree, domain=ends)(points)
    return (weights * legendre) @ function.spline.rows(points) / (weights @ legendre**2)
