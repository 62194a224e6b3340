"""Figures and sentences as text, with units as people write them."""

from __future__ import annotations

import re

from axiscal.language.spoken import WORDS, later, said

U_OF_TABLES = later("U of the tables: U² of the volume and (k times what they leave)² add up to its square.")

_SHOWN = {"um": "µm", "urad": "µrad", "degC": "°C"}
_UNIT = re.compile(r"(?<=[0-9])[ \u00a0](?:(um|urad|degC)\b|%)")
_NO_BREAK = "\u00a0"


def spelt(text: str) -> str:
    """Return a sentence with the units of its numbers as people write them; "um" is a word in other languages."""
    return _UNIT.sub(lambda found: _NO_BREAK + _SHOWN.get(found[1], "%"), text)


_CAUSES = WORDS["type_b"]


def cause_words(name: str, owner: str) -> str:
    """Return a cause in words.  name : of its row; owner : the instrument or set-up that it belongs to, if any"""
    return said(_CAUSES[name], owner=said(owner) if owner else "")
