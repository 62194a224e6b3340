"""Words that are safe in any program: what a person wrote stays a comment or a name, whatever it was."""

from __future__ import annotations

import re
import unicodedata

LONGEST = 60
"""Characters of a remark that every control shows."""


def plain(text: str) -> str:
    """Return at most 60 characters of A-Z 0-9 blank _ . + - ; any other character becomes _."""
    bare = unicodedata.normalize("NFKD", text.upper()).upper()
    ascii_only = "".join(c for c in bare if not unicodedata.combining(c))
    return re.sub(r"[^A-Z0-9 _.+-]", "_", ascii_only)[:LONGEST].strip()


def program_name(number: int, setup: str, longest: int) -> str:
    """Return the name of a program, which is its file's too: letters, digits, single underscores."""
    words = re.sub(r"[^A-Z0-9]+", "_", plain(setup)).strip("_")
    return f"AXISCAL_{number:02d}_{words}"[:longest].rstrip("_")
