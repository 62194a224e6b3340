"""The current stage of long work, for whoever wants to show it; nothing depends on it.

with stage("scales of the errors", 2, 4):
    ...
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from contextvars import ContextVar
from typing import NamedTuple, Protocol, TypeVar

Thing = TypeVar("Thing")


class Stage(NamedTuple):
    """One piece of work.  number, of : which of how many, or how many things of how many are done; 0 where unknown"""

    name: str
    number: int = 0
    of: int = 0


class Listener(Protocol):
    """Who wants to know."""

    def begun(self, stage: Stage) -> None:
        """A stage begins, inside the one before."""

    def advanced(self, number: int) -> None:
        """So many things of the last stage are done."""

    def ended(self) -> None:
        """The last stage that was begun ends."""


_LISTENER: ContextVar[Listener | None] = ContextVar("listener", default=None)


@contextmanager
def listening(listener: Listener | None) -> Iterator[None]:
    """Let somebody, or nobody, know of the stages in this block, of this thread alone."""
    before = _LISTENER.set(listener)
    try:
        yield
    finally:
        _LISTENER.reset(before)


@contextmanager
def stage(name: str, number: int = 0, of: int = 0) -> Iterator[None]:
    """Say what is done in a `with` or, as a decorator, in a function."""
    listener = _LISTENER.get()
    if listener is None:
        yield
        return
    listener.begun(Stage(name, number, of))
    try:
        yield
    finally:
        listener.ended()


def staged(name: str, things: Iterable[Thing], of: int) -> Iterator[Thing]:
    """Yield things, and say of how many each is which."""
    listener = _LISTENER.get()
    with stage(name, 0, of):
        for number, thing in enumerate(things):
            if listener is not None:
                listener.advanced(number)
            yield thing


@contextmanager
def counting(name: str) -> Iterator[Callable[[int, int], None]]:
    """Yield what says how many of how many are done, where they are counted by others."""
    listener = _LISTENER.get()
    with ExitStack() as stack:

        def moved(number: int, of: int) -> None:
            if listener is not None and not number:
                stack.enter_context(stage(name, 0, of))
            if listener is not None:
                listener.advanced(number)

        yield moved
