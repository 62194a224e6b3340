"""docs/api.md: every public name with its docstring.  `python -m tests.docs.api` writes it."""

from __future__ import annotations

import inspect
from pathlib import Path

import axiscal as ac

PAGE = Path(__file__).resolve().parents[2] / "docs" / "api.md"
_HEAD = """\
# Public names

Made from the docstrings by `make docs`. `import axiscal as ac`; a name is loaded when it is first used. Everything else
may move between versions.
"""


def page() -> str:
    """Return the whole page."""
    return "\n".join([_HEAD, *(_section(name, getattr(ac, name)) for name in ac.__all__)])


def _section(name: str, found: object) -> str:
    parts = [f"## {name}\n", _said(f"ac.{name}", found)]
    if inspect.isclass(found):
        own = [(each, member) for each, member in vars(found).items() if not each.startswith("_")]
        parts += [_said(f"{name}.{each}", member) for each, member in own if _told(member)]
    return "\n".join(parts)


def _told(member: object) -> bool:
    return isinstance(member, property | classmethod | staticmethod) or inspect.isfunction(member)


def _said(name: str, member: object) -> str:
    inner = member.__func__ if isinstance(member, classmethod | staticmethod) else member
    text = inspect.cleandoc(inspect.getdoc(inner.fget if isinstance(inner, property) else inner) or "")
    return f"`{name}{_arguments(inner)}`\n\n```text\n{text}\n```\n"


def _arguments(member: object) -> str:
    if isinstance(member, property) or not callable(member):
        return ""
    names = [
        f"{parameter.name}" + ("" if parameter.default is parameter.empty else "=…")
        for parameter in inspect.signature(member).parameters.values()
        if parameter.name not in ("self", "cls")
    ]
    return f"({', '.join(names)})"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
