"""`exec:COMMAND`: any instrument behind a program that answers one JSON line per JSON line."""

from __future__ import annotations

import contextlib
import json
import math
import shlex
import subprocess
from collections import Counter
from typing import Any

from axiscal.campaign.sources.source import Answer, Request, Skip
from axiscal.document.line_program import LONGEST, Lines
from axiscal.exceptions import SourceError, UnitError
from axiscal.language.spoken import later, said
from axiscal.measurement.reading import asked_values, reading_unit, units_of
from axiscal.measurement.setup import FINEST, Reads, Setup
from axiscal.units import find_unit, format_quantity, from_unit, shortened

TIMEOUT = 600.0
"""Seconds that a command may take over one reading."""
GRACE = 2.0
"""Seconds that a command has to end by itself when no more readings are wanted."""
_LONGEST_QUOTED = 300
"""Characters of what a command said last that a refusal quotes."""
WIDEST = 1e6
"""A standard deviation this many times larger or smaller than the noise of its set-up is a slip."""

_REMEDY = later('Answer each line with one such as {"value": 1.7, "unit": "um"} or {"skip": "reason"}')


class ExecSource:
    """A command, started once without a shell; what it says on its stderr is passed on, and the end of it kept.

    command : split as a shell would, but not run by one; timeout : s for each answer
    Raises SourceError if the command cannot be started.
    """

    def __init__(self, command: str, timeout: float = TIMEOUT) -> None:
        self._command, self._timeout = command, timeout
        try:
            self._lines = Lines(shlex.split(command))
        except (OSError, ValueError, IndexError) as error:
            reason = getattr(error, "strerror", None) or error
            remedy = "Write the source as exec:COMMAND with a program that can be started, such as exec:./instrument.py"
            raise self._failure("the command `{command}` cannot be started: {reason}", remedy, reason=reason) from None

    def read(self, request: Request) -> Answer | Skip:
        """Send the request and return the answer; raises SourceError if the command dies, stalls or talks nonsense."""
        if line := self._lines.line(0.0):
            what = "the command `{command}` said {answer} without being asked"
            raise self._failure(what, "Answer each line with exactly one line", answer=_quoted(line))
        try:
            self._lines.send(request.message())
        except (OSError, ValueError):
            raise self._died() from None
        if (line := self._lines.line(self._timeout)) is None:
            remedy = "See what it is waiting for, then go on with --resume; --timeout allows it more time"
            what = "the command `{command}` has not answered within {seconds:g} s"
            raise self._failure(what, remedy, seconds=self._timeout)
        if not line:
            raise self._died()
        try:
            return _understood(line, request)
        except SourceError as fault:
            what = "the command `{command}` answered {answer}: {fault}"
            raise self._failure(what, fault.remedy, answer=_quoted(line), fault=fault.what) from None

    def close(self) -> None:
        """End the command."""
        self._lines.end(GRACE)

    def _died(self) -> SourceError:
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._lines.process.wait(GRACE)
        status, last = self._lines.process.returncode, shortened(self._lines.last_words(GRACE), _LONGEST_QUOTED)
        what = "the command `{command}` ended with status {status} before it answered: {last}"
        what = "the command `{command}` closed its output before it answered" if status is None else what
        return self._failure(what, "Mend it, then go on with --resume", status=status, last=last or said("no word"))

    def _failure(self, what: str, remedy: str, **values: object) -> SourceError:
        return SourceError(what, remedy, None, None, command=shortened(self._command), **values)


def _understood(line: str, request: Request) -> Answer | Skip:
    """Return what a command has answered; raises SourceError, which says what is wrong with it."""
    try:
        answer = json.loads(line, object_pairs_hook=_once_each) if len(line) <= LONGEST else None
    except (ValueError, RecursionError):
        answer = None
    if not isinstance(answer, dict):
        raise SourceError("that is no JSON object", _REMEDY)
    if answer.get("reading", request.reading) != request.reading:
        remedy = "Answer the readings in their order"
        raise SourceError("reading {number} was asked for", remedy, number=request.reading)
    if "skip" in answer:
        reason = answer["skip"]
        if not isinstance(reason, str) or not reason.strip() or "value" in answer:
            raise SourceError("that is no reason to skip", _REMEDY)
        return Skip(reason.strip())
    setup, value, unit = request.setup, answer.get("value"), answer.get("unit")
    kinds = setup.reads_each
    each = unit if isinstance(unit, list) and len(unit) == len(kinds) else [unit] * len(kinds)
    units = [_unit(one, reads, setup) for one, reads in zip(each, kinds, strict=True)]
    values = value if len(setup.names) > 1 else [value]
    if not isinstance(values, list) or len(values) != len(setup.names):
        names, units_said = asked_values(setup), ", ".join(f'"{unit}"' for unit in units_of(setup))
        remedy = 'Answer with all of {names}: {{"value": [1.7, ...], "unit": [{units}]}}'
        what = "{count} numbers were expected"
        raise SourceError(what, remedy, count=len(setup.names), names=names, units=units_said)
    first, *others = map(_number, values, units)
    std = None if answer.get("std") is None else _number(answer["std"], units[0])
    if std is not None and not max(FINEST, setup.noise / WIDEST) <= std <= setup.noise * WIDEST:
        remedy = (
            "Give one of at least 0.1 nm or 0.1 nrad, within a factor of a million of the set-up's noise, {noise}, "
            "or none"
        )
        raise SourceError("its std is not plausible", remedy, noise=format_quantity(setup.noise, reading_unit(setup)))
    return Answer(first, std, tuple(others), live=True)


def _once_each(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        twice = Counter(key for key, _ in pairs).most_common(1)[0][0]
        raise SourceError("it gives {key} twice", "Give each key once", key=_quoted(json.dumps(twice)))
    return found


def _unit(unit: object, reads: Reads, setup: Setup) -> str:
    with contextlib.suppress(UnitError):
        if isinstance(unit, str) and find_unit(unit).dimension == reads:
            return unit
    remedy = 'The {instrument} reads a length: give a unit such as "um"'
    if reads == "angle":
        remedy = 'The {instrument} reads an angle: give a unit such as "urad"'
    raise SourceError("it has no unit that fits", remedy, instrument=setup.instrument)


def _number(number: object, unit: str) -> float:
    if not isinstance(number, int | float) or isinstance(number, bool):
        raise SourceError("a number is missing in it", _REMEDY)
    value = from_unit(float(number), unit) if abs(number) < 1e300 else math.inf
    if not math.isfinite(value):
        raise SourceError("that is no finite number", 'Answer {"skip": "reason"} when there is no reading')
    return value


def _quoted(line: str) -> str:
    return shortened(line.strip()) or said("an empty line")
