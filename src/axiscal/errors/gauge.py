"""What no allowed reading can see: the combinations of errors that stay unknown however long one measures.

They are found as the posterior after a million readings spread over everything that is allowed, in the prior's own
metric, and come in two kinds. Some do not move the tool point at all, or only with the workpiece zero: they are a
matter of how the errors are defined. The others do move it, and need a reading that the campaign does not have.
"""

from __future__ import annotations

from collections.abc import Iterator
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
from axiscal_core.splines import NaturalSpline, Spline
from axiscal_core.terms import Term

_LISTED = 5
"""Sentences that are read; the others are counted."""


class Hidden(NamedTuple):
    """One combination, or one group of combinations, that cannot be seen.

    text : the sentence for a person
    effect : RMS over the volume of what it does to the tool point, m; 0 where it is a matter of definition
    """

    text: str
    effect: float = 0.0


class Aspect(NamedTuple):
    """What stays open of one error: of its constant, its slope, or its curve, which is the rest of it.

    name : in words; share : of the prior variance that is unseen; std : unseen, m or rad
    """

    name: str
    curve: bool
    share: float
    std: float

    @property
    def open(self) -> bool:
        """Whether it stays open by more than a rounding of the prior."""
        return self.share > (_CURVE if self.curve else _SHARE)


def _missing_words(model: Machine, found: list[tuple[Term, str, float]]) -> Iterator[Hidden]:
    """Yield what moves the tool point unseen, joined by the reading that would show it, the worst first.

    found : errors with what of each is missing, and the RMS of its effect, m
    """
    groups = dict[str, list[tuple[Term, str, float]]]()
    for each in sorted(found, key=lambda each: -each[2]):
        groups.setdefault(_reading_that_shows(model, each[0]), []).append(each)
    told = [*groups.items()][:_LISTED]
    others = [each for members in [*groups.values()][_LISTED:] for each in members]
    for reading, members in [*told, *([("", others)] if others else [])]:
        what = (
            "No allowed set-up shows {subject}. It moves the tool point by {effect} (RMS over the volume); {reading} "
            "would show it."
        )
        if not reading:
            what = "Nor does any allowed set-up show {names}; together they move it by {effect} (RMS over the volume)."
        terms, names, effects = zip(*members, strict=True)
        far = float(np.linalg.norm(effects))
        values = {"subject": joined(names, _LISTED), "names": joined([term.name for term in terms]), "reading": reading}
        yield Hidden(said(what, effect=said_quantity(far, "um", 2), **values), far)


def _reading_that_shows(model: Machine, function: Term) -> str:
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
    return said("while {axis} turns" if axis.rotary else "while {axis} moves", axis=axis.name)


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


MANY_READINGS = 1e6
_POSES = 1500
"""Poses drawn to see what none shows: some times the unknowns of the largest machine."""
_NOISE = 1e-6
"""m; a million readings of any instrument leave what none shows."""
_PLACES = 1000
"""Along a curve, for its mean and its slope."""
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
    if not machine.size:
        return ()
    rng = np.random.default_rng(0)
    low, high = np.array([axis.travel for axis in machine.axes]).T
    poses = rng.uniform(low, high, (_POSES, len(low)))
    rows = machine.rows_at(poses, rng.choice([-1.0, 1.0], poses.shape)).reshape(-1, machine.size)
    unseen = unseen_factor(machine.root(), rows / _NOISE)
    return tuple(one.text for one in hidden(machine, unseen, none=later("no reading of the tool point")))


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
    effects, directions = np.linalg.eigh(unseen.T @ beyond @ unseen)
    acts, turned = effects > _IDLE**2 * before, unseen @ directions
    missing, alike = list[tuple[Term, str, float]](), list[str]()
    for term in model.terms:
        own, idle = turned[term.columns][:, acts], turned[term.columns][:, ~acts]
        effect = float(np.sqrt(max(np.sum(own * (beyond[term.columns, term.columns] @ own)), 0.0)))
        if effect > _COUNTS * np.sqrt(before):
            most = max(_aspects(term, own), key=lambda each: (each.curve and each.open, each.std))
            missing.append((term, most.name, effect))
        if not term.stated_shape and any(each.open for each in _aspects(term, idle)):
            alike.append(term.name)
    # The tool point does not depend on which of these it is.
    text = "{none} tells {names} from others that act alike; the tool point does not depend on it."
    told = said(text, none=capital(said(none)), names=joined(alike, _LISTED))
    return (*_missing_words(model, missing), *([Hidden(told)] if alike else []))


def _aspects(term: Term, unseen: Array) -> list[Aspect]:
    """Return constant, slope and the rest of a curve, as far as its spline has them; a stated shape is one.

    unseen : (size, r) factor of what of the control values is unseen
    """
    name, spline, prior = put("{name} ({words})", name=term.name, words=words(term.name)), term.spline, term.covariance
    if term.stated_shape:
        left = float(np.sum(unseen**2))
        return [Aspect(name, True, left / float(np.trace(prior)), float(np.sqrt(left / len(prior))))]
    lines = [name], np.ones((1, 1))
    if spline.size > 1:
        lines = [said("the constant of {name}", name=name), said("the slope of {name}", name=name)], _straight(spline)
    found = list[Aspect]()
    for text, row in zip(*lines, strict=False):
        left = float(np.sum((row @ unseen) ** 2))
        found.append(Aspect(text, False, left / float(row @ prior @ row), float(np.sqrt(left))))
    if spline.size > len(found):
        shape = np.eye(spline.size) - np.linalg.pinv(lines[1]) @ lines[1]
        left, whole = float(np.sum((shape @ unseen) ** 2)), float(np.trace(shape @ prior @ shape.T))
        found.append(Aspect(name, True, left / whole, float(np.sqrt(left / spline.size))))
    return found


def _straight(spline: Spline) -> Array:
    """Return the rows that read mean and, of a spline with ends, half the mean rise off the control values."""
    at = (np.arange(_PLACES) + 0.5) * 2 / _PLACES - 1
    low, high = spline.knots[0], spline.knots[-1]
    line = np.vander(at, 1 + isinstance(spline, NaturalSpline), increasing=True)
    return np.asarray(np.linalg.pinv(line) @ spline.rows(low + (high - low) * (at + 1) / 2), dtype=np.float64)
