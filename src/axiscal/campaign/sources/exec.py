"""`exec:COMMAND`: any instrument behind a program that answers one JSON line per JSON line."""

from __future__ import annotations

import contextlib
import json
import math
import os
import queue
import shlex
import signal
import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Sequence
from typing import IO, Any

from axiscal.campaign.sources.source import Answer, Request, Skip
from axiscal.exceptions import SourceError, UnitError
from axiscal.language.spoken import said
from axiscal.measurement.reading import asked_values, reading_unit, units_of
from axiscal.measurement.setup import FINEST, Reads, Setup
from axiscal.units import dimension_of, format_quantity, from_unit, shortened

TIMEOUT = 600.0
"""Seconds that a command may take over one reading."""
GRACE = 2.0
"""Seconds that a command has to end by itself when no more readings are wanted."""
LONGEST = 100_000
"""Characters in one answer."""
_LOOK = 0.25
"""Seconds between two looks whether the command still runs; any time that a person does not notice would do."""
_AHEAD = 100
"""Lines that are kept before they are wanted; one is right, and a flood is not to fill the memory."""
_PASSED = 1000
"""Lines of its stderr that are passed on for each reading; a flood is not to fill the terminal or its file."""
_WORDS = 300
"""Characters of each line of its stderr that is passed on, or said as its last words."""
WIDEST = 1e6
"""A standard deviation this many times larger or smaller than the noise of its set-up is a slip."""

_REMEDY = 'Answer each line with one such as {{"value": 1.7, "unit": "um"}} or {{"skip": "reason"}}'


class ExecSource:
    """A command, started once without a shell; its stderr is passed through.

    command : split as a shell would, but not run by one; timeout : s for each answer
    Raises SourceError if the command cannot be started.
    """

    def __init__(self, command: str, timeout: float = TIMEOUT) -> None:
        self._command, self._timeout = command, timeout
        self._process = _start(command)
        self._lines: queue.Queue[str] = queue.Queue(_AHEAD)
        self._last_words: deque[str] = deque(maxlen=3)
        self._wanted, self._passed = True, 0
        self._listeners = [self._listen(self._hear), self._listen(self._pass_on)]

    def read(self, request: Request) -> Answer | Skip:
        """Send the request and return the answer; raises SourceError if the command dies, stalls or talks nonsense."""
        self._passed = 0
        with contextlib.suppress(queue.Empty):
            line = self._lines.get_nowait()
            if not line:
                raise self._died(GRACE)
            what = "the command `{command}` said {answer} without being asked"
            raise self._failure(what, "Answer each line with exactly one line", answer=_quoted(line))
        self._send(json.dumps(request.message(), ensure_ascii=False))
        return self._understood(self._next_line(), request)

    def close(self) -> None:
        """End the command: its input is closed, and if that does not move it, it is terminated."""
        self._wanted = False
        with contextlib.suppress(OSError):
            _pipe(self._process.stdin).close()
        for farewell in (signal.SIGTERM, signal.SIGKILL):
            try:
                self._process.wait(GRACE)
                break
            except subprocess.TimeoutExpired:
                _signal(self._process, farewell)
        self._process.wait()
        if any(listener.is_alive() for listener in self._listeners):  # it has left something behind that still runs
            _signal(self._process, signal.SIGKILL)
        for listener in self._listeners:
            listener.join(GRACE)

    def _listen(self, hear: Any) -> threading.Thread:
        thread = threading.Thread(target=hear, daemon=True)
        thread.start()
        return thread

    def _hear(self) -> None:
        with _pipe(self._process.stdout) as stream:
            while line := stream.readline(LONGEST + 1):
                self._heard(line)
        self._heard("")

    def _heard(self, line: str) -> None:
        """Keep a line until it is wanted; whoever says more has to wait."""
        while self._wanted:
            with contextlib.suppress(queue.Full):
                self._lines.put(line, timeout=_LOOK)
                return

    def _pass_on(self) -> None:
        with _pipe(self._process.stderr) as stream:
            while line := stream.readline(LONGEST + 1):
                self._last_words.append(shortened(line.strip(), _WORDS))
                self._passed += 1
                if self._passed <= _PASSED:
                    sys.stderr.write(shortened(line.rstrip(), _WORDS) + "\n")  # no terminal obeys an instrument
                    sys.stderr.flush()

    def _send(self, line: str) -> None:
        stream = _pipe(self._process.stdin)
        try:
            stream.write(line + "\n")
            stream.flush()
        except (OSError, ValueError):
            raise self._died(GRACE) from None

    def _next_line(self) -> str:
        until = time.monotonic() + self._timeout
        while (left := until - time.monotonic()) > 0:
            ended = self._process.poll() is not None  # looked at first: what it said before is in the pipe
            with contextlib.suppress(queue.Empty):
                line = self._lines.get(timeout=min(_LOOK, left))
                if not line:
                    self._lines.put("")
                    raise self._died(GRACE)
                return line
            if ended:  # and something that it has started keeps its output open
                raise self._died(_LOOK)
        remedy = "See what it is waiting for, then go on with --resume; --timeout allows it more time"
        what = "the command `{command}` has not answered within {seconds:g} s"
        raise self._failure(what, remedy, seconds=self._timeout)

    def _died(self, patience: float) -> SourceError:
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(patience)
        self._listeners[1].join(patience)
        status = self._process.returncode
        what = "the command `{command}` ended with status {status} before it answered"
        what = "the command `{command}` closed its output before it answered" if status is None else what
        ended, words = said(what, command=shortened(self._command), status=status), " / ".join(self._last_words)
        last = said('{ended}; its last words were "{words}"', ended=ended, words=words)
        return self._failure(last if self._last_words else ended, "Mend it, then go on with --resume")

    def _failure(self, what: str, remedy: str, **values: object) -> SourceError:
        return SourceError(what, remedy, None, None, command=shortened(self._command), **values)

    def _understood(self, line: str, request: Request) -> Answer | Skip:
        try:
            answer = json.loads(line, object_pairs_hook=_once_each) if len(line) <= LONGEST else None
        except _TwiceError as twice:
            what = "the command `{command}` answered {answer}, which gives {key} twice"
            raise self._failure(what, "Give each key once", answer=_quoted(line), key=twice) from None
        except (ValueError, RecursionError):
            answer = None
        if not isinstance(answer, dict):
            what = "the command `{command}` answered {answer}, which is not a JSON object"
            raise self._failure(what, _REMEDY, answer=_quoted(line))
        if answer.get("reading", request.reading) != request.reading:
            what = "the command `{command}` answered {answer}, but reading {number} was asked for"
            remedy = "Answer the readings in their order"
            raise self._failure(what, remedy, answer=_quoted(line), number=request.reading)
        if "skip" in answer:
            reason = answer["skip"]
            if not isinstance(reason, str) or not reason.strip() or "value" in answer:
                what = "the command `{command}` answered {answer}, which is no reason to skip"
                raise self._failure(what, _REMEDY, answer=_quoted(line))
            return Skip(reason.strip())
        return self._answer(answer, line, request)

    def _answer(self, answer: dict[str, Any], line: str, request: Request) -> Answer:
        kinds, unit = request.setup.reads_each, answer.get("unit")
        each = unit if isinstance(unit, list) and len(unit) == len(kinds) else [unit] * len(kinds)
        units = [self._unit(one, reads, line, request) for one, reads in zip(each, kinds, strict=True)]
        unit, (value, *others) = units[0], self._numbers(answer.get("value"), units, line, request.setup)
        if answer.get("std") is None:
            return Answer(value, others=tuple(others), live=True)
        std = self._number(answer["std"], unit, line)
        if std <= 0:
            what = "the command `{command}` answered {answer}, whose std is not positive"
            raise self._failure(what, "Give a std above 0, or none", answer=_quoted(line))
        if not max(FINEST, request.setup.noise / WIDEST) <= std <= request.setup.noise * WIDEST:
            noise = format_quantity(request.setup.noise, reading_unit(request.setup))
            what = "the command `{command}` answered {answer}, whose std is not plausible"
            remedy = (
                "Give one of at least 0.1 nm or 0.1 nrad, within a factor of a million of the set-up's noise, {noise}, "
                "or none"
            )
            raise self._failure(what, remedy, answer=_quoted(line), noise=noise)
        return Answer(value, std, tuple(others), live=True)

    def _numbers(self, value: object, units: Sequence[str], line: str, setup: Setup) -> list[float]:
        """Return the numbers of a reading: one, or a list of those along x, y and z, or from each station."""
        count = len(setup.names)
        if count == 1:
            return [self._number(value, units[0], line)]
        if not isinstance(value, list) or len(value) != count:
            what = "the command `{command}` answered {answer}, in which {count} numbers were expected"
            remedy = 'Answer with all of {names}: {{"value": [1.7, ...], "unit": [{units}]}}'
            units_said = ", ".join(f'"{unit}"' for unit in units_of(setup))
            raise self._failure(
                what, remedy, answer=_quoted(line), count=count, names=asked_values(setup), units=units_said
            )
        return [self._number(each, unit, line) for each, unit in zip(value, units, strict=True)]

    def _unit(self, unit: object, reads: Reads, line: str, request: Request) -> str:
        example, instrument = {"length": "um", "angle": "urad"}[reads], request.setup.instrument
        remedy = said(
            'The {instrument} reads a length: give a unit such as "{unit}"', instrument=instrument, unit=example
        )
        if reads == "angle":
            remedy = said(
                'The {instrument} reads an angle: give a unit such as "{unit}"', instrument=instrument, unit=example
            )
        if not isinstance(unit, str):
            what = "the command `{command}` answered {answer} without a unit"
            raise self._failure(what, remedy, answer=_quoted(line))
        try:
            fits = dimension_of(unit) == reads
        except UnitError:
            fits = False
        if not fits:
            what = "the command `{command}` answered {answer} in a unit that does not fit"
            raise self._failure(what, remedy, answer=_quoted(line))
        return unit

    def _number(self, number: object, unit: str, line: str) -> float:
        if not isinstance(number, int | float) or isinstance(number, bool):
            what = "the command `{command}` answered {answer}, in which a number is missing"
            raise self._failure(what, _REMEDY, answer=_quoted(line))
        value = from_unit(float(number), unit) if abs(number) < 1e300 else math.inf
        if not math.isfinite(value):
            what = "the command `{command}` answered {answer}, which is not a finite number"
            raise self._failure(what, 'Answer {{"skip": "reason"}} when there is no reading', answer=_quoted(line))
        return value


class _TwiceError(ValueError):
    """A key that an object gives twice; its words are the key, quoted."""


def _once_each(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise _TwiceError(_quoted(json.dumps(key, ensure_ascii=False)))
        found[key] = value
    return found


def _start(command: str) -> subprocess.Popen[str]:
    remedy = "Write the source as exec:COMMAND with a program that can be started, such as exec:./instrument.py"
    try:
        words = shlex.split(command)
    except ValueError as error:
        what = "the command `{command}` cannot be split: {error}"
        raise SourceError(what, remedy, command=shortened(command), error=error) from None
    if not words:
        raise SourceError("exec: names no command", remedy)
    try:
        return subprocess.Popen(
            words,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            errors="replace",
            start_new_session=True,  # Ctrl-C is for us: the command gets to finish its answer
        )
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        what = "the command `{command}` cannot be started: {reason}"
        raise SourceError(what, remedy, command=shortened(command), reason=reason) from None


def _pipe(stream: IO[str] | None) -> IO[str]:
    assert stream is not None  # all three were asked for
    return stream


def _signal(process: subprocess.Popen[str], number: signal.Signals) -> None:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        if os.name == "posix":
            os.killpg(process.pid, number)
        else:
            process.send_signal(number)


def _quoted(line: str) -> str:
    return shortened(line.strip()) or said("an empty line")
