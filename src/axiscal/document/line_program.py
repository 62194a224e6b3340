"""A program that is sent JSON lines and answers with lines; its stderr is passed on, and the end of it kept."""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
import subprocess
import sys
import time
from collections import deque
from collections.abc import Sequence
from threading import Thread

LONGEST = 100_000
"""Characters in one line."""
_LOOK = 0.25
"""Seconds between two looks whether the program still runs; any time that a person does not notice would do."""
_KEPT = 5
"""Lines that it said last on its stderr."""


class Lines:
    """A program, started once without a shell; raises OSError or ValueError where it cannot be."""

    def __init__(self, words: Sequence[str]) -> None:
        self.process = subprocess.Popen(
            words,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            errors="replace",
            start_new_session=True,  # Ctrl-C is for us: the program gets to finish its answer
        )
        assert self.process.stdin is not None  # all three were asked for
        assert self.process.stdout is not None
        self._to, self._from, self._heard = self.process.stdin, self.process.stdout, b""
        self._last = deque[str](maxlen=_KEPT)
        self._listening = Thread(target=self._listen, daemon=True)
        self._listening.start()

    def send(self, message: object) -> None:
        """Send a message; raises OSError or ValueError where nobody takes it."""
        self._to.write(json.dumps(message, ensure_ascii=False) + "\n")
        self._to.flush()

    def line(self, patience: float) -> str | None:
        """Return the next line with its end, "" where none will come any more, None where none came in so many s."""
        stream, until = self._from.fileno(), time.monotonic() + patience
        while b"\n" not in self._heard and len(self._heard) <= LONGEST:
            ended = self.process.poll() is not None  # looked at first: what it said before is in the pipe
            left = until - time.monotonic()
            if select.select([stream], [], [], max(min(_LOOK, left), 0.0))[0]:
                part = os.read(stream, LONGEST)
                self._heard += part
                if not part:
                    break
            elif ended:  # and something that it has started keeps its output open
                break
            elif left <= 0:
                return None
        line, end, self._heard = self._heard.partition(b"\n")
        return (line + end).decode("utf-8", "replace")

    def last_words(self, grace: float) -> str:
        """Return what it said last on its stderr; grace : s to wait for its end, which what it started may keep open"""
        self._listening.join(grace)
        return " ".join(self._last)

    def _listen(self) -> None:
        assert self.process.stderr is not None
        with self.process.stderr as stream:
            for line in stream:
                sys.stderr.write(line)
                self._last.append(line.strip())

    def end(self, grace: float) -> str:
        """Close its input, and kill it and what it left behind where that does not move it; return its last line.

        grace : s that it has to end by itself, and once more when it is told to.  May be called twice.
        """
        last = ""
        if self._from.closed:
            return last
        with contextlib.suppress(OSError, ValueError):
            self._to.close()
        for farewell in (signal.SIGTERM, signal.SIGKILL):
            try:
                self.process.wait(grace)
                break
            except subprocess.TimeoutExpired:
                self._signal(farewell)
        self.process.wait()
        self._signal(signal.SIGKILL)
        while line := self.line(0.0):
            last = line
        self._from.close()
        self._listening.join(grace)
        return last

    def _signal(self, number: signal.Signals) -> None:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            if os.name == "posix":
                os.killpg(self.process.pid, number)
            else:
                self.process.send_signal(number)
