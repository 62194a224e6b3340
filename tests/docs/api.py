"""docs/api.md: every public name with the first sentence of its docstring.  `python -m tests.docs.api` writes it."""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import is_typeddict

import axiscal as ac

PAGE = Path(__file__).resolve().parents[2] / "docs" / "api.md"
_HEAD = """\
# Public names

`import axiscal as ac`, then `help(ac.Curve)` says shapes, units and failures. Everything else may move between
versions.
"""
_WHOLE = ("Case", "Known")
"""Classes whose own members are told one by one; of the others they are named."""

_MANY = 8
"""Arguments, or members, from which on the first ones are enough: `help` says the others."""


def page() -> str:
    """Return the whole page."""
    found = ((name, getattr(ac, name)) for name in sorted(ac.__all__, key=str.casefold))
    return "\n".join([_HEAD, *(_section(name, each) for name, each in found if _shown(each))])


def _shown(found: object) -> bool:
    """Return whether it is a class or a function; what only says a type is left out."""
    return inspect.isfunction(found) or (inspect.isclass(found) and not is_typeddict(found))


def _section(name: str, found: object) -> str:
    lines = [f"## {name}\n", f"{_said(f'ac.{name}', found)}\n"]
    return "\n".join([*lines, *_members(found)] if inspect.isclass(found) else lines)


def _members(found: type) -> list[str]:
    """Return what stands below a class: a line for each member, or their names in one line; nothing without members."""
    every = dict[str, object]()
    for base in found.__mro__:
        if base.__module__.startswith(ac.__name__):
            every |= {each: member for each, member in vars(base).items() if each not in every}
    own = {f".{each}": member for each, member in every.items() if not each.startswith("_") and _told(member)}
    told = [each for each in own if found.__name__ in _WHOLE and each[1:] in vars(found)]
    rest = [f"`{each}{'()' * callable(_inner(own[each]))}`" for each in own if each not in told]
    named = ", ".join(rest if len(rest) <= _MANY else [*rest[:_MANY], "…"])
    return [
        *(f"- {_said(each, own[each])}" for each in told),
        *([""] if told else []),
        *([f"{named}\n"] if named else []),
    ]


def _told(member: object) -> bool:
    return isinstance(member, property | classmethod | staticmethod | int) or inspect.isfunction(member)


def _said(name: str, member: object) -> str:
    """Return the name with its arguments, and the first sentence of its docstring."""
    inner = _inner(member)
    text = inspect.cleandoc(inspect.getdoc(inner.fget if isinstance(inner, property) else inner) or "")
    plain = re.sub(r",?[ ](?:by )?\(?(?:B&H )?eq\.[^).]*\)?", "", " ".join(text.partition("\n\n")[0].split()))
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
