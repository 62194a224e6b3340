"""Between many browsers and the one desk: steps wait in a row, one after another, each on a thread of the server."""

from __future__ import annotations

import asyncio
import ctypes
import logging
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from threading import Lock, get_ident
from typing import TypeVar

from anyio import CapacityLimiter, to_thread

from axiscal.campaign.campaign import Campaign
from axiscal.document.consent import asking, nobody
from axiscal.exceptions import OvertakenError, RecordError
from axiscal.language.spoken import said
from axiscal.language.stages import Listener, listening
from axiscal.web import shapes
from axiscal.web.desk import Desk
from axiscal_core.threads import one_thread

_NEARLY = 0.5
"""s that work which is nearly done is waited for."""
_LOOKS, _GLANCES = 0.25, 0.05
"""s between looks at the record, so that what others write is shown within a second; and at the state that is shown."""
_Result = TypeVar("_Result")


class _BrokenOff(BaseException):
    """What a thread meets whose work is broken off."""


class Counter:
    """One record, open; raises RecordError if that is none.

    Work is done in the language, and by the person, of who asks for it.

    record : None for none yet
    """

    def __init__(self, record: Path | None) -> None:
        self._row, self._busy, self._drawing = CapacityLimiter(1), Lock(), Lock()
        self._drawn, self._draws = 0, 0
        self._stages = list[str]()
        with asking(nobody):
            self._desk = None if record is None else Desk(Campaign.open(record))

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
            self._desk = Desk(Campaign.open(record))
            return said("{record} is open.", record=record.name)

        if breaks:
            self._break_off()
        return await self._done(opened)

    async def leave(self) -> None:
        """Close the record after the steps that are under way, and show the start again."""

        def closed() -> None:
            self.desk.campaign.close()
            self._desk = None

        await self._done(closed)

    async def draw_up(self, work: Callable[[], _Result]) -> _Result | None:
        """Return what a function of the draft returns, None where a newer one has broken it off."""
        self._break_off()
        number = self._drawn

        def drawn() -> _Result | None:
            try:
                with self._drawing:
                    self._draws = get_ident() if number == self._drawn else 0
                try:
                    return work() if self._draws else None
                finally:
                    with self._drawing:
                        self._draws = 0
            except _BrokenOff:
                self._draws = 0
                return None

        return await self._done(drawn)

    def _break_off(self) -> None:
        """Break off what is made of the draft: its thread meets an exception at the next step of Python."""
        with self._drawing:
            self._drawn += 1
            if self._draws:
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(self._draws), ctypes.py_object(_BrokenOff))

    async def ask(self, look: Callable[[Desk], _Result]) -> _Result:
        """Return what the desk says to a step or a question, after the steps that are under way."""
        return await self._done(lambda: look(self.desk))

    async def watch(self) -> None:
        """Look at the record again and again, for what others write, and let the desk do what can wait."""
        while True:
            try:
                if self._desk is not None:
                    await self.ask(Desk.look)
            except Exception as failure:  # noqa: BLE001  (nobody waits for an answer)
                logging.getLogger(__name__).error("axiscal: %s: %s", type(failure).__name__, failure)
            await asyncio.sleep(_LOOKS)

    async def newer(self, seen: shapes.Seen = 0, wait: shapes.Wait = 0.0) -> shapes.StateShape:
        """All that the page shows, as soon as its version is another one than `seen`, or after `wait` s."""
        with suppress(TimeoutError):
            async with asyncio.timeout(wait):
                while self.desk.state.version == seen:
                    await asyncio.sleep(_GLANCES)
        return self.desk.state

    def close(self) -> str:
        """Close the record; where something is still computed, return what to say of it before the process is ended."""
        if not self._busy.acquire(timeout=_NEARLY):
            return "What was being computed was broken off; what is kept is shown at the next start."
        if self._desk is not None:
            self._desk.campaign.close()
        return ""

    async def _done(self, work: Callable[[], _Result]) -> _Result:
        """Return what work returns that is done after all that was asked for before."""

        def done() -> _Result:
            with self._busy, one_thread(), listening(Listener(self._stages, lambda: None)):
                return work()

        return await to_thread.run_sync(done, abandon_on_cancel=True, limiter=self._row)
