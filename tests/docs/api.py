"""docs/api.md: every public name with the first sentence of its docstring.  `python -m tests.docs.api` writes it."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

import axiscal as ac

PAGE = Path(__file__).resolve().parents[2] / "docs" / "api.md"
_HEAD = """\
# Public names

`import axiscal as ac`, then `help(ac.Curve)` says shapes, units and failures. Everything else may move between
versions.
"""
_WHOLE = ("python", "campaign")
"""Rooms whose classes are told member by member; of the others, the mathematics, members are named."""

_MANY = 12
"""Arguments from which on the first ones are enough: `help` says the others."""


def page() -> str:
    """Return the whole page."""
    return "\n".join([_HEAD, *(_section(name, getattr(ac, name)) for name in ac.__all__)])


def _section(name: str, found: object) -> str:
    lines = [f"## {name}\n", f"{_said(f'ac.{name}', found)}\n"]
    return "\n".join([*lines, *_members(found)] if inspect.isclass(found) else lines)


def _members(found: type) -> list[str]:
    """Return what stands below a class: a line for each member, or their names in one line; nothing without members."""
    every = dict[str, object]()
    for base in found.__mro__:
        if base.__module__.startswith(ac.__name__):
            every |= {each: member for each, member in vars(base).items() if each not in every}
    own = [(f".{each}", member) for each, member in every.items() if not each.startswith("_")]
    told = [(each, member) for each, member in own if _told(member)]
    if found.__module__.split(".")[1] in _WHOLE:
        return [*(f"- {_said(each, member)}" for each, member in told), ""]
    return [", ".join(f"`{each}{'()' * callable(_inner(member))}`" for each, member in told) + "\n"] if told else []


def _told(member: object) -> bool:
    return isinstance(member, property | classmethod | staticmethod | int) or inspect.isfunction(member)


def _said(name: str, member: object) -> str:
    """Return the name with its arguments, and the first sentence of its docstring."""
    inner = _inner(member)
    text = inspect.cleandoc(inspect.getdoc(inner.fget if isinstance(inner, property) else inner) or "")
    plain = re.sub(r",?[ ]\(?B&H eq\.[^)]*\)?", "", " ".join(text.partition("\n\n")[0].split()))
    first = re.split(r"\. |; raises", plain)[0]
    first = first.removeprefix("Return ").removesuffix(".")
    return f"`{name}{_arguments(inner)}`: {first[:1].upper()}{first[1:]}"


def _inner(member: object) -> object:
    return member.__func__ if isinstance(member, classmethod | staticmethod) else member


def _arguments(member: object) -> str:
    if isinstance(member, property) or not callable(member):
        return ""
    names = [
        f"{parameter.name}" + ("" if parameter.default is parameter.empty else "=…")
        for parameter in inspect.signature(member).parameters.values()
        if parameter.name not in ("self", "cls")
    ]
    return f"({', '.join(names if len(names) < _MANY else [*names[:3], '…'])})"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
