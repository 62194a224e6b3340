"""Instruments that somebody wrote: from a file beside the campaign, or a package, to a plan and an estimate."""

from __future__ import annotations

import json
from dataclasses import replace
from importlib.metadata import EntryPoint, EntryPoints
from inspect import getsource
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.sources import open_source
from axiscal.campaign.sources.source import Answer, Request
from axiscal.description.campaign import CampaignDescription, campaign_from_texts, read_campaign
from axiscal.description.placed_readings import placed_readings
from axiscal.document import ports
from axiscal.estimation.estimate import concluded, estimated
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.promise.causes import contributions
from axiscal.exceptions import DescriptionError, SourceError
from axiscal.machine import load_machine
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.reading import Place, Places, Reading
from axiscal.measurement.reading_rows import blank_readings, places_of
from axiscal.measurement.simulation import Simulator, by_number
from axiscal.planning.next_readings import placed
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal.tables.registry import offered
from tests.commands import Command
from tests.core.strangers import Grid
from tests.generators.texts import machine_text

MACHINE = "three-axis-mill"
HEAD = f'machine = "{MACHINE}"\nusual = "off"\nsure = "exactly"\n[target]\nreadings = 8\n[[setups]]\n'
GRID = "import axiscal_core as ac\n\n" + getsource(Grid)
SIX = """
import axiscal_core as ac

ZEROS = ("zx", "zy", "zz", "za", "zb", "zc")

class SixDegrees(ac.Instrument):
    names, units = ("x", "y", "z", "a", "b", "c"), ("m",) * 3 + ("rad",) * 3
    noise, unknowns = ("0.5 um",) * 3 + ("1 urad",) * 3, dict.fromkeys(ZEROS, 1e-3)

    def sees(self, at, u):
        return [part + u[zero] for part, zero in zip([*at.moved.T, *at.turned.T], ZEROS, strict=True)]
"""
STRANGERS = """
import numpy as np
import axiscal_core as ac

class Laser(ac.Instrument):
    names, noise, unknowns = ("length",), "0.3 um", {"zero": "1 mm"}

    def sees(self, at, u):
        return [at.moved[:, 0] + u["zero"]]

class Tracker(ac.Instrument):
    names, units, noise = ("x", "y", "z"), ("m",) * 3, "10 um"
    unknowns = {f"zero_{axis}": "1 mm" for axis in "xyz"} | {f"turn_{axis}": "1 mrad" for axis in "xyz"}

    def sees(self, at, u):
        line = at.tcp - np.array([0.3, -1.0, 0.3])
        turn = rigid.rotation(np.array([[u[f"turn_{axis}"] for axis in "xyz"]]))[0]
        return [part + u[f"zero_{axis}"] for part, axis in zip(((line + at.moved) @ turn.T - line).T, "xyz")]
""".replace("import axiscal_core as ac\n", "import axiscal_core as ac\nfrom axiscal_core import rigid\n")


def described(folder: Path, file: str, keys: str, machine: str = "") -> CampaignDescription:
    """Return a campaign of one set-up, a file of instruments beside it."""
    (folder / "own.py").write_text(file)
    text = machine or load_machine(MACHINE).text
    return campaign_from_texts(HEAD + keys, str(folder / "c.toml"), text, MACHINE, anew=True)


def plate(folder: Path) -> Path:
    """Return the file of a campaign with a grid encoder."""
    (folder / "grid.py").write_text(GRID)
    campaign = folder / "campaign.toml"
    campaign.write_text(HEAD + 'name = "plate"\ninstrument = "grid.py:Grid"\nmoves = ["X", "Y"]\n')
    return campaign


def drawn(description: CampaignDescription, count: int = 8) -> tuple[Reading, ...]:
    """Return readings of a virtual machine at the places of a plan."""
    places = placed(case_of(description), proposed(case_of(description), Limits(count), 300))
    machine = Simulator(description.machine, description.setups).drawn(3)
    return machine.measured(description.setups, places, [10.0 * n for n in range(len(places))], by_number(3))


def test_a_grid_goes_from_its_file_to_a_report_by_the_command_line(tmp_path: Path, command: Command) -> None:
    campaign, out, readings = plate(tmp_path), tmp_path / "out", tmp_path / "readings.csv"
    answer = command("plan", campaign, "--json").document
    assert [each["instrument"] for each in answer["setups"]] == ["Grid"]
    assert answer["rows"][0]["known_to"] < 0.8 * answer["rows"][0]["known_before"]
    rows = [f"plate,{x},{y},X+ Y+,{1e-2 * x},{-2e-2 * y}" for x in (20, 250, 480) for y in (20, 200, 380)]
    readings.write_text("\n".join(["setup,X_mm,Y_mm,approach,dx_um,dy_um", *rows]))
    assert command("data", "estimate", campaign, readings, "--out", out).status == 0
    assert (out / "report.pdf").stat().st_size > 10_000
    first = json.loads((out / "result.json").read_bytes())["history"][1]
    assert [first["value"], *first["others"]] == pytest.approx([0.2, -0.4])


def test_its_readings_are_told_by_name_unit_and_count(tmp_path: Path) -> None:
    six = described(tmp_path, SIX, 'name = "six"\ninstrument = "own.py:SixDegrees"\nmoves = ["X"]\n')
    file = tmp_path / "r.csv"
    file.write_text("setup,X_mm,x_um,y_um,z_um,a_arcsec,b_urad,c_urad\nsix,120,1,2,3,1,5,6\n")
    (reading,) = placed_readings(read_any(file, six.machine.axes, six.setups), six, file)
    assert np.allclose(reading.values, [1e-6, 2e-6, 3e-6, np.pi / 648000, 5e-6, 6e-6], rtol=1e-12)
    laser = described(tmp_path, STRANGERS, 'name = "laser"\ninstrument = "own.py:Laser"\nmoves = ["X"]\n')
    file.write_text("setup,X_mm,length_um\nlaser,120,7\n")  # a word that a table has for the two ends of a gauge
    (reading,) = placed_readings(read_any(file, laser.machine.axes, laser.setups), laser, file)
    assert reading.values == pytest.approx((7e-6,), rel=1e-12)


def test_numbers_that_are_not_equally_noisy_are_weighed_as_they_are(tmp_path: Path) -> None:
    """The judge are the equations as they stand, in m and rad, each number with its own noise."""
    sizes = {f"E{c}X": 'std = "10 um"' if c in "XYZ" else 'std = "10 urad"' for c in "XYZABC"}
    slide = machine_text("w-b-X-t", {"X": (0, 1000)}, sizes)
    six = described(tmp_path, SIX, 'name = "six"\ninstrument = "own.py:SixDegrees"\nmoves = ["X"]\n', slide)
    case, readings = case_of(six), drawn(six)
    errors, poses = case.errors, np.array([reading.pose for reading in readings])
    sides = np.array([reading.approach for reading in readings], dtype=float)
    seen = np.concatenate([errors.rows_at(poses, sides), errors.rows_at(poses, sides, angular=True)], axis=1)
    rows = np.concatenate([seen, np.tile(np.eye(6), (len(poses), 1, 1))], axis=2).reshape(6 * len(poses), -1)
    noise = np.tile(np.repeat([0.5e-6, 1e-6], 3), len(poses))
    before = np.zeros((rows.shape[1], rows.shape[1]))
    before[:-6, :-6], before[-6:, -6:] = errors.covariance(), 1e-6 * np.eye(6)
    gain = before @ rows.T @ np.linalg.inv(rows @ before @ rows.T + np.diag(noise**2))
    values = np.concatenate([reading.values for reading in readings])
    after, found = before - gain @ rows @ before, concluded(case_of(six), readings).printed.belief
    scale = np.sqrt(np.diag(after))[: errors.size]
    assert np.abs((found.mean[: errors.size] - (gain @ values)[: errors.size]) / scale).max() < 1e-6
    theirs = np.sum(found.factor[: errors.size] ** 2, axis=1)
    assert np.allclose(theirs, scale**2, rtol=1e-6)


KEYS = 'name = "s"\nmoves = [{moves}]\nsetup_time = "1 min"\nsettle = "0 s"\nreading_time = "5 s"\ndrift = "0"\n'
PAIRS = {
    "Laser": ('instrument = "interferometer"\ndirection = "x"\n', '"X"'),
    "Tracker": ('instrument = "tracker"\nstation = ["300 mm", "-1000 mm", "300 mm"]\n', '"X", "Y", "Z"'),
}


@pytest.mark.parametrize(("name", "count"), [("Laser", 8), pytest.param("Tracker", 16, marks=pytest.mark.long)])
def test_one_of_ours_written_again_gives_what_ours_gives(tmp_path: Path, name: str, count: int) -> None:
    own, moves = PAIRS[name]
    keys = KEYS.format(moves=moves)
    ours = described(tmp_path, STRANGERS, keys + own)
    ours = replace(ours, setups=tuple(replace(setup, lacks=None) for setup in ours.setups))
    theirs = described(tmp_path, STRANGERS, f'{keys}approach = "+"\ninstrument = "own.py:{name}"\n')
    readings = drawn(ours, count)
    plan = proposed(case_of(theirs), Limits(count), 300)
    assert placed(case_of(theirs), plan) == tuple(reading.place for reading in readings)
    for some in (readings[:5], readings):
        mine, other = (estimated(case_of(each), some).printed.belief for each in (ours, theirs))
        scale = np.linalg.norm(mine.factor, axis=1)
        assert np.abs((mine.mean - other.mean) / scale).max() < 1e-12
        one, two = (each.factor @ each.factor.T / np.outer(scale, scale) for each in (mine, other))
        assert np.abs(one - two).max() < 1e-12
    files, same = (offered(concluded(case_of(each), readings), "csv").files for each in (ours, theirs))
    assert files == same


def test_what_fails_later_names_the_same_line(tmp_path: Path) -> None:
    """A class may fail at a pose that nobody tried when it was mounted."""
    file = "import axiscal_core as ac\nclass Rare(ac.Instrument):\n    def sees(self, at, u):\n"
    file += "        return [None if (at.poses[:, 0] == 0.123).any() else at.moved[:, 0]]\n"
    rare = described(tmp_path, file, 'name = "s"\nmoves = ["X"]\ninstrument = "own.py:Rare"\n')
    pose = np.array([[0.123, 0.2, 0.2]])
    with pytest.raises(DescriptionError, match=r"c.toml, line 9: Rare.sees: result holds no numbers"):
        case_of(rare).observation.numbers(Places.of_setup(0, pose, np.ones_like(pose)))


def test_a_package_brings_an_instrument_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "acme_grid.py").write_text(GRID)
    monkeypatch.syspath_prepend(tmp_path)
    point = EntryPoint("grid", "acme_grid:Grid", "axiscal.instruments")
    found = EntryPoints([point])
    monkeypatch.setattr(ports, "entry_points", lambda **which: found.select(**which))
    (setup,) = described(tmp_path, "", 'name = "plate"\nmoves = ["X", "Y"]\ninstrument = "grid"\n').setups
    assert (setup.instrument, setup.reading_time) == ("grid", 10.0)
    assert setup.noise == pytest.approx(1e-7)
    assert [unknown.std for unknown in setup.unknowns] == [1e-3, 1e-3, 1e-3]
    with pytest.raises(DescriptionError, match="tracker, tracer, grid"):
        described(tmp_path, "", 'name = "plate"\nmoves = ["X", "Y"]\ninstrument = "xyz"\n')


FIGURES = """
import axiscal_core as ac

class Dial(ac.Instrument):
    noise, unknowns, type_b = "2 um", {"zero": "0.1 mm"}, {"gain": "2 mm/m", "offset": "3 um"}
    park, approach, drift, seconds, setup_time = {"Y": "50 mm"}, "-", "6 um/h", "4 s", "2 min"

    def sees(self, at, u):
        return [(1 + u["gain"]) * at.moved[:, 0] + u["zero"] + u["gain"] * at.poses[:, 0] + u["offset"]]
"""


def test_its_figures_hold_where_the_campaign_says_nothing(tmp_path: Path) -> None:
    keys = 'name = "s"\nmoves = ["X"]\ninstrument = "own.py:Dial"\n'
    (setup,) = described(tmp_path, FIGURES, keys).setups
    assert (setup.noise, setup.park[1], setup.approach, setup.reading_time) == (2e-6, 0.05, "-", 4.0)
    assert setup.setup_time == 120.0
    assert setup.drift == pytest.approx(6e-6 / 3600, rel=1e-6, abs=0.0)
    more = 'noise = "5 um"\npark = { Y = "0.1 m" }\napproach = "both"\ntype_b = { gain = "1 mm/m" }\ndrift = "0"\n'
    (other,) = described(tmp_path, FIGURES, keys + more + 'unknowns = { zero = "1 um" }\n').setups
    assert (other.noise, other.park[1], other.approach, other.drift) == (5e-6, 0.1, "both", 0.0)
    assert (dict(other.stated), other.unknowns[0].std) == ({"gain": 1e-3}, 1e-6)


def test_its_causes_that_no_reading_shows_widen_what_is_known(tmp_path: Path) -> None:
    keys = 'name = "s"\nmoves = ["X"]\ninstrument = "own.py:Dial"\n'
    dial = described(tmp_path, FIGURES, keys)
    dial, at = replace(dial, usual=True), np.array([0.1, 0.25, 0.5])
    places = [Place("s", (x, *dial.setups[0].park[1:]), (-1, 0, 0)) for x in at.tolist()]
    readings = blank_readings(dial.setups, places)
    found = {each.row.name: each for each in contributions(case_of(dial).observation, places_of(dial.setups, readings))}
    assert np.allclose(found["gain"].effects, 2e-3 * at, rtol=1e-9)
    assert np.allclose(found["offset"].effects, 3e-6, rtol=1e-9)


def test_a_first_campaign_offers_an_instrument_of_ones_own(
    tmp_path: Path, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "grid.py").write_text(GRID)
    begun = "--machine", MACHINE, "--instrument", "grid.py:Grid", "--instrument", "level", "--target", "20 um"
    assert "campaign.toml" in command("init", tmp_path, *begun).printed
    own, *others = read_campaign(tmp_path / "campaign.toml").setups
    assert (own.name, own.instrument, len(own.moves)) == ("Grid", "grid.py:Grid", 3)
    assert {setup.instrument for setup in others} == {"level"}
    command("init", tmp_path / "elsewhere", *begun).refused("grid.py cannot be loaded", "Put the file there")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")  # a path is from where it is typed
    aside = "--machine", MACHINE, "--instrument", "../grid.py:Grid", "--target", "20 um"
    printed = command("init", "../jobs/there", *aside).printed
    assert "names ../../grid.py:Grid where it is" in " ".join(printed.split())
    assert read_campaign(tmp_path / "jobs" / "there" / "campaign.toml").setups[0].title == "Grid"


def test_a_file_and_a_command_answer_with_all_of_its_numbers(tmp_path: Path) -> None:
    six = described(tmp_path, SIX, 'name = "six"\ninstrument = "own.py:SixDegrees"\nmoves = ["X"]\n')
    simulator, asked = Simulator(six.machine, six.setups), (0.12, six.setups[0].park[1], six.setups[0].park[2])
    request = Request(1, six.setups[0], six.machine.axes, asked, (1, 0, 0))
    file = tmp_path / "r.csv"
    file.write_text("setup,X_mm,x_um,y_um,z_um,a_urad,b_urad,c_urad\nsix,120,1,2,3,4,5,6\n")
    answer = Answer(1e-6, others=(2e-6, 3e-6, 4e-6, 5e-6, 6e-6))
    assert open_source(f"csv:{file}", simulator).read(request) == answer
    units = '["um", "um", "um", "urad", "urad", "urad"]'
    command = tmp_path / "six.sh"
    command.write_text(f'read line; echo \'{{"value": [1, 2, 3, 4, 5, 6], "unit": {units}}}\'; read line\n')
    source = open_source(f"exec:sh {command}", simulator)
    assert source.read(request) == answer
    source.close()
    command.write_text('read line; echo \'{"value": [1, 2], "unit": "um"}\'; read line\n')
    source = open_source(f"exec:sh {command}", simulator)
    with pytest.raises(SourceError, match='reads an angle: give a unit such as "urad"'):
        source.read(request)
    source.close()
