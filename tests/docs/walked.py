"""What commands walk: how many files, functions and statements of axiscal they enter.

    python -m tests.docs.walked FOLDER next mill.axiscal

gives it as JSON.  FOLDER : where the command is given
"""

from __future__ import annotations

import ast
import io
import json
import os
import sys
from contextlib import redirect_stderr, redirect_stdout
from inspect import CO_OPTIMIZED
from pathlib import Path
from types import CodeType, FrameType

import axiscal
from axiscal.cli.app import run

_INLINE = {"<listcomp>", "<dictcomp>", "<setcomp>", "<genexpr>"}
"""Functions of their own in some versions of Python only."""


def _statements(file: str) -> set[int]:
    """Return the lines of a file on which a statement begins."""
    tree = ast.parse(Path(file).read_text(encoding="utf-8"))
    return {node.lineno for node in ast.walk(tree) if isinstance(node, ast.stmt)}


class Walk:
    """What is entered while it is the trace function; modules and classes that are being made do not count."""

    def __init__(self) -> None:
        self._folder = axiscal.__path__[0]
        self.codes, self.lines = set[CodeType](), set[tuple[str, int]]()

    def __call__(self, frame: FrameType, event: str, _: object) -> Walk | None:
        """Take note of a call or a line."""
        code = frame.f_code
        ours = code.co_filename.startswith(self._folder) and code.co_filename.endswith(".py")  # templates are code, too
        if not ours or not code.co_flags & CO_OPTIMIZED:
            return None
        if event == "line":
            self.lines.add((code.co_filename, frame.f_lineno))
        elif event == "call" and code.co_name not in _INLINE:
            self.codes.add(code)
        return self

    def found(self) -> dict[str, int]:
        """Return how many files and functions it came to, and how many statements of these functions ran."""
        files = {code.co_filename for code in self.codes}
        begun = {file: _statements(file) for file in files}
        statements = sum(line in begun.get(file, ()) for file, line in self.lines)
        return {"files": len(files), "functions": len(self.codes), "statements": statements}


def walked(arguments: list[str]) -> dict[str, int]:
    """Return what one command walks."""
    walk = Walk()
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()) as said:
        sys.settrace(walk)
        try:
            code = run(arguments)
        finally:
            sys.settrace(None)
    if code != 0:
        raise SystemExit(f"axiscal {' '.join(arguments)} ended with {code}: {said.getvalue()}")
    return walk.found()


if __name__ == "__main__":
    os.chdir(sys.argv[1])
    sys.stdout.write(json.dumps(walked(sys.argv[2:])) + "\n")
