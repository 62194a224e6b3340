"""The language of the person, or of the page, that a command is given, and who says it where nobody does."""

from __future__ import annotations

import os

from axiscal.exceptions import InputError
from axiscal.language.spoken import LANGUAGES


def named_language(name: str | None) -> str | None:
    """Return the language that somebody names, else that of AXISCAL_LANGUAGE, else None.

    Raises InputError for a name that is none of LANGUAGES.
    """
    named = name or os.environ.get("AXISCAL_LANGUAGE")
    if named and named not in LANGUAGES:
        known = ", ".join(f"{short} ({long})" for short, long in LANGUAGES.items())
        raise InputError('"{named}" is no language that is spoken here', "There are {known}", named=named, known=known)
    return named or None


def chosen(name: str | None) -> str:
    """Return the language of the person: the one that is named, else AXISCAL_LANGUAGE, else that of the computer.

    Raises InputError for a name that is none of LANGUAGES; a computer in a language that is missing speaks English.
    """
    if named := named_language(name):
        return named
    usual = os.environ.get("LC_ALL") or os.environ.get("LC_MESSAGES") or os.environ.get("LANG") or "en"
    computers = usual[:2]
    return computers if computers in LANGUAGES else "en"
