"""A program in touch on LinuxCNC's own kinematics, switched as its configurations do: the ball stays where it is."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.measurement.candidates import chart_candidates
from axiscal.measurement.reading import Place
from axiscal.ports.linuxcnc.tables import pivots
from axiscal.programs import Program, dialect, programs
from tests.generators.texts import artefact_text, campaign_text, setup_text
from tests.linuxcnc import tilting_table
from tests.linuxcnc.lab import Joint, Session, Settings
from tests.linuxcnc.needed import LONG
from tests.linuxcnc.test_direction import machine

pytestmark = LONG

BALL = (60.0, -20.0, -60.0)
CAMPAIGN = campaign_text(
    "machine.toml",
    artefact_text("ball", balls={"one": ["60 mm", "-20 mm", "-60 mm"]}),
    setup_text("nest", "rtest", artefact="ball", approach="both", stroke="5 mm"),
)
SWITCHED = {"M428": ["M68 E3 Q1", "M66 E0 L0"], "M429": ["M68 E3 Q0", "M66 E0 L0"]}
"""What the remapped words do in LinuxCNC's own configurations."""


def description(swivel: str) -> CampaignDescription:
    text = machine(swivel, 'direction = "reversed"')
    return campaign_from_texts(CAMPAIGN, "campaign.toml", text, "machine.toml")


def program(campaign: CampaignDescription) -> tuple[Program, list[Place]]:
    (setup,) = campaign.setups
    assert setup.chart is not None
    poses, approaches = chart_candidates(campaign.machine, setup, setup.chart, 12)
    sides = approaches.astype(int).tolist()
    places = [Place(setup.name, tuple(p), tuple(s)) for p, s in zip(poses.tolist(), sides, strict=True)]
    (made,) = programs(campaign.machine, campaign.setups, places, dialect("linuxcnc"))
    return made, places


def codes(text: str) -> list[str]:
    """Return the lines for MDI, as fast as can be: without stops, and without the program's own question."""
    text = re.sub(r" F\d+", " F60000", text)
    asked = re.sub(r"O(1\d0) IF.*?O\1 ENDIF\n", "", text, flags=re.DOTALL)
    lines = [line for line in asked.splitlines() if line not in ("M0", "M2") and not line.startswith("(MSG")]
    return [code for line in lines for code in SWITCHED.get(line, [line])]


@pytest.mark.parametrize("swivel", ["A", "B"])
def test_the_tool_point_stays_at_its_ball_on_the_running_control(swivel: str) -> None:
    campaign = description(swivel)
    made, places = program(campaign)
    names = [*"XYZ", swivel, "C"]
    joints = [Joint(name, -500.0, 500.0) for name in names]
    nominal = pivots.pivots(campaign.machine, {})
    hal = pivots.write(nominal, "mm")
    hal += f"net tool-length motion.tooloffset.z => {nominal.kinematics}.tool-offset\n"
    hal += "net kinstype-select motion.analog-out-03 => motion.switchkins-type\n"
    lines = codes(made.text)
    with Session(joints, Settings(hal, f"{nominal.kinematics} sparm=identityfirst")) as session:
        steps = [step for line in lines for step in session.move([line])]
        assert session.errors == ()
    at_ball = held = 0
    stood: list[float] = []
    read: list[dict[str, float]] = []
    for line, step in zip(lines, steps, strict=True):
        drives = dict(zip(names, step.motor, strict=True))
        off = float(np.linalg.norm(np.subtract(tilting_table.tip(swivel, drives), BALL)))
        if not re.match(r"(G53 )?G1 ", line) and stood:  # nothing but a move moves, not even by a switch
            np.testing.assert_allclose(step.motor, stood, atol=1e-9)
        stood = list(step.motor)
        held += line == "M68 E3 Q1"
        if line.startswith("(READING "):
            assert off < 1e-6  # mm: a nanometre
            read.append(drives)
        at_ball += line.startswith("G1 ") and off < 1e-6
    assert held >= 1
    assert at_ball > len(places)
    for drives, place in zip(read, places, strict=True):
        for axis, planned in zip(campaign.machine.axes, place.pose, strict=True):
            assert drives[axis.name] == pytest.approx(np.degrees(planned) if axis.rotary else 1e3 * planned, abs=2e-4)


@pytest.mark.skipif(shutil.which("rs274") is None, reason="LinuxCNC's interpreter is not installed")
@pytest.mark.parametrize("offset", [0.0, 0.5])
def test_the_interpreter_reads_it_and_ends_where_an_offset_is_in_force(offset: float, tmp_path: Path) -> None:
    made, _ = program(description("A"))
    for word in ("m428", "m429"):
        (tmp_path / f"{word}.ngc").write_text(f"o<{word}> sub\no<{word}> endsub\nM2\n")
    remaps = "".join(f"REMAP = {word.upper()} modalgroup=10 ngc={word}\n" for word in ("m428", "m429"))
    (tmp_path / "m.ini").write_text(f"[RS274NGC]\nSUBROUTINE_PATH = {tmp_path}\n{remaps}")
    (tmp_path / "p.ngc").write_text(f"G10 L2 P1 X{offset}\n{made.text}")
    done = subprocess.run(
        ["rs274", "-g", "-i", "m.ini", "p.ngc"], cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    feeds = done.stdout.count("STRAIGHT_FEED")
    held = len(re.findall(r"USE_TOOL_LENGTH_OFFSET\(.*80\.0000", done.stdout))
    moves = sum(1 for line in made.text.splitlines() if re.match(r"(G53 )?G1 ", line))
    assert (held > 0, feeds == moves) == (offset == 0.0, offset == 0.0)
