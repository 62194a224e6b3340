"""What a reader of one command has to hold in mind. It can only go down, as the sizes in `tools/size.toml` do."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CAMPAIGNS = ROOT / "tests" / "golden" / "campaigns"
WALKS = {
    "record asked.axiscal 1um": {"files": 90, "functions": 615, "statements": 2418},
    "estimate campaign.toml readings.csv --out out": {"files": 165, "functions": 1324, "statements": 5426},
}
"""What a command enters at most: of the campaign `mill`, and of `five_axes`."""
PLAY = 1.03
"""A first change of a stranger adds a function or two without being red."""


def _walked(folder: Path, command: str) -> dict[str, int]:
    program = [sys.executable, "-m", "tests.docs.walked", str(folder), *command.split()]
    said = subprocess.run(program, check=True, capture_output=True, text=True, cwd=ROOT).stdout
    counts: dict[str, int] = json.loads(said)
    return counts


def _begun(folder: Path) -> None:
    """Begin a record, and ask for a reading."""
    for command in ("start campaign.toml asked.axiscal", "next asked.axiscal"):
        _walked(folder, command)


@pytest.mark.long
@pytest.mark.parametrize(("command", "campaign"), [*zip(WALKS, ("mill", "five_axes"), strict=True)])
def test_a_command_walks_no_farther_than_it_did(tmp_path: Path, command: str, campaign: str) -> None:
    folder = shutil.copytree(CAMPAIGNS / campaign, tmp_path / campaign)
    if command.startswith("record"):
        _begun(folder)
    found, most = _walked(folder, command), WALKS[command]
    assert {name: count for name, count in found.items() if count > PLAY * most[name]} == {}
