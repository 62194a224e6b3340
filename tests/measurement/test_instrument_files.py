"""Files of instruments and controllers: what they say, and that each way to break them is an error with its line."""

from pathlib import Path

import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.description.placed_readings import placed_readings
from axiscal.evaluation.standards import evaluate, positioning_test
from axiscal.measurement.readers.files import read_any, recognised
from tests.commands import Command
from tests.generators.texts import machine_text

RTL = """HEADER::
File type  : rtl
Version no : 1
TARGET DATA::
Filetype  : ISO
Target-count: 3
Targets :
0.000000 50.000000
100.000000
Flags: 0 0 2 0
USER-TEXT::
Machine: Fräse
RUNS::
Run-count: 4
DEVIATIONS::
Run Target Data:
1   1   0.100
1   2   1.300
1   3  -0.400
2   3   0.200
2   2   1.900
2   1   0.500
3   1   0.300
3   2   1.100
3   3  -0.200
4   3   0.400
4   2   1.700
4   1   0.700
ENVIRONMENT::
Air temp   : 20.1 20.2 0
EOF::
"""
MAP = """RepRapFirmware height map file v2 generated at 2026-01-01 10:00
xmin,xmax,ymin,ymax,radius,xspacing,yspacing,xnum,ynum
10.00,70.00,20.00,50.00,-1.00,30.00,30.00,3,2
      0, -0.041, 0.000
  0.020,  0.030,      0
"""
BED = machine_text(
    "w-b-X-Y-t",
    {"X": (0, 100), "Y": (0, 100)},
    {"EZX": 'std = "50 um", length = "50 mm"', "EXX": 'std = "10 um", length = "50 mm"'},
)


def _campaign(*setups: str) -> CampaignDescription:
    tables = "".join(f'[[setups]]\nname = "{i}"\ninstrument = "probe"\n{setup}\n' for i, setup in enumerate(setups))
    return campaign_from_texts(f'machine = "bed"\n{tables}', "campaign.toml", BED, "bed")


def _file(tmp_path: Path, text: str, encoding: str = "utf-8", name: str = "file") -> Path:
    path = tmp_path / name
    path.write_bytes(text.encode(encoding))
    return path


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1", "gbk", "utf-16"])
@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_a_rtl_file_is_a_positioning_test(tmp_path: Path, encoding: str, ends: str) -> None:
    text = RTL.replace("Fräse", "Fr?se") if encoding == "gbk" else RTL
    test = positioning_test(recognised(_file(tmp_path, text.replace("\n", ends), encoding, "test.rtl")))
    assert test.targets == pytest.approx([0.0, 0.05, 0.1])
    assert test.up is not None
    assert test.down is not None
    assert test.up[1] == pytest.approx([1.3e-6, 1.1e-6])
    assert test.down[2] == pytest.approx([0.2e-6, 0.4e-6])
    assert pytest.approx(0.6e-6) == evaluate(test).figures["B"]


TWO_LASERS = "".join(
    f'[[setups]]\nname = "{axis}"\ninstrument = "interferometer"\nmoves = ["{axis}"]\ndirection = "{axis.lower()}"\n'
    for axis in "XY"
)


def test_a_person_says_along_which_axis_a_test_was_read(tmp_path: Path, command: Command) -> None:
    file = _file(tmp_path, RTL, name="laser.rtl")
    (tmp_path / "campaign.toml").write_text(f'machine = "three-axis-mill"\n{TWO_LASERS}')
    given = ("data", "estimate", tmp_path / "campaign.toml", file, "--out", tmp_path / "out")
    command(*given).refused("such as --axis X")
    command(*given, "--axis", "Q").refused('"Q"')
    assert {row["setup"] for row in command(*given, "--axis", "Y", "--json").document["history"][1:]} == {"Y"}
    named = _file(tmp_path, "setup,X_mm,approach,value_um\nX,100,+,1.5\n", name="named.csv")
    command(*given[:3], named, "--out", tmp_path / "other", "--axis", "Y").refused("so Y is not to be named")


def test_maps_find_their_set_up(tmp_path: Path) -> None:
    campaign = _campaign('direction = "-z"', 'direction = "x"')
    nodes = placed_readings(read_any(_file(tmp_path, MAP)), campaign, "map")
    assert {reading.setup for reading in nodes} == {"0"}
    assert nodes[0].value == pytest.approx(-41e-6)  # the bed is low, the tool too high over it
