"""Results kept by the content that they follow from; or by an object, for as long as that lives."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar, cast
from weakref import WeakKeyDictionary

Of = TypeVar("Of")
About = ParamSpec("About")
Answer = TypeVar("Answer")


class Memo:
    """Answers by all that each follows from.  most : so many are kept, those asked for last; None for all"""

    def __init__(self, most: int | None = None) -> None:
        self._most, self._answers = most, dict[Hashable, object]()

    def answer(
        self, content: Hashable, find: Callable[About, Answer], *of: About.args, **named: About.kwargs
    ) -> Answer:
        """Return what follows from a content.  find : it, where it is not kept; of, named : its arguments"""
        answers = self._answers
        found = answers[content] = answers.pop(content) if content in answers else find(*of, **named)
        while self._most is not None and len(answers) > self._most:
            del answers[next(iter(answers))]
        return cast(Answer, found)


def remembered(question: Callable[Concatenate[Of, About], Answer]) -> Callable[Concatenate[Of, About], Answer]:
    """Decorate a function of an object that does not change and of numbers, such as that of a set-up.

    The object compares by its identity. An answer must not refer to it, or it would live for ever.
    """
    memos: WeakKeyDictionary[Of, Memo] = WeakKeyDictionary()

    @wraps(question)
    def answered(of: Of, /, *about: About.args, **named: About.kwargs) -> Answer:
        memo = memos.get(of)
        if memo is None:
            memo = memos[of] = Memo()
        return memo.answer((about, tuple(named.items())), question, of, *about, **named)

    return answered
