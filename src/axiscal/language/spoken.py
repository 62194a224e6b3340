"""The language of the person who reads: English sentences in the code, other languages from one file each.

`language/words.toml` has the English for codes, such as causes.
`language/translations/de.po` is what a translator edits; `make languages` writes `de.mo`, which the program reads.

    text = said("reading {number} of {last}", number=3, last=9)   # in the language that is spoken now
    with speaking("de"):
        again(text)                                               # the same in another one: "Messung 3 von 9"

A text that was said is a `str` like any other. It also knows its message and values, so results keep the English of
sentences that a report has in the reader's language.
"""

from __future__ import annotations

import gettext
import operator
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from functools import cache
from importlib import resources
from string import Formatter
from types import MappingProxyType
from typing import Any, TypeVar, cast

LANGUAGES = {"en": "English", "de": "Deutsch"}
"""Those there are, each by its own name."""
DECIMALS = {"en": ".", "de": ","}
"""What stands before the decimals."""
_LONG = 1e6
"""Below it a person writes a number without an exponent."""
_SPOKEN = ContextVar("language", default="en")
_SILENT = frozenset({float, int, bool, str, type(None)})
"""What most of the data are of: nothing in them was said."""
_Thing = TypeVar("_Thing")


class Said(str):
    """A text that knows what it was made of.

    forms : of a message that is translated, one or two, with {names}; () : of the form that is not, `put`
    raised : whether it begins with a capital
    """

    forms: tuple[str, ...] = ()
    form: str = ""
    values: Mapping[str, object] = MappingProxyType({})
    raised: bool = False


def said(message: str, /, **values: object) -> str:
    """Return a message in the language that is spoken now, its {names} filled in."""
    return _made((message,), "", values)


def counted(one: str, many: str, count: int, /, **values: object) -> str:
    """Return the message for one or for many, {count} and the other {names} filled in."""
    return _made((one, many), "", {"count": count, **values})


def put(form: str, /, **values: object) -> str:
    """Return parts put together in a form that all languages share, such as "{first}: {second}"."""
    return _made((), form, values)


def listed(separator: str, parts: Sequence[str]) -> str:
    """Return parts one after another, each in the language that is spoken."""
    names = [f"part{number}" for number in range(len(parts))]
    between = separator.replace("{", "{{").replace("}", "}}")
    return put(between.join(f"{{{name}}}" for name in names), **dict(zip(names, parts, strict=True)))


def quoted(name: str) -> str:
    """Return a name as it stands in a sentence of the language that is spoken."""
    return said('"{name}"', name=name)


def later(message: str) -> str:
    """Return a message unchanged: translators find it here, and its user says it."""
    return message


WORDS: Mapping[str, Any] = tomllib.loads(
    resources.files(__package__).joinpath("words.toml").read_text(encoding="utf-8")
)
"""What codes are called: tables of messages by code, which their users say."""


def joined(parts: Sequence[str], most: int = 0, form: str = later("{first} and {last}")) -> str:
    """Return parts as they stand in a sentence: "A, B and C".  most : that are named, others are counted; 0 for all"""
    if 0 < most < len(parts):
        parts = [*parts[:most], said("{count} more", count=len(parts) - most)]
    if len(parts) < 2:
        return parts[0] if parts else ""
    return said(form, first=listed(", ", parts[:-1]), last=parts[-1])


def capital(text: str) -> str:
    """Return a text with a capital at its beginning, in every language."""
    begun = Said(text[:1].upper() + text[1:])
    if isinstance(text, Said):
        begun.forms, begun.form, begun.values, begun.raised = text.forms, text.form, text.values, True
    return begun


def again(text: str) -> str:
    """Return a text in the language that is spoken now; one that nobody has said stays as it is."""
    if not isinstance(text, Said) or not (text.forms or text.form):
        return text
    made = _made(text.forms, text.form, text.values)
    return capital(made) if text.raised else made


def resaid(thing: _Thing) -> _Thing:
    """Return a document or plain data with every text in it said in the language that is spoken now."""
    if type(thing) in _SILENT:
        return thing
    found: Any = thing
    if isinstance(thing, Said):
        found = again(thing)
    elif hasattr(thing, "model_copy"):  # a document of pydantic, which nothing loads for this
        spoken = {name: resaid(value) for name, value in found if type(value) not in _SILENT}
        new = {name: said for name, said in spoken.items() if said is not getattr(thing, name)}
        found = thing.model_copy(update=new) if new else thing
    elif isinstance(thing, dict):
        both = [*thing, *thing.values()]
        each = resaid(both)
        found = thing if each is both else dict(zip(each[: len(thing)], each[len(thing) :], strict=True))
    elif isinstance(thing, (list, tuple)) and not (hasattr(thing, "_fields") or _SILENT.issuperset(map(type, thing))):
        new_items = [resaid(each) for each in thing]
        found = thing if all(map(operator.is_, new_items, thing)) else type(thing)(new_items)
    return cast("_Thing", found)


def messages(language: str) -> dict[str, str]:
    """Return the messages of a language by the English ones, for the page; none for English itself."""
    catalogue: dict[str, str] = getattr(_catalogue(language), "_catalog", {})
    return {english: words for english, words in catalogue.items() if isinstance(english, str) and english}


@contextmanager
def setting(variable: ContextVar[_Thing], value: _Thing) -> Iterator[None]:
    """Let a variable have a value inside of the block, for this thread alone."""
    before = variable.set(value)
    try:
        yield
    finally:
        variable.reset(before)


def speaking(language: str) -> AbstractContextManager[None]:
    """Speak a language inside of the block."""
    return setting(_SPOKEN, language)


def spoken_now() -> str:
    """Return the language that is spoken, by its short name."""
    return _SPOKEN.get()


def decimals(text: str) -> str:
    """Return a number as it is written in the language that is spoken."""
    return text.replace(".", DECIMALS[_SPOKEN.get()])


def ending(lines_of: Mapping[str, Sequence[str]]) -> Iterator[str]:
    """Yield commands and files below each other, behind what they are."""
    width = max(len(word) for word in lines_of)
    for word, lines in lines_of.items():
        for number, line in enumerate(lines):
            yield f"{'' if number else word:{width}}  {line}"


class _Filling(Formatter):
    """Fills names in, numbers as they are written in the language that is spoken."""

    def format_field(self, value: Any, format_spec: str) -> str:
        """Return one value as text."""
        shown: str = format(value, format_spec)
        if not isinstance(value, float):
            return shown
        if "e+" in shown and abs(value) < _LONG:
            shown = f"{float(shown):.0f}"
        return decimals(f"{shown[:-1]} %" if shown.endswith("%") else shown)


_FILLING = _Filling()


def _made(forms: tuple[str, ...], form: str, values: Mapping[str, object]) -> Said:
    """Return a text in the language that is spoken now, and remember what it is made of."""
    catalogue = _catalogue(_SPOKEN.get())
    if len(forms) == 2:
        words = catalogue.ngettext(*forms, cast("int", values["count"]))
    else:
        words = catalogue.gettext(forms[0]) if any(forms) else form  # of "" the catalogue has its own head
    shown = {name: again(value) if isinstance(value, Said) else value for name, value in values.items()}
    text = Said(_FILLING.vformat(words, (), shown) if shown else words)
    text.forms, text.form, text.values = forms, form, values
    return text


@cache
def _catalogue(language: str) -> gettext.NullTranslations:
    if language == "en":
        return gettext.NullTranslations()
    with resources.files("axiscal.language").joinpath("translations", f"{language}.mo").open("rb") as file:
        return gettext.GNUTranslations(file)
