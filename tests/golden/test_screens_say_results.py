"""Screens of golden campaigns, in both languages, and the `result.json` beside them: the same rows and figures."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.golden.__main__ import EXPECTED
from tests.golden.given import names

ROUNDED = 0.051
"""Half of the last of two digits, where the first is 1."""


def written(campaign: str) -> Iterator[tuple[list[str], list[dict[str, object]]]]:
    """Yield each screen of results that were written, as its lines, with the measured rows of their document."""
    folder = EXPECTED / campaign
    for screens in (folder / "screens.txt", folder / "de" / "screens.txt"):
        blocks = screens.read_text(encoding="utf-8").split("$ axiscal ") if screens.is_file() else []
        for block in blocks:
            command, _, said = block.partition("\n")
            found = re.match(r"(?:estimate|finish|run|demo) .*--out (\S+)", command)
            document = folder / found[1] / "result.json" if found else Path("none")
            if document.is_file() and "±" in said:
                rows = json.loads(document.read_text(encoding="utf-8"))["rows"]
                yield said.splitlines(), [row for row in rows if row["measured"]]


def figures(line: str) -> list[float]:
    """Return the numbers behind the name of a row."""
    cells = re.split(r" {2,}", line.strip(), maxsplit=1)[1]
    return [float(each.replace(",", ".")) for each in re.findall(r"(?<![A-Za-z])[0-9]+(?:[.,][0-9]+)?", cells)]


@pytest.mark.parametrize("campaign", names())
def test_a_screen_shows_the_rows_of_the_result(campaign: str) -> None:
    for said, rows in written(campaign):
        heads = next(line for line in said if line.startswith("   ") and not line.strip()[0].isdigit())
        lines = [line for line in said if line.startswith("  ") and "±" in line and "(" not in line]
        shown = rows if len(lines) == len(rows) else rows[-1:]  # others stand together; the volume is alone
        for line, row in zip(lines[-len(shown) :], shown, strict=True):
            left = row["left"]
            assert isinstance(left, dict)
            limit = [] if row["limit"] is None else [row["limit"]]
            controls = [left[name] for name in re.findall(r"[a-z][a-z-]+$|[a-z-]{4,}(?=  )", heads) if name in left]
            assert figures(line) == pytest.approx([row["found"], row["known_to"], *limit, *controls], rel=ROUNDED)


def test_most_campaigns_write_results_on_a_screen_in_both_languages() -> None:
    assert sum(len(list(written(campaign))) for campaign in names()) >= 2 * 20
