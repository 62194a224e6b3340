"""A check with instruments that read along x, y and z at once: trackers, and balls of a board."""

import csv
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription
from axiscal.evaluation.check import Check
from axiscal.evaluation.datums import datums_of, upright
from axiscal.evaluation.verification import values_at
from axiscal.exceptions import ReadingError
from axiscal.measurement.reading import Places
from tests.commands import Command
from tests.evaluation.said import measured
from tests.evaluation.test_verification import MACHINE
from tests.generators.campaigns import on
from tests.generators.reaches import reach_of
from tests.generators.texts import machine_text

pytestmark = pytest.mark.long

NEAR = '[[setups]]\nname = "nest"\ninstrument = "tracker"\nnoise = "0.4 um"\nstation = ["0 mm", "-900 mm", "0 mm"]\n'
TRACKER = '[[setups]]\nname = "afar"\ninstrument = "tracker"\nnoise = "1 um"\nstation = ["0 mm", "-900 mm", "0 mm"]\n'
PROBE = '[[setups]]\nname = "along y"\ninstrument = "probe"\ndirection = "y"\nnoise = "0.4 um"\n' + reach_of(MACHINE)
SEED = 5


def _description(*setups: str, machine: str = MACHINE, readings: int = 24) -> CampaignDescription:
    return on(machine, *setups, target={"readings": readings})


@pytest.mark.parametrize(
    ("setup", "noticed"),
    [(NEAR, "WORSE THAN PROMISED"), (TRACKER, "um): not kept")],
    ids=["near", "afar"],
)
def test_the_right_tables_pass_and_another_machine_is_noticed(
    setup: str, noticed: str, tmp_path: Path, command: Command
) -> None:
    """By a tracker afar the machine is known to 4 um, about as large as its errors: another one may agree with that."""
    record = measured(tmp_path / "m.axiscal", _description(setup), SEED)
    said = command("verify", record, "--source", f"sim:{SEED}", "--tolerance", "12 um", "--json").document
    assert (said["verdict"], said["tables_loaded"], said["decision"]) == ("promised", True, "conform")
    assert len(said["readings"]) >= 3 * 12
    assert len(said["readings"]) % 3 == 0
    assert noticed in command("verify", record, "--source", "sim:99", "--tolerance", "12 um").printed


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A record of a tracker along X and a probe."""
    description = _description(NEAR + 'moves = ["X"]\n', PROBE, readings=16)
    return measured(tmp_path_factory.mktemp("two") / "m.axiscal", description, SEED)


def test_the_sheet_to_fill_in_has_a_column_for_every_value(two: Path, tmp_path: Path, command: Command) -> None:
    plan = tmp_path / "check.csv"
    planned = command("verify", two, "--points", 8, "--plan", plan, "--json").document["plan"]
    assert {len(p["found_um"]) if isinstance(p["found_um"], list) else 1 for p in planned} == {1, 3}
    with plan.open(newline="") as file:
        lines = list(csv.DictReader(file))
    columns = ("value_um", "value_x_um", "value_y_um", "value_z_um")
    assert tuple(lines[0])[-4:] == columns
    for name, key in (("found.csv", "found_um"), ("left.csv", "left_um")):
        with (tmp_path / name).open("w", newline="") as file:
            sheet = csv.DictWriter(file, list(lines[0]))
            sheet.writeheader()
            for line, place in zip(lines, planned, strict=True):
                shown = place[key] if isinstance(place[key], list) else [place[key]]
                names = columns[1:] if len(shown) == 3 else columns[:1]
                sheet.writerow(line | {n: f"{v:.4f}" for n, v in zip(names, shown, strict=True)})
    filled = ("--found", tmp_path / "found.csv", "--left", tmp_path / "left.csv")
    assert "AS PROMISED" in command("verify", two, *filled, "--tolerance", "12 um").printed
    said = command("verify", two, "--points", 8, "--plan", plan).said
    assert "fill in value_um, value_x_um, value_y_um, value_z_um" in said
    assert "um as found, " in said


def test_a_tracker_set_down_by_eye_shows_the_machine_and_not_its_turn() -> None:
    """Twelve places, 20 mrad off about each axis: by scipy's rotation, and what is left of 10 um of deviations."""
    description, rng = _description(TRACKER), np.random.default_rng(7)
    turn = Rotation.from_rotvec([0.019, -0.021, 0.023])
    station = np.array([0.0, -0.9, 0.0])
    low, high = np.array([axis.travel for axis in description.machine.axes]).T
    poses, deviations = rng.uniform(low, high, (12, 2)), rng.normal(0, 1e-5, (12, 3))
    tips = description.machine.frames(poses).tcp
    shown = turn.apply(tips + deviations - station) + station - tips
    places = Places.of_setup(0, poses, np.zeros_like(poses))
    datums = datums_of(description.machine, description.setups, places, 1e-6)
    left = datums.free @ upright(description.machine, description.setups, places, datums, shown.ravel())
    left -= datums.free @ deviations.ravel()
    assert np.abs(left).max() < 2e-8
    assert np.abs(datums.free @ shown.ravel() - datums.free @ deviations.ravel()).max() > 2e-5


@pytest.fixture(scope="module")
def two_setups(two: Path) -> Check:
    with Campaign.open(two, write=False) as campaign:
        return Check.from_campaign(campaign, "csv")


@pytest.mark.parametrize("count", [3, 5, 7, None])
def test_a_check_tells_the_machine_from_every_set_up_that_it_reads(count: int | None, two_setups: Check) -> None:
    """What is planned can be judged: with three zeros and three turns a tracker is read at three places, or at none."""
    places = two_setups.planned(count)
    assert count is None or len(places) == count
    judged = two_setups.judged(two_setups.asked(f"sim:{SEED}", places), "1 nm")
    assert len(judged.left) == len(values_at(two_setups.description.setups, places).of)
    assert int(np.sum(places.setups == 0)) not in (1, 2)


def test_fewer_places_than_any_set_up_needs_are_refused(two_setups: Check) -> None:
    with pytest.raises(ReadingError, match=r"2 places cannot tell the machine from a set-up\. Ask for 3 or more"):
        two_setups.planned(2, "tracker")
    assert len(two_setups.planned(2, "tracker", tolerance=1.0)) == 2


BALLS = """[[artefacts]]
name = "board"
calibrated = "0.3 mm"
turned = "5 mrad"
[artefacts.balls]
one = ["-60 mm", "0 mm", "10 mm"]
two = ["60 mm", "0 mm", "60 mm"]
three = ["0 mm", "-60 mm", "110 mm"]
four = ["0 mm", "60 mm", "40 mm"]
"""
PLACED = '[[setups]]\nname = "{0} deg"\ninstrument = "sphere"\nartefact = "board"\nat = {1}\nturn = "{0} deg"\n'
THREE = machine_text(
    "w-b-Y-X-Z-t", {"X": (0, 300), "Y": (0, 300), "Z": (0, 200)}, {"EXX EYY": "20 um", "C0Y": "90 urad"}, name="Three"
)


def test_a_board_that_has_no_new_places_is_read_again_as_it_lies(tmp_path: Path, command: Command) -> None:
    """A board put down by eye is turned by milliradians, whose squares move its balls by microns."""
    at = ((0, "100 mm", "100 mm"), (90, "200 mm", "100 mm"), (180, "150 mm", "180 mm"))
    boards = [PLACED.format(turn, [x, y, "0 mm"]) for turn, x, y in at]
    seed, record = 15, measured(tmp_path / "board.axiscal", _description(BALLS, *boards, machine=THREE), 15)
    said = command("verify", record, "--json").document
    assert len(said["read_again"]) >= 2
    assert len(said["plan"]) == 4 * len(said["read_again"])
    said = command("verify", record, "--source", f"sim:{seed}", "--tolerance", "30 um", "--json").document
    assert (said["verdict"], said["decision"], said["against_own_line"]) == ("promised", "conform", [])
    assert said["left_rms_um"] < said["found_rms_um"]
    assert (said["promise_p"] > 0.05, said["set_up_off"]) == (True, [])  # what one ball adds to many is no surprise
    with Campaign.open(record, write=False) as campaign:
        check = Check.from_campaign(campaign, "linuxcnc")
    places = check.planned()
    once = check.asked(f"sim:{seed}", places.within(places.setups == places.setups[0]))
    with pytest.raises(ReadingError, match="one artefact cannot tell"):
        check.judged(once, "30 um")
