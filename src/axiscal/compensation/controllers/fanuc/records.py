"""The punched file: records `N<number>[Q<page>][A<axis>]P<value>[A<axis>P<value>…];` between % and %."""

from __future__ import annotations

import re
from collections.abc import Mapping

from axiscal.exceptions import TableError

EXPECTED = (
    "punch parameters and pitch data from the control: records like N10000P0; between % and %, with N3620 to N3624 for "
    "each axis as N3620A1P100A2P200;"
)
_RECORD = re.compile(r"N0*(\d+)(Q\d+)?((?:[A-Z]\d*)?P-?[\d.]+(?:[A-Z]\d*P-?[\d.]+)*)(\s*;?)")
_VALUE = re.compile(r"(?:A(\d+))?P(-?[\d.]+)")

Records = dict[int, dict[int, str]]
"""Number of the record -> axis number, 0 where there is none -> value."""


def read_records(text: str, file: str) -> Records:
    """Return the values of each record; raises TableError."""
    body = text.strip()
    if not (body.startswith("%") and body.endswith("%") and len(body) > 1):
        raise TableError("this is not a punched file: it does not begin and end with %", EXPECTED, file)
    found: Records = {}
    for number, line in enumerate(text.splitlines(), 1):
        plain = line.strip()
        if not plain.startswith("N"):
            continue
        match = _RECORD.fullmatch(plain)
        if match is None:
            raise TableError(f"{plain[:40]!r} is not a record", EXPECTED, file, number)
        found.setdefault(int(match[1]), {}).update({int(a or 0): v for a, v in _VALUE.findall(match[3])})
    return found


def replace_values(text: str, wanted: Mapping[tuple[int, int], int], file: str) -> str:
    """Return the text with values replaced; all else stays.

    wanted : (number of the record, axis number or 0) -> value
    Raises TableError for a value that the file has no place for.
    """
    seen: set[tuple[int, int]] = set()

    def replaced(record: re.Match[str]) -> str:
        number, begin = int(record[1]), record.start(3) - record.start()

        def value(found: re.Match[str]) -> str:
            place = (number, int(found[1] or 0))
            if place not in wanted:
                return found[0]
            seen.add(place)
            return f"{found[0][: found.start(2) - found.start()]}{wanted[place]}"

        return record[0][:begin] + _VALUE.sub(value, record[3]) + record[4]

    filled = _RECORD.sub(replaced, text)
    if missing := sorted(wanted.keys() - seen):
        more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        raise TableError(f"there is no row N{missing[0][0]}{more}", EXPECTED, file)
    return filled
