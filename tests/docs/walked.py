"""What commands walk: how many files, functions and statements of axiscal they enter.

    python -m tests.docs.walked FOLDER next mill.axiscal

gives it as JSON.  FOLDER : where the command is given
"""

import ast
import io
import json
import os
import sys
from contextlib import redirect_stderr, redirect_stdout
from inspect import CO_OPTIMIZED
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import axiscal
from axiscal.cli.app import run

_INLINE = {"<listcomp>", "<dictcomp>", "<setcomp>", "<genexpr>"}
"""Functions of their own in some versions of Python only."""


def walked(arguments: list[str]) -> dict[str, int]:
    """Return what one command walks; modules and classes that are being made do not count."""
    codes, lines, folder = set[CodeType](), set[tuple[str, int]](), axiscal.__path__[0]

    def seen(frame: FrameType, event: str, _: object) -> Any:
        code = frame.f_code
        ours = code.co_filename.startswith(folder) and code.co_filename.endswith(".py")  # templates are code, too
        if not ours or not code.co_flags & CO_OPTIMIZED:
            return None
        if event == "line":
            lines.add((code.co_filename, frame.f_lineno))
        elif event == "call" and code.co_name not in _INLINE:
            codes.add(code)
        return seen

    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()) as said:
        sys.settrace(seen)
        status = run(arguments)
        sys.settrace(None)
    if status:
        raise SystemExit(f"axiscal {' '.join(arguments)} ended with {status}: {said.getvalue()}")
    files = {code.co_filename for code in codes}
    trees = {file: ast.walk(ast.parse(Path(file).read_text(encoding="utf-8"))) for file in files}
    begun = {(file, node.lineno) for file, tree in trees.items() for node in tree if isinstance(node, ast.stmt)}
    return {"files": len(files), "functions": len(codes), "statements": len(lines & begun)}


if __name__ == "__main__":
    os.chdir(sys.argv[1])
    sys.stdout.write(json.dumps(walked(sys.argv[2:])) + "\n")
