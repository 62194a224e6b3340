"""The language of the person at the machine: English sentences in the code, other languages from one file each.

`guide/languages/de.po` is what a translator edits; `make languages` writes `de.mo` and what the page reads beside it.
"""

from __future__ import annotations

import gettext
import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from importlib import resources

from axiscal.exceptions import InputError

LANGUAGES = {"en": "English", "de": "Deutsch"}
"""Those there are, each by its own name."""
_SPOKEN = ContextVar("language", default="en")


def said(message: str, /, **values: object) -> str:
    """Return a message in the language that is spoken now, its {names} filled in."""
    return _catalogue(_SPOKEN.get()).gettext(message).format(**values)


def counted(one: str, many: str, count: int, /, **values: object) -> str:
    """Return the message for one or for many, {count} and the other {names} filled in."""
    return _catalogue(_SPOKEN.get()).ngettext(one, many, count).format(count=count, **values)


def messages(language: str) -> dict[str, str]:
    """Return the messages of a language by the English ones, for the page; none for English itself."""
    catalogue: dict[str, str] = getattr(_catalogue(language), "_catalog", {})
    return {english: words for english, words in catalogue.items() if isinstance(english, str) and english}


@contextmanager
def speaking(language: str) -> Iterator[None]:
    """Speak a language inside of the block."""
    before = _SPOKEN.set(language)
    try:
        yield
    finally:
        _SPOKEN.reset(before)


def chosen(name: str | None) -> str:
    """Return the language of the person: the one that is named, else AXISCAL_LANGUAGE, else that of the computer.

    Raises InputError for a name that is none of LANGUAGES; a computer in a language that is missing speaks English.
    """
    if named := name or os.environ.get("AXISCAL_LANGUAGE"):
        if named not in LANGUAGES:
            known = ", ".join(f"{short} ({long})" for short, long in LANGUAGES.items())
            raise InputError(f'"{named}" is no language of the page and the prompt', f"There are {known}")
        return named
    usual = (os.environ.get(variable, "") for variable in ("LC_ALL", "LC_MESSAGES", "LANG"))
    computers = next((value[:2] for value in usual if value), "en")
    return computers if computers in LANGUAGES else "en"


@cache
def _catalogue(language: str) -> gettext.NullTranslations:
    if language == "en":
        return gettext.NullTranslations()
    with resources.files("axiscal.guide").joinpath("languages", f"{language}.mo").open("rb") as file:
        return gettext.GNUTranslations(file)
