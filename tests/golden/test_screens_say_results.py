"""Screens of golden campaigns beside their documents: a plan has the rows of its document, and U is one figure."""

import json
import re

import pytest

from tests.golden.__main__ import EXPECTED

PLANS = {
    "plans": ("plan campaign.toml --readings 4 --candidates 60\n", "04-plan.json"),
    "programs": ("plan campaign.toml --candidates 40 --gcode linuxcnc", "05-plan.json"),
}
"""Commands that show a plan, and the document of the same plan."""


@pytest.mark.parametrize("campaign", PLANS)
def test_a_screen_shows_the_rows_of_the_plan(campaign: str) -> None:
    command, name = PLANS[campaign]
    said = (EXPECTED / campaign / "screens.txt").read_text(encoding="utf-8").partition(f"$ axiscal {command}")[2]
    text, document = said.partition("\nstatus ")[0], json.loads((EXPECTED / campaign / name).read_text())
    assert f"{document['readings']} READINGS, {document['minutes']:.0f} MIN" in text.replace("readings, ", "READINGS, ")
    rows = {row["row"]: row for row in document["rows"]}
    lines = [line for line in text.splitlines() if line.startswith("  ") and "±" in line]
    assert len(lines) > 2
    for line in lines:
        row = rows[re.split(r" {2,}", line.strip())[0]]
        figures = [float(each) for each in re.findall(r"(?<![A-Za-z])[0-9]+(?:\.[0-9]+)?", line)]
        read = row["measured"] or row["known_to"] < 0.9 * row["known_before"]
        limit = [] if row["limit"] is None or not read else [row["limit"]]
        known = [row["known_to"]] if read else []
        assert figures == pytest.approx([row["known_before"], *known, *limit], rel=0.051)
    mounted = [f'"{each["setup"]}" ({each["readings"]} reading' for each in document["setups"]]
    flat = " ".join(text.partition("Mount in turn")[2].split())
    assert sorted(mounted, key=flat.index) == mounted
    assert document["setups"][-1]["minutes"] == pytest.approx(document["minutes"])


_OF_ANSWER = re.compile(r"U\s+of\s+the\s+estimate\s+is\s+(\S+)\s+um;")
_VOLUME = re.compile(r"^  volume .*± (\S+) um", re.MULTILINE)


@pytest.mark.parametrize("campaign", ["controllers", "plane_map", "printer", "vcomp", "xyzac"])
def test_what_is_said_of_files_repeats_the_uncertainty_of_the_answer(campaign: str) -> None:
    screens = (EXPECTED / campaign / "screens.txt").read_text(encoding="utf-8")
    notes = [path.read_text(encoding="utf-8") for path in (EXPECTED / campaign).rglob("README.txt")]
    assert {size for text in (screens, *notes) for size in _OF_ANSWER.findall(text)} == {*_VOLUME.findall(screens)}
