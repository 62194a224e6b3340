"""Between many browsers and the one desk: steps wait in a row, and new states are handed to all who wait for them.

One thread owns the campaign: one piece of work after another, the last of which can be broken off.
"""

from __future__ import annotations

import asyncio
import ctypes
import logging
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import contextmanager, suppress
from contextvars import copy_context
from pathlib import Path
from threading import Lock, get_ident
from typing import Any, TypeVar

from axiscal.campaign.campaign import Campaign
from axiscal.exceptions import OvertakenError, RecordError
from axiscal.language.spoken import said
from axiscal.language.stages import Listener, listening
from axiscal.web import shapes
from axiscal.web.desk import Desk
from axiscal_core.threads import one_thread

_NEARLY = 0.5
"""s that work which is nearly done is waited for."""
LOOKS = 0.25
"""s between looks at the record: what others write is shown within a second."""
_Result = TypeVar("_Result")


@contextmanager
def lost_interruptions() -> Iterator[None]:
    """Let Python say nothing of an interruption that comes while it clears up, and is lost; it says all else."""
    before = sys.unraisablehook

    def said_of(lost: sys.UnraisableHookArgs) -> None:
        if not isinstance(lost.exc_value, KeyboardInterrupt):
            before(lost)

    sys.unraisablehook = said_of
    try:
        yield
    finally:
        sys.unraisablehook = before


def _overtaken() -> OvertakenError:
    return OvertakenError("This was broken off", "Something newer is under way")


class Counter:
    """One record, open on its own thread; raises RecordError if that is none.

    Work there is done in the language, and by the person, of who asks for it.

    record : None for none yet
    """

    def __init__(self, record: Path | None) -> None:
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="campaign")
        self._lock, self._closing = Lock(), False
        self._at_work: int | None = None
        self._drawn_up = Future[Any]()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._ending, self._news = False, asyncio.Event()
        self._stages = list[str]()
        self._desk: Desk | None = None
        if record is not None:
            self._submitted(lambda: self._open(record)).result()

    @property
    def open(self) -> bool:
        """Whether there is a record."""
        return self._desk is not None

    @property
    def desk(self) -> Desk:
        """The desk, for what changes nothing and needs no thread; raises RecordError where no record is open."""
        if self._desk is None:
            raise RecordError("No campaign is open on this page", "Begin one, or go on with one, at its start")
        return self._desk

    @property
    def stage(self) -> str:
        """What is being computed, in words, "" for nothing."""
        return said(self._stages[-1]) if self._stages else ""

    async def begin(self, found: Callable[[], Path], *, breaks: bool) -> str:
        """Open the record that a function finds or makes, and return a sentence of it.

        breaks : whether what is made of the draft is broken off; one that begins waits for its plan
        Raises OvertakenError where one is open already, and what the function raises.
        """

        def opened() -> str:
            if self._desk is not None:
                what, remedy = "A campaign is open on this page already", "Load the page again"
                raise OvertakenError(what, remedy)
            record = found()
            self._open(record)
            return said("{record} is open.", record=record.name)

        if breaks:
            self._break_off()
        sentence = await asyncio.wrap_future(self._submitted(opened))
        self._think()
        return sentence

    async def leave(self) -> None:
        """Close the record, after the steps that are under way."""

        def closed() -> None:
            self.desk.campaign.close()
            self._desk = None

        await asyncio.wrap_future(self._submitted(closed))
        self._publish()

    async def draw_up(self, work: Callable[[], _Result]) -> _Result:
        """Return what a function of the draft returns; raises OvertakenError where a newer one has broken it off."""
        self._break_off()
        asked = self._drawn_up = self._submitted(work)
        try:
            return await asyncio.wrap_future(asked)
        except asyncio.CancelledError:
            if asked.cancelled():
                raise _overtaken() from None
            raise

    async def do(self, step: Callable[[Desk], str]) -> str:
        """Do a step on the campaign's thread, then what can wait, and return what was done in words."""
        sentence = await asyncio.wrap_future(self._submitted(lambda: step(self.desk)))
        self._think()
        return sentence

    async def ask(self, look: Callable[[Desk], _Result]) -> _Result:
        """Return what the desk says to a question that changes nothing, after the steps that are under way."""
        return await asyncio.wrap_future(self._submitted(lambda: look(self.desk)))

    async def watch(self) -> None:
        """Look at the record again and again, for what others write."""
        self._loop = asyncio.get_running_loop()
        if self.open:
            self._think()
        while True:
            await asyncio.sleep(LOOKS)
            if self.open:
                await self.ask(Desk.look)

    async def newer(self, seen: int, wait: float) -> shapes.StateShape:
        """Return the state as soon as its version is another one than `seen`, or after `wait` s."""
        with suppress(TimeoutError):
            async with asyncio.timeout(wait):
                while self.desk.state.version == seen and not self._ending:
                    await self._news.wait()
        return self.desk.state

    def end(self) -> None:
        """Let nobody wait any longer: the server is about to end."""
        self._ending = True
        self._publish()

    def close(self) -> str:
        """Break off what is under way, leave what waits, close the record; return what is to be said of it.

        Work is ended as the main thread is by Ctrl-C, which may come anywhere: at the next step of Python.
        """
        broken_off = False
        with self._lock:
            self._closing = True
        free = self._pool.submit(int)
        while not wait([free], _NEARLY).done:  # an interruption that comes while Python clears up is lost
            with self._lock:
                if self._at_work is not None:
                    broken_off |= self._interrupt(self._at_work)
        if self._desk is not None:
            self._pool.submit(self._desk.campaign.close).result()
        self._pool.shutdown()
        return "What was being computed was broken off; what is kept is shown at the next start." if broken_off else ""

    def _break_off(self) -> None:
        """Break off what is made of the draft."""
        with self._lock:
            if not self._drawn_up.cancel() and self._drawn_up.running() and self._at_work is not None:
                self._interrupt(self._at_work)

    @staticmethod
    def _interrupt(thread: int) -> bool:
        """Break off what a thread does, and return whether it was there."""
        interrupted = ctypes.c_ulong(thread), ctypes.py_object(KeyboardInterrupt)
        return bool(ctypes.pythonapi.PyThreadState_SetAsyncExc(*interrupted) == 1)

    def _open(self, record: Path) -> None:
        self._desk = Desk(Campaign.open(record), self._publish)

    def _submitted(self, work: Callable[[], _Result]) -> Future[_Result]:
        return self._pool.submit(copy_context().run, self._done, work)

    def _done(self, work: Callable[[], _Result]) -> _Result:
        with self._lock:
            if self._closing:
                raise _overtaken()
            self._at_work = get_ident()
        try:
            with one_thread(), listening(Listener(self._stages, lambda: None)):
                return work()
        except KeyboardInterrupt:
            raise _overtaken() from None
        finally:
            with self._lock:
                self._at_work = None

    def _think(self) -> None:
        """Let the desk do what can wait."""
        self._submitted(lambda: self.desk.think()).add_done_callback(self._told)

    def _told(self, done: Future[None]) -> None:
        """Say on stderr what went wrong where nobody waits for an answer."""
        failure = done.exception()
        if failure is not None and not self._ending:
            logging.getLogger(__name__).error("axiscal: %s: %s", type(failure).__name__, failure)

    def _publish(self) -> None:
        """Tell all who wait, from any thread, that there is a new state."""
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._tell)

    def _tell(self) -> None:
        self._news.set()
        self._news.clear()
