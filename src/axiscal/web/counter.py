"""Between many browsers and the one desk: steps wait in a row, new states are handed to all who wait for them.

One thread owns the campaign: one piece of work after another, the last of which can be broken off.
"""

from __future__ import annotations

import asyncio
import ctypes
import logging
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from pathlib import Path
from threading import Lock, get_ident
from typing import Self, TypeVar

from axiscal.campaign.campaign import Campaign
from axiscal.language.spoken import speaking, spoken_now
from axiscal.numerics.threads import one_thread
from axiscal.web.desk import Desk
from axiscal.web.shapes import StateShape, TypedShape

_PATIENCE = 0.5
"""s that work which is nearly done is waited for."""


class BrokenOffError(Exception):
    """Work that was waiting when the thread was ended."""


class OwnThread:
    """Does what it is given in turn, until it is ended."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="campaign")
        self._lock, self._ending = Lock(), False
        self._at_work: int | None = None

    def do(self, work: Callable[[], _Result]) -> Future[_Result]:
        """Return what becomes of a piece of work."""
        return self._pool.submit(self._done, work)

    def end(self, last: Callable[[], None]) -> bool:
        """Break off what is under way, leave what waits, do a last thing; return whether anything was broken off.

        It is ended as the main thread is by Ctrl-C, which may come anywhere: at the next step of Python.
        """
        with self._lock:
            self._ending = True
        free, broken_off = self._pool.submit(int), False
        while not wait([free], _PATIENCE).done:  # an interruption that comes while Python clears up is lost
            with self._lock:
                if self._at_work is not None:
                    interrupted = ctypes.c_ulong(self._at_work), ctypes.py_object(KeyboardInterrupt)
                    broken_off |= ctypes.pythonapi.PyThreadState_SetAsyncExc(*interrupted) == 1
        self._pool.submit(last).result()
        self._pool.shutdown()
        return broken_off

    def _done(self, work: Callable[[], _Result]) -> _Result:
        with self._lock:
            if self._ending:
                raise BrokenOffError
            self._at_work = get_ident()
        try:
            return work()
        finally:
            with self._lock:
                self._at_work = None


LOOKS = 0.25
"""s between looks at the record: what others write is shown within a second."""
_Result = TypeVar("_Result")


class Counter:
    """One record, open on its own thread; made by `open`.

    state : the newest document, that a page is shown at once
    """

    def __init__(self, desk: Desk, thread: OwnThread) -> None:
        self._desk, self._thread, self._language = desk, thread, spoken_now()
        self.state, self._news = desk.state, asyncio.Event()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._ending, self._asked = False, set[Future[str]]()

    @classmethod
    def open(cls, record: Path) -> Self:
        """Return the counter of a record, in the language that is spoken; raises RecordError if that is none."""
        thread, language = OwnThread(), spoken_now()
        early = list[StateShape]()
        opened = thread.do(lambda: _spoken(language, lambda: Desk(Campaign.open(record), early.append)))
        desk = opened.result()
        counter = cls(desk, thread)
        desk.publish = counter._publish
        return counter

    @property
    def report(self) -> Path:
        """The file of the report, where there is one."""
        return self._desk.results / "report.html"

    @property
    def folder(self) -> Path:
        """The folder of the record."""
        return self._desk.campaign.path.absolute().parent

    async def do(self, step: Callable[[Desk], str]) -> str:
        """Do a step on the campaign's thread, then what can wait, and return what was done in words."""
        asked = self._submitted(step)
        self._asked.add(asked)
        asked.add_done_callback(self._asked.discard)
        said = await asyncio.wrap_future(asked)
        self._later(Desk.think)
        return said

    async def ask(self, look: Callable[[Desk], _Result]) -> _Result:
        """Return what the desk says to a question that changes nothing, after the steps that are under way."""
        return await self._run(look)

    def read(self, text: str) -> TypedShape:
        """Return what a typed text would mean; needs no thread, because nothing changes."""
        return self._desk.read(text)

    async def watch(self) -> None:
        """Look at the record again and again, for what others write."""
        self._loop = asyncio.get_running_loop()
        self._later(Desk.think)
        while True:
            await asyncio.sleep(LOOKS)
            await self._run(Desk.look)

    async def newer(self, seen: int, wait: float) -> StateShape:
        """Return the state as soon as its version is another one than `seen`, or after `wait` s."""
        clock = asyncio.get_running_loop().time
        deadline = clock() + wait
        while self.state.version == seen and not self._ending and (left := deadline - clock()) > 0:
            news = self._news
            try:
                await asyncio.wait_for(news.wait(), left)
            except TimeoutError:
                break
        return self.state

    def end(self) -> None:
        """Let nobody wait any longer: the server is about to end."""
        self._ending = True
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._take, self.state)

    def close(self) -> str:
        """Close the record, and return what is to be said of what was broken off for it."""
        asked = bool(self._asked)
        if not self._thread.end(self._desk.campaign.close):
            return ""
        if asked:
            return (
                "A step that a page had asked for was broken off; what had been kept of it is shown at the next start."
            )
        return "What was being computed is begun anew at the next start."

    async def _run(self, step: Callable[[Desk], _Result]) -> _Result:
        return await asyncio.wrap_future(self._submitted(step))

    def _submitted(self, step: Callable[[Desk], _Result]) -> Future[_Result]:
        return self._thread.do(lambda: _spoken(self._language, lambda: step(self._desk)))

    def _later(self, step: Callable[[Desk], None]) -> None:
        self._submitted(step).add_done_callback(self._told)

    def _told(self, done: Future[None]) -> None:
        """Say on stderr what went wrong where nobody waits for an answer."""
        failure = done.exception()
        if failure is not None and not self._ending:
            logging.getLogger(__name__).error("axiscal: %s: %s", type(failure).__name__, failure)

    def _publish(self, state: StateShape) -> None:
        """Take a new state from the campaign's thread."""
        if self._loop is None:
            self.state = state
        else:
            self._loop.call_soon_threadsafe(self._take, state)

    def _take(self, state: StateShape) -> None:
        news, self._news, self.state = self._news, asyncio.Event(), state
        news.set()


@one_thread()
def _spoken(language: str, work: Callable[[], _Result]) -> _Result:
    with speaking(language):
        return work()
