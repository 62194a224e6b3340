"""What commands walk: how many files and functions of axiscal they enter, and how deep.

    python -m tests.docs.walked FOLDER next mill.axiscal

gives it as JSON.  FOLDER : where the command is given
"""

from __future__ import annotations

import io
import json
import os
import sys
from contextlib import redirect_stderr, redirect_stdout
from inspect import CO_OPTIMIZED
from types import CodeType, FrameType

import axiscal
from axiscal.cli.app import run

_INLINE = {"<listcomp>", "<dictcomp>", "<setcomp>", "<genexpr>"}
"""Functions of their own in some versions of Python only."""


class Walk:
    """What is entered while it is the profile function; modules and classes that are being made do not count."""

    def __init__(self) -> None:
        self._folder, self._depth = axiscal.__path__[0], 0
        self.codes, self.deepest = set[CodeType](), 0

    def __call__(self, frame: FrameType, event: str, _: object) -> None:
        """Take note of a call or a return."""
        code = frame.f_code
        if event not in ("call", "return") or not code.co_filename.startswith(self._folder):
            return
        if not code.co_flags & CO_OPTIMIZED or code.co_name in _INLINE:
            return
        if event == "return":
            self._depth -= 1
            return
        self._depth += 1
        self.deepest = max(self.deepest, self._depth)
        self.codes.add(code)

    def found(self) -> dict[str, int]:
        """Return how many files and functions it came to, and the frames of axiscal that stood on each other."""
        files = {code.co_filename for code in self.codes}
        return {"files": len(files), "functions": len(self.codes), "frames": self.deepest}


def walked(arguments: list[str]) -> dict[str, int]:
    """Return what one command walks."""
    walk = Walk()
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()) as said:
        sys.setprofile(walk)
        try:
            code = run(arguments)
        finally:
            sys.setprofile(None)
    if code != 0:
        raise SystemExit(f"axiscal {' '.join(arguments)} ended with {code}: {said.getvalue()}")
    return walk.found()


if __name__ == "__main__":
    os.chdir(sys.argv[1])
    sys.stdout.write(json.dumps(walked(sys.argv[2:])) + "\n")
