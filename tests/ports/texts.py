"""Studies as texts, small enough to be run in a test."""

from __future__ import annotations

from pathlib import Path

from tests.generators.texts import campaign_text, setup_text

CAMPAIGN = campaign_text(
    "one-axis",
    setup_text("laser", "interferometer", direction="x", approach="both", noise="0.5 um", setup_time="10 min"),
    setup_text("dial", "indicator", direction="x", moves=["X"], approach="both"),
    target={"rms": "3 um"},
    usual="off",
    sure="exactly",
)
STUDY = """[study]
campaign = "campaign.toml"
machines = 2
stop = { readings = 6 }
[grid]
"setups" = [["laser"], ["laser", "dial"]]
"""


def written(folder: Path, study: str = STUDY, campaign: str = CAMPAIGN) -> Path:
    """Write a study beside its campaign and return its file."""
    (folder / "campaign.toml").write_text(campaign)
    file = folder / "study.toml"
    file.write_text(study)
    return file
