"""Work in processes of this computer, each with one thread; one that is killed is replaced, and nothing is lost.

Every process is alone in its pool, so the pool tells what a process worked on when it ended.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import threading
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager

from axiscal.exceptions import StudyError
from axiscal.ports.study.study_case import Done, Solve, WorkItem, answered

THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""What the usual BLAS look at when they are loaded."""
_TRIES = 4
"""Processes that one question may bring to their end before it is given up: the first and three more."""


class _Lane:
    """One process, and what it works on."""

    def __init__(self) -> None:
        self._context = multiprocessing.get_context("spawn")
        self._pool, self._process = self._begun()
        self.question: WorkItem | None = None

    def _begun(self) -> tuple[ProcessPoolExecutor, int]:
        pool = ProcessPoolExecutor(1, self._context, _prepare)
        try:
            return pool, pool.submit(os.getpid).result()
        except BrokenProcessPool:
            what = "a process that should work on cases ended before it began"
            raise StudyError(what, "See whether memory is left, or work in this process with --workers 1") from None

    def submit(self, solve: Solve, question: WorkItem) -> Future[Done]:
        """Work on a question."""
        self.question = question
        try:
            return self._pool.submit(answered, solve, question)
        except BrokenProcessPool:  # it was killed while it had nothing to do
            self.renew()
            return self._pool.submit(answered, solve, question)

    def renew(self) -> None:
        """Replace the process, which has ended, by another."""
        self._pool.shutdown()
        self._pool, self._process = self._begun()

    def end(self) -> None:
        """End the process at once."""
        with contextlib.suppress(OSError):
            os.kill(self._process, signal.SIGTERM)
        self._pool.shutdown(cancel_futures=True)


def _prepare() -> None:
    """Leave Ctrl-C to the head, and end when it is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_head, daemon=True).start()


def _end_with_head() -> None:
    head = multiprocessing.parent_process()
    if head is not None:
        head.join()
        os._exit(1)


class Processes:
    """An engine of so many processes."""

    def __init__(self, count: int) -> None:
        self._count = count

    def __call__(self, solve: Solve, questions: Iterable[WorkItem]) -> Generator[Done]:
        """Yield what comes of questions; raises StudyError where no process can be started."""
        waiting, tried = iter(questions), dict[str, int]()
        with _lanes(self._count) as lanes:
            running = dict[Future[Done], _Lane]()
            for lane, question in zip(lanes, waiting, strict=False):
                running[lane.submit(solve, question)] = lane
            while running:
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    lane = running.pop(future)
                    found = self._come(lane, future, tried)
                    again = lane.question if found is None else next(waiting, None)
                    if again is not None:
                        running[lane.submit(solve, again)] = lane
                    if found is not None:
                        yield found

    def _come(self, lane: _Lane, future: Future[Done], tried: dict[str, int]) -> Done | None:
        """Return what came of a question; None where it is to be tried again."""
        question = lane.question
        assert question is not None
        try:
            return future.result()
        except BrokenProcessPool:
            lane.renew()
            tried[question.key] = tried.get(question.key, 0) + 1
            if tried[question.key] < _TRIES:
                return None
            return Done(question.key, None, f"the process that worked on it ended without a word, {_TRIES} times")


@contextmanager
def _lanes(count: int) -> Iterator[list[_Lane]]:
    lanes = list[_Lane]()
    try:
        with _one_thread_each():
            lanes += [_Lane() for _ in range(count)]
            yield lanes
    finally:
        for lane in lanes:
            lane.end()


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Let processes that are started in this block load their linear algebra with one thread."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
