"""A check with spheres that the machine touches itself: where it goes, what may be in force, and what is kept."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.sources.source import Answer, Request, SimulatedSource, Skip, Source
from axiscal.description.campaign import campaign_from_texts
from axiscal.evaluation.check import Check, Sheet, requests
from axiscal.exceptions import SourceError, TableError
from axiscal.measurement.reading import Places
from axiscal.measurement.simulation import Simulator
from axiscal.ports.linuxcnc import live as linuxcnc_live
from axiscal.ports.linuxcnc.live import InForce
from axiscal.tables.surface import CommandedMachine
from tests.commands import Command
from tests.evaluation.said import measured
from tests.generators import touched_table as table

pytestmark = pytest.mark.long

SEED = 3
CONTROL = "linuxcnc-volumetric"
CAMPAIGN = 'tool_length = "1 um"\ntool_eccentricity = "0.5 um"\n' + table.CAMPAIGN
READY: dict[str, Any] = {"compensated": [], "whole": None, "checksum": None}


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    description = campaign_from_texts(CAMPAIGN, "c.toml", table.MACHINE, "m.toml")
    return measured(tmp_path_factory.mktemp("touched") / "m.axiscal", description, SEED)


@pytest.fixture(scope="module")
def check(record: Path) -> Check:
    with Campaign.open(record, write=False) as campaign:
        return Check.from_campaign(campaign, CONTROL)


def tips(check: Check, places: Places) -> list[float]:
    """How far each place is from the next ball, mm."""
    axes, far = check.description.machine.axes, list[float]()
    for pose in places.poses:
        named = zip(axes, pose, strict=True)
        at = {axis.name: float(np.degrees(value) if axis.rotary else 1e3 * value) for axis, value in named}
        tip = table.tip(at, table.STATED)
        far.append(min(float(np.linalg.norm(tip - np.array(ball))) for ball in table.BALLS.values()))
    return far


def test_every_place_is_at_a_ball_and_none_comes_twice(check: Check) -> None:
    for count in (None, 4, 16):
        places = check.planned(count)
        assert max(tips(check, places)) < 1e-3
        assert len({(*pose, *sides) for pose, sides in zip(places.poses, places.approaches, strict=True)}) == len(
            places
        )


class Machine:
    """The simulated machine in place of one that runs, with the files loaded or not."""

    def __init__(self, check: Check, monkeypatch: pytest.MonkeyPatch) -> None:
        self.check, self.asked, self.dies_at = check, list[tuple[bool, int]](), 10**6
        monkeypatch.setattr(linuxcnc_live, "attached_to", self.attached)
        description = check.description
        self.truth = Simulator(description.machine, description.setups).drawn(SEED)

    def attached(self, host: str, _: object, in_force: InForce) -> Source:
        assert host == "mill.local"
        compensated = CommandedMachine.behind(self.truth, self.check.tables.control)
        inner, outer = SimulatedSource(compensated if in_force.active else self.truth, SEED), self

        class Here:
            def read(self, request: Request) -> Answer:
                outer.asked.append((in_force.active, request.reading))
                if len(outer.asked) == outer.dies_at:
                    raise SourceError("LinuxCNC: {message}", "Look at the machine", message="cut")
                answer = inner.read(request)
                assert isinstance(answer, Answer)
                return answer

            def close(self) -> None:
                pass

        return Here()


def words(record: Path, found: Path, left: Path, points: int) -> list[object]:
    """Return a check at the machine as a person asks for it."""
    source = ["--source", "linuxcnc-live:mill.local", "--tolerance", "20 um"]
    return ["verify", record, "--to", CONTROL, *source, "--found", found, "--left", left, "--points", points]


def test_a_check_is_read_in_two_commands_and_goes_on_where_it_was_cut(
    record: Path, check: Check, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command
) -> None:
    machine, asked = Machine(check, monkeypatch), words(record, tmp_path / "found.csv", tmp_path / "left.csv", 8)
    machine.dies_at = 4
    command(*asked).refused("3 of 8 readings are kept in", "go on with the same command")
    assert "give the same command again" in command(*asked).printed
    assert machine.asked == [(False, n) for n in (1, 2, 3, 4, 4, 5, 6, 7, 8)]
    judged = command(*asked, "--json").document
    assert machine.asked[9:] == [(True, n) for n in range(1, 9)]
    assert judged["verdict"] == "promised"
    assert judged["tables_loaded"]
    assert judged["decision"] == "conform"
    assert 0 < judged["U_um"] < judged["guard_band_um"] * 1.3
    command(*asked[:-1], 6).refused("other")
    assert len(machine.asked) == 17


def test_a_place_that_a_machine_does_not_reach_is_said(check: Check, tmp_path: Path) -> None:
    class Source:
        def read(self, _: Request) -> Skip:
            return Skip("touching leaves the travel of Y")

        def close(self) -> None:
            pass

    wanted = requests(check.description, check.planned(4).listed(check.description.setups))
    sheet = Sheet(tmp_path / "found.csv", check.description, wanted)
    with pytest.raises(SourceError, match=r"leaves the travel of Y.*another number of --points"):
        sheet.fill(Source)


def test_the_standard_deviation_of_a_reading_is_kept_in_the_file(check: Check, tmp_path: Path) -> None:
    """The first readings are of a machine that says none, as in files of before; the file goes on with the others."""
    wanted = requests(check.description, check.planned(4).listed(check.description.setups))
    stds = [None, None, 0.7e-6, 1.25e-7]

    class Source:
        def read(self, request: Request) -> Answer:
            number = wanted.index(request)
            return Answer(1e-6 * number, stds[number], (2e-6, -3e-6))

        def close(self) -> None:
            pass

    file = tmp_path / "found.csv"
    for some in (2, 4):
        Sheet(file, check.description, wanted[:some]).fill(Source)
        assert file.read_text().splitlines()[0].endswith("std_um") == (some == 4)
    held = Sheet(file, check.description, wanted).held()
    assert [each.std for each in held] == [None, None, *map(pytest.approx, stds[2:])]
    assert held[3].values == pytest.approx((3e-6, 2e-6, -3e-6))


@pytest.mark.parametrize(
    ("file", "why", "status"),
    [("nowhere/found.csv", "nothing can be written there", 1), ("left.csv", "are one file", 2)],
)
def test_what_would_end_a_check_later_is_said_before_anything_moves(
    record: Path, check: Check, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command,
    file: str, why: str, status: int,
) -> None:  # fmt: skip
    machine = Machine(check, monkeypatch)
    said = command(*words(record, tmp_path / file, tmp_path / "left.csv", 4))
    assert (said.status, why in " ".join(said.err.split())) == (status, True)
    assert machine.asked == []


def test_balls_that_are_placed_by_hand_are_judged_against_themselves(check: Check, record: Path) -> None:
    """The places of the balls, 50 um each, would hide 20 um otherwise; a missing file is seen all the same."""
    places = check.planned(12)
    right = check.asked(f"sim:{SEED}", places)
    assert check.judged(right, "20 um").decision == "conform"
    found, _ = right
    assert check.judged((found, found), "20 um").verdict == "faulty"


def test_what_is_to_be_in_force_is_what_was_exported(check: Check, tmp_path: Path) -> None:
    for name, text in check.tables.files.items():
        (tmp_path / name).write_text(text)
    wanted = InForce.from_folder(tmp_path)
    assert wanted.checksum is not None
    there = READY | {"whole": True, "checksum": str(wanted.checksum)}
    wanted.refuse(there)
    wanted.refuse(there | {"checksum": hex(wanted.checksum)})
    for other, why in (
        (
            {"checksum": None},
            r"in force is axiscal-vcomp \(axiscal-vcomp.checksum: -\), and it is to be axiscal-vcomp, 0x",
        ),
        ({"checksum": "17"}, "checksum: 17"),
        ({"whole": False}, "in force is nothing"),
        ({"compensated": [1]}, "in force is COMP_FILE or BACKLASH of joint 1 and axiscal-vcomp"),
    ):
        with pytest.raises(SourceError, match=why):
            wanted.refuse(there | other)


def test_nothing_or_anything_may_be_in_force(tmp_path: Path) -> None:
    InForce().refuse(READY)
    InForce(True).refuse(READY | {"compensated": [0]})
    InForce(True).refuse(READY | {"whole": True})
    with pytest.raises(TableError, match="no file for LinuxCNC"):
        InForce.from_folder(tmp_path)
    (tmp_path / "X.comp").touch()
    assert InForce.from_folder(tmp_path) == InForce(True)
    for wanted, status in ((InForce(), {"whole": True}), (InForce(), {"compensated": [0]}), (InForce(True), {})):
        with pytest.raises(SourceError):
            wanted.refuse(READY | status)
