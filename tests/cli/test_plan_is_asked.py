"""The plan that is printed is the plan that is asked for: the same places from the same sides, in the same order."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from axiscal.cli.app import run
from tests.generators.texts import FOUR_READINGS

MILL = (Path(__file__).parents[1] / "golden" / "campaigns" / "mill" / "campaign.toml").read_text()
DRIFT = """
machine = "one-axis"
[target]
readings = 4
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
approach = "both"
reading_time = "8 min"
drift = "6 um/h"
"""


@pytest.mark.long
@pytest.mark.parametrize("text", [MILL, FOUR_READINGS, DRIFT], ids=["mill", "four readings", "drift"])
def test_places_are_asked_in_the_order_in_which_they_are_printed(
    text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("campaign.toml").write_text(text)

    def said(*words: str) -> Any:
        assert run(words) == 0
        return json.loads(capsys.readouterr().out)

    planned = said("plan", "campaign.toml", "--json")["points"]
    assert len(planned) >= 3
    said("start", "campaign.toml", "--json")
    for point in planned:
        question = said("next", "campaign.axiscal", "--json")["question"]
        assert [question[key] for key in ("setup", "position", "approach")] == [
            point[key] for key in ("setup", "position", "approach")
        ]
        said("record", "campaign.axiscal", "0 um", "--json")
