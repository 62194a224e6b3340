"""Screens of golden campaigns, in both languages, and the `result.json` beside them: the same rows and figures."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.golden.__main__ import EXPECTED
from tests.golden.given import names
from tests.golden.surfaces import Shown, differing, written_screens


def written(campaign: str) -> Iterator[tuple[Shown, dict[str, Any]]]:
    """Yield each screen of results that were written, with their document."""
    folder = EXPECTED / campaign
    for path in (folder / "screens.txt", folder / "de" / "screens.txt"):
        for out, screen in written_screens(path.read_text(encoding="utf-8") if path.is_file() else ""):
            document = Path(folder, out, "result.json")
            if document.is_file():
                yield screen, json.loads(document.read_text(encoding="utf-8"))


@pytest.mark.parametrize("campaign", names())
def test_a_screen_shows_the_rows_of_the_result(campaign: str) -> None:
    for screen, document in written(campaign):
        assert list(differing(screen, document["rows"], document["answer"])) == []


def test_most_campaigns_write_results_on_a_screen_in_both_languages() -> None:
    assert sum(len(list(written(campaign))) for campaign in names()) >= 2 * 20
