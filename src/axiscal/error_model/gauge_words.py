"""What cannot be seen, said to a technician: few sentences, one for each pattern."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from axiscal.error_model.iso230 import words
from axiscal.error_model.model import ErrorModel, Term
from axiscal.error_model.plane import PlaneError
from axiscal.machine.axis import letter_direction
from axiscal.numerics import Array
from axiscal.units import format_quantity

_LISTED = 5
"""Sentences that are read; the others are counted."""
_WHOLE = 0.999
"""All of it, to rounding of the shares."""
_OPEN = 0.1
"""Share that has to be hidden before it is spoken of."""
_HARMLESS = "the tool point does not depend on it"


@dataclass(frozen=True, slots=True)
class Hidden:
    """One combination, or one group of combinations, that cannot be seen.

    names : the errors that take part; text : the sentence for a person
    effect : RMS over the volume of what it does to the tool point, m; 0 where it is a matter of definition
    """

    names: tuple[str, ...]
    text: str
    effect: float = 0.0


@dataclass(frozen=True, eq=False, slots=True)
class Aspect:
    """What stays open of one error.

    kind : "constant", "slope", or "curve" for what is neither
    shadow : (r,) its unseen part in prior standard deviations; share : of the prior variance; scale : prior std
    """

    function: Term
    kind: str
    shadow: Array
    share: float
    scale: float

    @property
    def wholly(self) -> bool:
        """Whether readings leave it as it was before."""
        return self.share > _WHOLE

    @property
    def size(self) -> float:
        """Unseen standard deviation, m or rad."""
        return float(np.sqrt(self.share)) * self.scale


def missing(model: ErrorModel, found: list[tuple[Aspect, float]]) -> Iterator[Hidden]:
    """Yield what moves the tool point unseen, joined by the reading that would show it, the worst first."""
    groups: dict[str, list[tuple[Aspect, float]]] = {}
    for aspect, effect in sorted(found, key=lambda pair: -pair[1]):
        groups.setdefault(_reading(model, aspect.function), []).append((aspect, effect))
    for reading, members in list(groups.items())[:_LISTED]:
        subject = _listed([_phrase(aspect) for aspect, _ in members])
        effect = float(np.sqrt(sum(effect**2 for _, effect in members)))
        moved = f"It moves the tool point by {format_quantity(effect, 'um', 2)} (RMS over the volume)"
        text = f"No allowed set-up shows {subject}. {moved}; {reading} would show it."
        yield Hidden(tuple(aspect.function.name for aspect, _ in members), text, effect)
    yield from _others(list(groups.values())[_LISTED:])


def _others(groups: list[list[tuple[Aspect, float]]]) -> Iterator[Hidden]:
    members = [member for group in groups for member in group]
    if members:
        names = tuple(aspect.function.name for aspect, _ in members)
        effect = float(np.sqrt(sum(effect**2 for _, effect in members)))
        moved = f"{format_quantity(effect, 'um', 2)} (RMS over the volume)"
        yield Hidden(
            names, f"Nor does any allowed set-up show {_joined(names)}; together they move it by {moved}.", effect
        )


def _reading(model: ErrorModel, function: Term) -> str:
    axis, component = model.machine.axes[function.axis], function.component % 3
    sides = " and comes from both sides" if function.kind == "reversal" else ""
    if function.kind == "location" and not axis.rotary:
        return f"a reading along {'xyz'[3 - component - letter_direction(axis.letter)]} while {axis.name} moves"
    kind = "of the rotation about" if function.angular else "along"
    if isinstance(function, PlaneError):
        return f"a reading {kind} {'xyz'[component]} while {' and '.join(function.entry.axes)} move{sides}"
    return f"a reading {kind} {'xyz'[component]} while {axis.name} {'turns' if axis.rotary else 'moves'}{sides}"


def conventions(model: ErrorModel, aspects: list[Aspect]) -> Iterator[Hidden]:
    """Yield what does not move the tool point: errors without effect, curves that act as one, and sums of constants."""
    idle = [a for a in aspects if a.wholly and (a.kind == "curve" or _is_constant(a))]
    if idle:
        subject, many = _listed([_phrase(a) for a in idle]), len(idle) > 1
        text = f"No allowed reading shows {subject}; {'they do' if many else 'it does'} not move the tool point."
        yield Hidden(tuple(a.function.name for a in idle), text)
    rest = [a for a in aspects if a not in idle]
    yield from _twins(model, [a for a in rest if a.kind == "curve"])
    for turning in (False, True):
        for direction in range(3):
            found = [a for a in rest if a.kind != "curve" and _pattern(model, a) == (turning, direction)]
            if any(a.share > _OPEN for a in found):
                yield _sum(model, found, turning, direction)


def _pattern(model: ErrorModel, aspect: Aspect) -> tuple[bool, int]:
    """Whether an aspect acts as a turn, and about which direction, or as a shift, and along which direction."""
    function, axis = aspect.function, model.machine.axes[aspect.function.axis]
    component, along = function.component % 3, letter_direction(axis.letter)
    if aspect.kind == "slope" and not axis.rotary and not function.angular and component != along:
        return True, 3 - component - along
    return function.angular, component


def _sum(model: ErrorModel, members: list[Aspect], turning: bool, direction: int) -> Hidden:
    names = tuple(dict.fromkeys(a.function.name for a in members))
    where = f"{'About' if turning else 'Along'} {'xyz'[direction]}"
    if len(members) == 1:
        zero = "" if turning else ", for it is where the workpiece zero lies"
        text = f"{where}: {_phrase(members[0])} cannot be told from what other errors do{zero}; {_HARMLESS}."
        return Hidden(names, text)
    turns = any(axis.rotary for axis in model.machine.axes)
    shows = "only sums of them show" if turns else "only their sum shows"
    return Hidden(
        names, f"{where}: {_kinds(members)} act together, {shows}. {_convention(members, turning)}; {_HARMLESS}."
    )


def _convention(members: list[Aspect], turning: bool) -> str:
    """How to read a group: which of its errors hold the whole of it."""
    held = [a.function.name for a in members if a.function.kind == "location"]
    if held:
        return (
            f"With constants and slopes taken as zero, {_joined(held)} {'say' if len(held) > 1 else 'says'} all of it"
        )
    return "Which of them holds it is a matter of choice" if turning else "It is where the workpiece zero lies"


def _twins(model: ErrorModel, curves: list[Aspect]) -> Iterator[Hidden]:
    """Yield, axis by axis, the curves that act on the tool point as one: a turn then looks like a displacement."""
    for k, axis in enumerate(model.machine.axes):
        mine = [a for a in curves if a.function.axis == k]
        about = sorted({"xyz"[a.function.component % 3] for a in mine if a.function.angular})
        way = (
            f"a reading of the rotation about {' or '.join(about)} would, or a tool of another length; "
            if about
            else ""
        )
        if mine:
            subject = _listed([_phrase(a) for a in mine])
            alike = f"no allowed reading tells {subject} from other curves that act alike"
            yield Hidden(tuple(a.function.name for a in mine), f"On {axis.name}, {alike}; {way}{_HARMLESS}.")


def _kinds(members: list[Aspect]) -> str:
    """The members by kind: location errors by name, then constants and slopes."""
    parts = [a.function.name for a in members if _is_constant(a)]
    for kind in ("constant", "slope"):
        names = [a.function.name for a in members if a.kind == kind and not _is_constant(a)]
        if names:
            parts.append(f"the {kind}{'s' if len(names) > 1 else ''} of {_joined(names)}")
    return _joined(parts)


def _phrase(aspect: Aspect) -> str:
    function = aspect.function
    name = f"{function.name} ({words(function.name)})"
    return name if _is_constant(aspect) or aspect.kind == "curve" else f"the {aspect.kind} of {name}"


def _is_constant(aspect: Aspect) -> bool:
    return not isinstance(aspect.function, PlaneError) and aspect.function.basis.size == 1


def _listed(phrases: list[str]) -> str:
    more = len(phrases) - _LISTED
    return _joined([*phrases[:_LISTED], f"{more} more"] if more > 0 else phrases)


def _joined(parts: list[str] | tuple[str, ...]) -> str:
    return " and ".join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)
