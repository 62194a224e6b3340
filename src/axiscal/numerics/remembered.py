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
    answers: WeakKeyDictionary[Of, dict[object, Answer]] = WeakKeyDictionary()

    @wraps(question)
    def answered(of: Of, /, *about: About.args, **named: About.kwargs) -> Answer:
        known, key = answers.setdefault(of, {}), (about, tuple(named.items()))
        if key not in known:
            known[key] = question(of, *about, **named)
        return known[key]

    return answered
