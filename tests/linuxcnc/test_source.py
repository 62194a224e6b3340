"""A campaign whose readings come through LinuxCNC: the same truth as without it, kept and resumed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from axiscal.cli.app import run
from axiscal.ports.linuxcnc.lab import available
from tests.generators.texts import campaign_text, setup_text

pytestmark = [
    pytest.mark.linuxcnc,
    pytest.mark.long,
    pytest.mark.skipif(not available(), reason="Debian package linuxcnc-uspace is not installed"),
]

CAMPAIGN = campaign_text(
    "one-axis", setup_text("laser", "interferometer", direction="x", approach="both"), target={"readings": 6}
)


def result(folder: Path) -> dict[str, object]:
    found: dict[str, object] = json.loads((folder / "result.json").read_text())
    return found


THREE_VALUES = campaign_text(
    "three-axis-mill", setup_text("afar", "tracker", station=["300 mm", "-900 mm", "0 mm"]), target={"readings": 6}
)


@pytest.mark.parametrize("campaign", [CAMPAIGN, THREE_VALUES], ids=["laser", "tracker"])
def test_linuxcnc_and_the_plain_simulation_give_the_same_campaign(campaign: str, tmp_path: Path) -> None:
    """Without tables LinuxCNC goes where it is told: to a nanometre the readings, and so the estimate, are the same."""
    (tmp_path / "c.toml").write_text(campaign)
    for source in ("linuxcnc:5", "sim:5"):
        out = tmp_path / source.partition(":")[0]
        assert run(["run", str(tmp_path / "c.toml"), "--source", source, "--out", str(out)]) == 0
    through, plain = result(tmp_path / "linuxcnc"), result(tmp_path / "sim")
    assert through["readings"] == plain["readings"] == 6
    for name, curve in plain["errors"].items():  # type: ignore[attr-defined]
        other = through["errors"][name]  # type: ignore[index]
        assert other["mean"] == pytest.approx(curve["mean"], abs=5e-3)


def test_a_run_goes_on_after_it_was_stopped(tmp_path: Path) -> None:
    (tmp_path / "c.toml").write_text(CAMPAIGN)
    arguments = ["run", str(tmp_path / "c.toml"), "--source", "linuxcnc:5", "--out", str(tmp_path / "out")]
    assert run(arguments) == 0
    assert run([*arguments, "--resume"]) == 0
