"""Which command lives in which file, and how that file is loaded only when the command is called.

So files of commands import what they need at their top, and `axiscal --help` only reads what they say of themselves.
"""

from __future__ import annotations

import ast
import gc
from importlib import import_module
from pathlib import Path
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

_FILES = {
    "demo": "demo",
    "init": "init",
    "schema": "schema",
    "plan": "plan",
    "start": "start",
    "measure": "measure",
    "serve": "serve",
    "next": "next_reading",
    "record": "record",
    "undo": "undo",
    "accept": "accept",
    "note": "note",
    "status": "status",
    "finish": "finish",
    "run": "run_loop",
    "estimate": "estimate",
    "predict": "predict",
    "export": "export",
    "verify": "verify",
    "report": "report",
    "copy": "copy_record",
    "salvage": "salvage",
    "iso230": "iso230",
    "reproduce": "reproduce",
    "machine": "machine",
    "type": "type",
    "fleet": "fleet",
    "bring": "bring",
    "sync": "sync",
    "adopt": "adopt",
    "due": "due",
    "check": "check",
    "study": "study",
}
"""In the order of `--help`. A file holds a function of its own name; one of several commands also holds their `app`."""


class LazyGroup(TyperGroup):
    """The commands of all files."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        self.commands = dict.fromkeys(_FILES, TyperCommand("not loaded"))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command by its name, loaded now; None if there is no such command."""
        return _command(cmd_name, _FILES[cmd_name]) if cmd_name in _FILES else None

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the list of commands into the help, each with the first sentence that its file says of it."""
        limit = formatter.width - 6 - max(map(len, _FILES))
        read = {name: TyperCommand(name, help=_docstring(file)) for name, file in _FILES.items()}
        with formatter.section("Commands"):
            formatter.write_dl([(name, command.get_short_help_str(limit)) for name, command in read.items()])

    def invoke(self, ctx: Any) -> Any:
        """Run the command that was called; each is a door of planning or estimating."""
        from axiscal.numerics.threads import one_thread  # numpy comes with it, and help has no need of it

        with one_thread():
            return super().invoke(ctx)


def _command(name: str, file: str) -> Any:
    module = import_module(f"axiscal.cli.{file}")
    if not gc.isenabled():  # as `main` leaves it: what is loaded stays, and need not be looked through
        gc.freeze()
        gc.enable()
    several: typer.Typer | None = getattr(module, "app", None)
    if several is not None:
        return typer.main.get_command(several)
    alone = typer.Typer(rich_markup_mode=None, add_completion=False)
    alone.command(name)(getattr(module, file))
    return typer.main.get_command(alone)


def _docstring(file: str) -> str:
    """Return the docstring of a command as its file has it, unloaded."""
    tree = ast.parse(Path(__file__).with_name(f"{file}.py").read_text(encoding="utf-8"))
    functions = (node for node in tree.body if isinstance(node, ast.FunctionDef))
    return next(ast.get_docstring(function) or "" for function in functions if function.name == file)
