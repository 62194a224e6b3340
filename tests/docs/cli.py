"""docs/cli.md: the help of every command on one page.  `python -m tests.docs.cli` writes it."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import typer.main

from axiscal.cli.app import app

PAGE = Path(__file__).resolve().parents[2] / "docs" / "cli.md"
OFTEN = 3
"""Commands that share an option which stands once, at the top."""

_HEAD = """\
# Commands

`make docs` makes this page from the program's help; `--help` of a command has more examples. `axiscal step status` is
`axiscal status`. Several commands take these; their line "Also" names them:

{shared}
"""
_EXAMPLES = re.compile(r"\x08\n(.*?)(?:\n\n|\Z)", re.DOTALL)

_Row = tuple[str, str]
"""An argument or option as it is typed, and what it means."""


def reference() -> str:
    """Return the page."""
    commands = list(_commands(typer.main.get_command(app), "axiscal", None))
    known = [text for _, text, _ in commands]
    commands = [each for number, each in enumerate(commands) if each[1] not in known[:number]]  # one of two names
    counts = Counter(row for _, _, rows in commands for row in rows)
    shared = [row for row, count in counts.items() if count >= OFTEN]
    return "\n".join([_HEAD.format(shared=_list(shared)), *(_section(*each, shared) for each in commands)])


def _commands(command: Any, path: str, parent: Any) -> Iterator[tuple[str, str, list[_Row]]]:
    """Yield each command with its path, its help, and its arguments and options."""
    context = command.context_class(command, info_name=path.rpartition(" ")[2], parent=parent)
    yield path, command.help or "", [_row(parameter, context) for parameter in command.params if not _hidden(parameter)]
    for name in command.list_commands(context) if hasattr(command, "list_commands") else []:
        yield from _commands(command.get_command(context, name), f"{path} {name}", context)


def _hidden(parameter: Any) -> bool:
    return bool(getattr(parameter, "hidden", False))


def _row(parameter: Any, context: Any) -> _Row:
    """Return an argument, in brackets where it may be left out, or an option."""
    name, meaning = parameter.get_help_record(context)
    name, meaning = re.sub(r" <[^>]*>$", "", name), " ".join(meaning.split())
    if parameter.param_type_name == "option":
        return name, meaning
    return (name if parameter.required else f"[{name}]"), meaning.removesuffix(" [required]")


def _section(path: str, text: str, rows: Sequence[_Row], shared: Sequence[_Row]) -> str:
    examples = [each.splitlines()[1].strip() for each in _EXAMPLES.findall(text)]
    parts = [f"## {path}", _EXAMPLES.sub("", text).strip(), *(f"```text\n{each}\n```" for each in examples)]
    own = [row for row in rows if row not in shared]
    also = [f"`{name}`" for name, meaning in rows if (name, meaning) in shared]
    parts += [_list(own)] if own else []
    parts += [f"Also {', '.join(also)}."] if also else []
    return "\n\n".join(parts) + "\n"


def _list(rows: Sequence[_Row]) -> str:
    return "\n".join(f"- `{name}`: {meaning}" for name, meaning in rows)


if __name__ == "__main__":
    PAGE.write_text(reference(), encoding="utf-8")
