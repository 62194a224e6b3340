"""The current stage of long work, for whoever wants to show it; nothing depends on it.

with stage("scales of the errors", 2, 4):
    ...
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import NamedTuple, TypeVar

from axiscal.language.spoken import put, said

Thing = TypeVar("Thing")


class Stage(NamedTuple):
    """One piece of work, and since when, s of `time.monotonic`.

    number, of : which of how many, or how many things of how many are done; 0 where unknown
    """

    name: str
    number: int = 0
    of: int = 0
    since: float = 0.0


class Listener(NamedTuple):
    """Who wants to know.  stages : those that last, the newest at the end; over : called when the last has ended"""

    stages: list[Stage]
    over: Callable[[], None]


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
    listener.stages.append(Stage(name, number, of, time.monotonic()))
    try:
        yield
    finally:
        listener.stages.pop()
        if not listener.stages:
            listener.over()


def staged(name: str, things: Iterable[Thing], of: int) -> Iterator[Thing]:
    """Yield things, and say of how many each is which."""
    listener = _LISTENER.get()
    with stage(name, 0, of):
        for number, thing in enumerate(things):
            if listener is not None:
                listener.stages[-1] = listener.stages[-1]._replace(number=number)
            yield thing


def stage_text(stage: Stage, seconds: float) -> str:
    """Return a stage in words: which of how many, and how many seconds are left where things are counted."""
    name = said(stage.name)
    if not stage.of:
        return name
    text = said("{name}, {number} of {last}", name=name, number=stage.number, last=stage.of)
    if stage.number and stage.of > _COUNTED:
        left = put("{seconds:.0f}", seconds=seconds * (stage.of - stage.number) / stage.number)
        return said("{text}, about {left} s left", text=text, left=left)
    return text


_COUNTED = 12
"""More are things of one kind, which take alike; fewer are stages, which do not."""
