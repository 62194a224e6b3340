"""The line to the agent beside LinuxCNC: a process here, or over ssh, that is sent its program and then JSON lines."""

from __future__ import annotations

import contextlib
import json
import re
import shlex
import sys
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from axiscal.document.line_program import Lines
from axiscal.exceptions import SourceError

_AGENT = Path(__file__).with_name("agent.py")
"""Its program."""
_FIRST = """
import json, sys
try:
    exec(compile(json.loads(sys.stdin.readline()), 'agent', 'exec'))
except ImportError as error:
    sys.exit(print(json.dumps({'failure': f'it is not installed where it is looked for: {error}'})))
main()
"""
_PYTHON = ("/usr/bin/python3", "-u", "-c", _FIRST)
_SSH = "ssh -o BatchMode=yes -o ConnectTimeout=10 -o ServerAliveInterval=2"
_HOST = re.compile(r"(?:[A-Za-z0-9_][\w.-]{0,63}@)?[A-Za-z0-9](?:[A-Za-z0-9.-]{0,251}[A-Za-z0-9])?")
_ALIVE = 1.0
"""s between signs of life."""
_SILENCE = 5.0
"""s for which the agent waits for one."""
_BEGIN = 30.0
"""s for ssh to ask its keys and for LinuxCNC to answer."""
_PATIENCE = 15.0
"""s that the agent has to end by itself."""
_SLOW = 600.0
"""s: a long way at a small feed, or with the feed override low."""
_LAST = '{"left":'
"""How the agent's last line begins, which answers nothing."""
_AGAIN = "Look at the machine"


def command(host: str) -> tuple[str, ...]:
    """Return what starts the agent: here, or on another computer.  Raises SourceError for what is no host."""
    if not host:
        return _PYTHON
    if not _HOST.fullmatch(host):
        remedy = "Write linuxcnc-live:mill.local or user@mill.local"
        raise SourceError("{text!r} is no name of a computer", remedy, text=host[:60])
    return (*_SSH.split(), host, shlex.join(_PYTHON))


class Connection:
    """An agent that answers; raises SourceError when it cannot be reached, does not answer, or says why it cannot."""

    def __init__(self, words: Sequence[str]) -> None:
        self._left, self._sending = "", threading.Lock()
        try:
            self._lines = Lines(words)
        except OSError as error:
            what = "{word} cannot be started: {reason}"
            raise SourceError(what, "Install it, or start it here", word=words[0], reason=error.strerror) from None
        try:
            self._send(_AGENT.read_text(encoding="utf-8"))
            threading.Thread(target=self._keep_alive, daemon=True).start()
            self._answer(_BEGIN)
        except BaseException:
            self.close()
            raise

    def status(self) -> dict[str, Any]:
        """Return how the machine stands."""
        return dict(self._ask({"do": "status"})["status"])

    def watched(self, seconds: float) -> str:
        """Wait until the probe was pressed by hand; returns what was missing, or nothing."""
        return str(self._ask({"do": "probe", "seconds": seconds})["probe"])

    def line(self, code: str) -> dict[str, Any]:
        """Execute a line and return where the probe tripped, if it did."""
        return self._ask({"do": "line", "code": code})

    def stop(self) -> None:
        """Stop whatever moves; nothing can be asked any more."""
        with contextlib.suppress(SourceError):
            self._send({"do": "stop"})
        self._end()

    def close(self) -> None:
        """Let go; may be called twice.  The agent stops what moves when its line is closed."""
        with contextlib.suppress(SourceError):
            self._send({"do": "bye"})
        self._end()

    def _ask(self, message: object) -> dict[str, Any]:
        try:
            self._send(message)
            return self._answer(_SLOW)
        except BaseException:  # Ctrl-C among them: nothing may go on moving
            self.stop()
            raise

    def _send(self, message: object) -> None:
        try:
            with self._sending:
                self._lines.send(message)
        except (OSError, ValueError):
            raise self._lost() from None

    def _answer(self, seconds: float) -> dict[str, Any]:
        if (line := self._lines.line(seconds)) is None:
            raise SourceError("LinuxCNC has not answered within {seconds:g} s", _AGAIN, seconds=seconds)
        if line.startswith(_LAST):
            self._left, line = line, ""
        try:
            answer = json.loads(line) if line else None
        except ValueError:
            raise SourceError("what answers in LinuxCNC's place says {text!r}", _AGAIN, text=line[:80]) from None
        if not isinstance(answer, dict):
            raise self._lost()
        if "failure" in answer:
            raise SourceError("LinuxCNC: {message}", _AGAIN, message=answer["failure"])
        return answer

    def _lost(self) -> SourceError:
        what = "the line to LinuxCNC was cut; its move is to be stopped there within {seconds:g} s"
        return SourceError(what, _AGAIN, seconds=_SILENCE)

    def _keep_alive(self) -> None:
        while self._lines.process.poll() is None:
            with contextlib.suppress(SourceError):
                self._send({"do": "alive"})
            time.sleep(_ALIVE)

    def _end(self) -> None:
        """Say on stderr which modes are not as they were, if the agent could not set them again."""
        last, self._left = self._lines.end(_PATIENCE) or self._left, ""
        with contextlib.suppress(ValueError, AttributeError):
            if left := json.loads(last).get("left"):
                modes = "millimetres, exact stop and the other modes of measuring"
                sys.stderr.write(f"In LinuxCNC {modes} are still in force. To have yours again, type: {left}\n")
                sys.stderr.flush()
