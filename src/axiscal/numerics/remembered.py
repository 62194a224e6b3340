"""Answers about an object that are remembered as long as the object lives; none is kept alive by its answers."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Concatenate, Generic, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

Of = TypeVar("Of")
About = ParamSpec("About")
Answer = TypeVar("Answer")
Part = TypeVar("Part")

_FEW = 2
"""All readings and those that are trusted: a verdict may ask of both, and comes back to the first ones."""


class Itself(Generic[Part]):
    """A part of what an answer follows from that compares by its identity.  part : kept, so that no other has its"""

    def __init__(self, part: Part) -> None:
        self.part = part

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Itself) and other.part is self.part

    def __hash__(self) -> int:
        return id(self.part)


def remembered(question: Callable[Concatenate[Of, About], Answer]) -> Callable[Concatenate[Of, About], Answer]:
    """Decorate a function of an object that does not change and of numbers, such as that of a set-up.

    The object compares by its identity. An answer must not refer to it, or it would live for ever.
    """
    return _remembered(question, None)


def remembered_lately(question: Callable[Concatenate[Of, About], Answer]) -> Callable[Concatenate[Of, About], Answer]:
    """Decorate a function as `remembered` does, of what grows: the last two answers are kept, and no more."""
    return _remembered(question, _FEW)


def _remembered(
    question: Callable[Concatenate[Of, About], Answer], most: int | None
) -> Callable[Concatenate[Of, About], Answer]:
    answers: WeakKeyDictionary[Of, dict[object, Answer]] = WeakKeyDictionary()

    @wraps(question)
    def answered(of: Of, /, *about: About.args, **named: About.kwargs) -> Answer:
        known, key = answers.setdefault(of, {}), (about, tuple(named.items()))
        if key not in known:
            found = question(of, *about, **named)
            while most is not None and len(known) >= most:
                del known[next(iter(known))]
            known[key] = found
        return known[key]

    return answered
