"""A board of balls, put down twice on a gantry of joints XYYZ that LinuxCNC moves: asked for, and found where it is."""

from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.sources.source import Answer, Request
from axiscal.cli.app import run
from axiscal.description.campaign import read_campaign
from axiscal.measurement.candidates import spread
from axiscal.numerics import Array
from axiscal.ports.linuxcnc.live import InForce, LiveSource
from axiscal.ports.linuxcnc.live.connection import Connection
from tests.linuxcnc.bench import Bench, quickened, running
from tests.linuxcnc.lab import Joint, Settings, files
from tests.linuxcnc.needed import WITH_SPHERES

pytestmark = WITH_SPHERES

GANTRY = [Joint(axis, low, high, 2000.0, 5e4) for axis, low, high in (
    ("X", 0.0, 600.0), ("Y", 0.0, 400.0), ("Y", 0.0, 400.0), ("Z", -200.0, 0.0)
)]  # fmt: skip
TOOL, RADIUS = 100.0, 15.5
"""mm, as `init` writes them."""
HAL = "\n".join(
    ["loadrt axiscal_balls", "addf axiscal-balls servo-thread", f"setp axiscal-balls.tool {TOOL}"]
    + [f"net j{joint}m => axiscal-balls.{axis}" for joint, axis in ((0, "x"), (1, "y"), (3, "z"))]
    + [f"setp axiscal-balls.radius {RADIUS}", "net probe axiscal-balls.touched => motion.probe-input", ""]
)
SQUARE = 80e-6
"""rad: by so much Y leans towards -x."""


def placed(bench: Bench, stated: Array, shift: Array) -> Array:
    """Put the board down aside of where it is stated, and return what is read of each ball, (8, 3) mm.

    The gantry's probe meets a ball where it stands less the machine's own deviation there.
    """
    stands = stated + shift
    found = stands + np.outer(stands[:, 1], [SQUARE, 0.0, 0.0])
    for number, place in enumerate(found.tolist()):
        for axis, at in zip("xyz", place, strict=True):
            bench.pin(f"b{axis}{number}", at)
    return stated - found


def test_a_board_is_asked_for_before_each_placement_and_found_where_it_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ini = tmp_path / "router.ini"
    ini.write_text(files(GANTRY, Settings(HAL))["machine.ini"])
    assert (
        run(["init", str(tmp_path / "router"), "--from", str(ini), "--instrument", "sphere", "--target", "30 um"]) == 0
    )
    campaign = read_campaign(tmp_path / "router" / "campaign.toml")
    assert len(campaign.setups) == 5
    assert campaign.machine.tool_length == TOOL / 1e3
    boards = [1e3 * setup.artefact.points for setup in campaign.setups if setup.artefact is not None]
    asked, heights = list[str](), list[float]()
    with running(HAL, GANTRY) as bench:
        quickened(monkeypatch, tmp_path)
        monkeypatch.setattr(Connection, "watched", lambda *_: "")
        expected = placed(bench, boards[0], np.array([0.4, -0.3, 0.2]))

        def answered(text: str) -> str:
            nonlocal expected
            asked.append(text)
            if text.startswith("Put it down"):
                heights.append(float(bench.says("print(s.position[2])")))
                expected = placed(bench, boards[1], np.array([-0.6, 0.2, 0.1]))
            return "go" if "Step" in text else ""

        source = LiveSource(Connection(bench.words()), campaign.machine, InForce(), asked=answered)
        for number, setup in enumerate(campaign.setups[:2]):
            lattice = spread(campaign.machine, (setup,), 8)
            ball = 2 * number
            pose, side = lattice.poses[ball], lattice.approaches[ball].astype(int)
            answer = source.read(Request(1, setup, campaign.machine.axes, tuple(pose.tolist()), tuple(side.tolist())))
            assert isinstance(answer, Answer)
            np.testing.assert_allclose(1e3 * np.array([answer.value, *answer.others]), expected[ball], atol=2e-3)
        source.close()
    assert ["Put it down: board at 408 mm, 209 mm, -211 mm" in text for text in asked].count(True) == 1
    assert heights == [pytest.approx(-1.0)]
