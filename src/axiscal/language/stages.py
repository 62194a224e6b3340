"""The current stage of long work, for whoever wants to show it; nothing depends on it.

with stage("scales of the errors"):
    ...
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from typing import NamedTuple

from axiscal.language.spoken import setting


class Listener(NamedTuple):
    """Who wants to know.  stages : those that last, the newest at the end; changed : called with this, "" for none"""

    stages: list[str]
    changed: Callable[[str], None] = lambda newest: None


_LISTENER: ContextVar[Listener | None] = ContextVar("listener", default=None)


def listening(listener: Listener | None) -> AbstractContextManager[None]:
    """Let somebody, or nobody, know of the stages in this block, of this thread alone."""
    return setting(_LISTENER, listener)


@contextmanager
def stage(name: str) -> Iterator[None]:
    """Say what is done in a `with` or, as a decorator, in a function."""
    listener = _LISTENER.get()
    if listener is None:
        yield
        return
    listener.stages.append(name)
    listener.changed(name)
    try:
        yield
    finally:
        listener.stages.pop()
        listener.changed(listener.stages[-1] if listener.stages else "")
