"""docs/api.md: every public name with the first sentence of its docstring.  `python -m tests.docs.api` writes it."""

import inspect
import re
from pathlib import Path
from typing import is_typeddict

import axiscal as ac

PAGE = Path(__file__).resolve().parents[2] / "docs" / "api.md"
_HEAD = """\
# Public names

`import axiscal as ac`, then `help(ac.Curve)` says shapes, units, failures and members. Everything else may move between
versions.
"""
_WHOLE = ("Case", "Known")
"""Classes whose own members are told one by one; of the others `help` does."""

_MANY = 8
"""Arguments from which on the first ones are enough: `help` says the others."""


def page() -> str:
    """Return the whole page."""
    found = ((name, getattr(ac, name)) for name in sorted(ac.__all__, key=str.casefold))
    return "\n".join([_HEAD, *(line for name, each in found if _shown(each) for line in _lines(name, each))]) + "\n"


def _shown(found: object) -> bool:
    """Return whether it is a class or a function; what only says a type is left out."""
    return inspect.isfunction(found) or (inspect.isclass(found) and not is_typeddict(found))


def _lines(name: str, found: object) -> list[str]:
    """Return a line for a name, and one for each member of a class that is told whole."""
    own = vars(found).items() if name in _WHOLE else ()
    members = [(f".{each}", member) for each, member in own if not each.startswith("_") and _told(member)]
    return [f"- {_said(f'ac.{name}', found)}", *(f"  - {_said(each, member)}" for each, member in members)]


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
    if not inspect.isfunction(member):
        return ""
    names = [
        f"{parameter.name}" + ("" if parameter.default is parameter.empty else "=…")
        for parameter in inspect.signature(member).parameters.values()
        if parameter.name not in ("self", "cls")
    ]
    return f"({', '.join(names if len(names) < _MANY else [*names[:3], '…'])})"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
