"""Campaign files that are wrong: each ends in one failure that names file, line, value and remedy."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.description.campaign import campaign_from_texts, read_campaign
from axiscal.exceptions import DescriptionError, InputError, UnitError
from tests.generators.texts import machine_text

MACHINE = machine_text(
    "w-C'-X'-b-Z-t",
    {"C": (0, 360), "X": (0, 600), "Z": (50, 400)},
    {"EXX": 'std = "10 um"'},
    tool=100,
    name="Small mill",
)

GOOD = """\
machine = "machine.toml"
[programs]
clearance = "Z=400 mm"
order = "Z,X,C"
feed = "500 mm/min"
dwell = true
[target]
rms = "2 um"
worst = "4 um"
readings = 40
budget = "90 min"
volume = { X = ["50 mm", "550 mm"] }
criterion = "volume"
[[setups]]
name = "laser along X"
instrument = "interferometer"
direction = "x"
moves = ["X"]
park = { Z = "250 mm" }
noise = "0.3 um"
unknowns = { zero = "100 um", slope = "50 urad" }
setup_time = "30 min"
settle = "1 s"
reading_time = "3 s"
raster = { X = "10 mm" }
approach = "both"
[[setups]]
name = "level"
instrument = "level"
direction = [0, 1, 0]
moves = ["Z"]
"""

PART = ", ".join(f'{way} = ["10 mm", "20 mm"]' for way in "xyz")

# What is replaced, by what, and what the failure says; it stands in the line where the replacement is.
WRONG = [
    ('machine = "machine.toml"', "", '"machine" is missing'),
    ('clearance = "Z=400 mm"', 'clearence = "Z=400 mm"', 'unknown key "clearence".*Perhaps "clearance"'),
    ('clearance = "Z=400 mm"', 'clearance = "400 mm"', '"400 mm" is not AXIS=PLACE.*"Z=-5 mm"'),
    ('clearance = "Z=400 mm"', 'clearance = "Z=401 mm"', '"401 mm" is outside the travel of Z.*50 mm to 400 mm'),
    ('clearance = "Z=400 mm"', 'clearance = "Y=40 mm"', 'no axis "Y"'),
    ('clearance = "Z=400 mm"', 'clearance = "Z=40 deg"', "is an angle, not a length"),
    ('clearance = "Z=400 mm"', "clearance = 400", "Write a text in quotes"),
    ('order = "Z,X,C"', 'order = "Z,X"', "the order of moves names Z X.*Name each of C X Z once"),
    ('order = "Z,X,C"', 'order = "Z C,X"', "Z C are to move together.*groups of their own"),
    ('order = "Z,X,C"', 'order = ""', "names no axis"),
    ('feed = "500 mm/min"', "feed = 0.5", "0.5 has no unit"),
    ('feed = "500 mm/min"', 'feed = "500"', '"500" has no unit'),
    ('feed = "500 mm/min"', 'feed = "0 mm/min"', "is zero.*from 1 mm/min on"),
    ('feed = "500 mm/min"', 'feed = "-3 m/min"', "is negative"),
    ('feed = "500 mm/min"', 'feed = "500 mm"', "is a length, not a speed"),
    ("dwell = true", 'dwell = "yes"', "Write true or false"),
    ("dwell = true", "dwell = true\nspindle = true", 'unknown key "spindle".*clearance, order, feed, dwell'),
    ('"machine.toml"', "7", "machine: 7 is not the name"),
    ('"machine.toml"', '""', 'machine: "" is not the name'),
    ('"machine.toml"', r'"a\u0000b"', "is not the name of a machine"),
    ('machine = "machine.toml"', 'machin = "machine.toml"', '"machine" is missing'),
    ('machine = "machine.toml"', 'machine = "machine.toml"\nmachine = "x"', "not valid TOML"),
    ('rms = "2 um"', "rms = 2", "2 has no unit"),
    ('rms = "2 um"', 'rms = "2"', '"2" has no unit'),
    ('rms = "2 um"', 'rms = "2 urad"', '"2 urad" is an angle, not a length'),
    ('rms = "2 um"', "rms = nan", "has no unit"),
    ('rms = "2 um"', 'rms = "0 um"', '"0 um" is zero'),
    ('rms = "2 um"', 'rms = "-2 um"', "is negative"),
    ('rms = "2 um"', "rms = true", "not a quantity"),
    ('rms = "2 um"', "rms = 2 um", "not valid TOML"),
    ('rms = "2 um"', 'rsm = "2 um"', 'unknown key "rsm".*Perhaps "rms"'),
    ('worst = "4 um"', 'worst = "2 um"', "never be reached before 2 um RMS"),
    ('worst = "4 um"', 'worst = "0 m"', "is zero"),
    ("readings = 40", "readings = 0", "0 is not above zero"),
    ("readings = 40", "readings = -3", "not above zero"),
    ("readings = 40", "readings = 4.5", "4.5.*whole number"),
    ("readings = 40", 'readings = "40"', "whole number"),
    ("readings = 40", "readings = 100001", "too many"),
    ("readings = 40", "readings = 99999999999999999999999", "too many"),
    ('budget = "90 min"', 'budget = "90"', "no unit"),
    ('budget = "90 min"', 'budget = "0 s"', "0 min is less than"),
    ('budget = "90 min"', 'budget = "1 min"', r"1 min is less than the 5\.\d+ min that the first reading takes"),
    ('volume = { X = ["50 mm", "550 mm"] }', 'volume = { U = ["50 mm", "550 mm"] }', 'no axis "U"'),
    ('["50 mm", "550 mm"]', '["550 mm", "50 mm"]', "does not increase"),
    ('["50 mm", "550 mm"]', '["50 mm", "50 mm"]', "does not increase"),
    ('["50 mm", "550 mm"]', '["50 mm", "601 mm"]', '"601 mm" is outside the travel of X.*0 mm to 600 mm'),
    ('["50 mm", "550 mm"]', '["-1 mm", "550 mm"]', '"-1 mm" is outside'),
    ('["50 mm", "550 mm"]', '["50 mm"]', "two ends"),
    ('["50 mm", "550 mm"]', '["50 mm", "60 mm", "70 mm"]', "two ends"),
    ('["50 mm", "550 mm"]', '["50 deg", "60 deg"]', "is an angle, not a length"),
    ('["50 mm", "550 mm"]', "[50, 60]", "50 has no unit"),
    ('volume = { X = ["50 mm", "550 mm"] }', 'volume = "all"', "volume"),
    ('criterion = "volume"', 'criterion = "rms"', "'volume', 'rows', 'joint' or 'worst'"),
    ('name = "laser along X"', "", '"name" is missing'),
    ('name = "laser along X"', 'name = ""', '"" is not a name'),
    ('name = "laser along X"', 'name = " laser"', '" laser" is not a name'),
    ('name = "laser along X"', r'name = "laser\u0007"', "is not a name"),
    ('name = "laser along X"', 'name = "' + "x" * 81 + '"', "is not a name"),
    ('name = "laser along X"', "name = 3", "3 is not possible"),
    ('instrument = "interferometer"', 'instrument = "interferometr"', 'Perhaps "interferometer"'),
    ('instrument = "interferometer"', 'instrument = "ruler"', '"ruler" is not an instrument.*indicator'),
    ('direction = "x"', "", '"direction" is missing'),
    ('direction = "x"', 'direction = "u"', '"u" is not a direction'),
    ('direction = "x"', 'direction = "xy"', "is not a direction"),
    ('direction = "x"', 'direction = ""', "is not a direction"),
    ('direction = "x"', "direction = [0, 0, 0]", r"\[0, 0, 0\] is not a direction"),
    ('direction = "x"', "direction = [1, 0]", "is not a direction"),
    ('direction = "x"', "direction = []", "is not a direction"),
    ('direction = "x"', "direction = [1, 0, nan]", "direction"),
    ('direction = "x"', "direction = [1, 0, inf]", "direction"),
    ('direction = "x"', "direction = [1, 0, 1e300]", "is not a direction"),
    ('direction = "x"', "direction = [true, false, false]", "direction"),
    ('direction = "x"', 'direction = ["x", "y", "z"]', "direction"),
    ('moves = ["X"]', "moves = []", "nothing moves"),
    ('moves = ["X"]', 'moves = ["Y"]', 'no axis "Y".*C, X, Z'),
    ('moves = ["X"]', 'moves = ["X", "X"]', "names an axis twice"),
    ('moves = ["X"]', 'moves = "X"', "square brackets"),
    ('moves = ["X"]', "moves = [1]", "Write a text in quotes"),
    ('park = { Z = "250 mm" }', 'park = { Z = "401 mm" }', '"401 mm" is outside the travel of Z'),
    ('park = { Z = "250 mm" }', 'park = { Y = "250 mm" }', 'no axis "Y"'),
    ('park = { Z = "250 mm" }', 'park = { X = "250 mm" }', "X is parked, but it is one of the axes that move"),
    ('park = { Z = "250 mm" }', 'park = { C = "250 mm" }', "is a length, not an angle"),
    ('park = { Z = "250 mm" }', "park = { Z = 250 }", "250 has no unit"),
    ('park = { Z = "250 mm" }', 'park = { C = "361 deg" }', "outside the travel of C.*0 deg to 360 deg"),
    ('noise = "0.3 um"', 'noise = "0 um"', "is zero"),
    ('noise = "0.3 um"', 'noise = "1e-5 um"', "too small.*from 0.0001 um"),
    ('noise = "0.3 um"', 'noise = "-0.3 um"', "is negative"),
    ('noise = "0.3 um"', 'noise = "0.3 urad"', "is an angle, not a length"),
    ('noise = "0.3 um"', "noise = 0.3", "has no unit"),
    ('zero = "100 um"', 'zero = "100 urad"', "is an angle, not a length"),
    ('zero = "100 um"', 'zero = "0 um"', "is zero"),
    ('zero = "100 um"', 'zro = "100 um"', '"zro" is not an unknown.*Perhaps "zero"'),
    ('zero = "100 um"', 'centre = "100 um"', "Known are zero, slope"),
    ('slope = "50 urad"', 'slope = "50 um"', "is a length, not an angle"),
    ("unknowns = { zero", 'unknowns = "none" # zero', "unknowns"),
    ('moves = ["X"]\npark = { Z = "250 mm" }', "", "slope needs exactly one linear axis.*X, Z move"),
    ('setup_time = "30 min"', 'setup_time = "-1 s"', '"-1 s" is negative'),
    ('settle = "1 s"', 'settle = "1 mm"', "is a length, not a time"),
    ('settle = "1 s"', 'settle = "-1 ms"', "is negative"),
    ('reading_time = "3 s"', "reading_time = 3", "has no unit"),
    ('raster = { X = "10 mm" }', 'raster = { X = "0 mm" }', "is zero"),
    ('raster = { X = "10 mm" }', 'raster = { Z = "10 mm" }', "does not move in this set-up"),
    ('raster = { X = "10 mm" }', 'raster = { W = "10 mm" }', 'no axis "W"'),
    ('raster = { X = "10 mm" }', 'raster = { X = "10 deg" }', "is an angle"),
    ('approach = "both"', 'approach = "up"', "'both', '\\+' or '-'"),
    ('approach = "both"', 'aproach = "both"', 'Perhaps "approach"'),
    ('moves = ["Z"]', 'moves = ["Z"]\nraster = { Z = "1 m" }', "no multiple of 1000 mm lies in the travel of Z"),
    ('moves = ["Z"]', 'moves = ["Z"]\nnoise = "1 um"', "is a length, not an angle"),
    ('moves = ["Z"]', 'moves = ["Z"]\nunknowns = { zero = "1 um" }', "is a length, not an angle"),
    ('moves = ["Z"]', 'moves = ["Z"]\nunknowns = { slope = "1 urad" }', "the level reads an angle"),
    ('moves = ["Z"]', 'moves = ["Z"]\none_sided = "+ 3 urad"', "this instrument reads an angle"),
    ('moves = ["Z"]', 'moves = ["Z"]\nserial = "a\\u0007"', r"serial: .* cannot stand in a report"),
    ('criterion = "volume"', "directions = []", "no direction is left in which the tool point counts"),
    ('criterion = "volume"', f"part = {{ {PART} }}", "part and volume exclude one another"),
    ("[programs]", '[report]\ncountry = "DEU"\n[programs]', '"DEU" is no country of two letters'),
    ("[programs]", '[report]\ncountry = "Ä1"\n[programs]', "is no country of two letters"),
    ("[programs]", '[report]\nlanguage = "tlh"\n[programs]', '"tlh" is no language of reports'),
    ("[programs]", '[report]\nremarks = "a\\u0007"\n[programs]', "cannot stand in a report.*500 characters"),
    ("[programs]", f'[report]\nremarks = "{501 * "x"}"\n[programs]', "cannot stand in a report"),
    ("[programs]", '[sisters]\nrecords = " "\n[programs]', 'records = " " names no file'),
    ("[programs]", '[sisters]\nrecords = ["a", "b\\u0007"]\n[programs]', "names no file"),
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "machine.toml").write_text(MACHINE)
    return tmp_path


def failure(folder: Path, text: str) -> InputError:
    path = folder / "campaign.toml"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_campaign(path)
    assert isinstance(caught.value, DescriptionError | UnitError)
    assert str(caught.value).startswith(str(path))
    assert caught.value.remedy
    assert all(line.startswith(("- ", "And ")) for line in str(caught.value).splitlines()[1:])
    return caught.value


def test_the_good_one_is_good(folder: Path) -> None:
    (folder / "campaign.toml").write_text(GOOD)
    assert len(read_campaign(folder / "campaign.toml").setups) == 2


@pytest.mark.parametrize(("right", "wrong", "says"), WRONG)
def test_a_wrong_entry_is_refused_at_its_line(folder: Path, right: str, wrong: str, says: str) -> None:
    assert GOOD.count(right) == 1
    text = GOOD.replace(right, wrong)
    caught = failure(folder, text)
    assert re.search(says, str(caught)), str(caught)
    first = text[: GOOD.find(right)].count("\n") + 1
    missing = wrong == "" or wrong.startswith("machin ")
    assert caught.line is not None
    assert missing or first <= caught.line <= first + wrong.count("\n")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", '"machine" is missing'),
        ("\n", '"machine" is missing'),
        ("x", "not valid TOML"),
        ('machine = "machine.toml"', '"setups" is missing'),
        ('machine = "machine.toml"\nsetups = []', "there is no set-up"),
        ('machine = "machine.toml"\nsetups = [1]', "setups"),
        ('machine = "machine.toml"\nsetups = "laser"', "setups"),
        ('machine = "machine.toml"\ntarget = 3\nsetups = []', "target"),
        (GOOD.replace("[[setups]]", "[setups]", 1), "line 27: not valid TOML"),
        (GOOD.replace('"level"', '"laser along X"', 1), 'line 28: .*two set-ups are called "laser along X"'),
        (GOOD.replace("[target]", "[goal]"), 'unknown key "goal"'),
        (GOOD + "[[setups]]\n", '"name" is missing'),
        (GOOD + "colour = 3\n", 'unknown key "colour"'),
        ("a = " + "[" * 400, "nested too deeply|not valid TOML"),
        ('machine = "' + "m" * 300 + '"', "neither a file nor a built-in machine|cannot be read|no such file"),
    ],
)
def test_a_wrong_whole_is_refused(folder: Path, text: str, says: str) -> None:
    path = folder / "campaign.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=says):
        read_campaign(path)


@pytest.mark.parametrize(
    "content", [b"\xff\xfem\x00", b"\xef\xbb\xbfmachine = 1", b"machine = '\xb5'", b"a\0b", b"\x81\x30\x81\x30"]
)
def test_a_file_that_is_no_text_is_refused(folder: Path, content: bytes) -> None:
    (folder / "campaign.toml").write_bytes(content)
    with pytest.raises(InputError, match=r"campaign\.toml"):
        read_campaign(folder / "campaign.toml")


def test_a_campaign_without_end_is_refused_unless_it_only_evaluates(folder: Path) -> None:
    text = "\n".join(
        line for line in GOOD.splitlines() if line.split(" ")[0] not in ("rms", "worst", "readings", "budget")
    )
    assert "nothing would ever stop" in str(failure(folder, text))
    assert read_campaign(folder / "campaign.toml", target_needed=False).target.empty


def test_a_prior_beside_records_of_sisters_is_refused(folder: Path) -> None:
    text = GOOD.replace("[programs]", '[sisters]\nrecords = ["records/*.axiscal", "more.axiscal"]\n[programs]')
    (folder / "more.axiscal").touch()
    (folder / "campaign.toml").write_text(text)
    found = read_campaign(folder / "campaign.toml").sisters
    assert found is not None
    assert found.files(folder) == (folder / "more.axiscal",)
    (folder / "campaign.toml").write_text(text.replace('"more.axiscal"', '"store:"'))
    stored = read_campaign(folder / "campaign.toml").sisters
    assert stored is not None
    assert stored.files(folder) == (Path("store:"),)
    with pytest.raises(DescriptionError, match=r"line 3: sisters: .* names another prior"):
        campaign_from_texts(f'prior = "old.axiscal"\n{text}', "campaign.toml", MACHINE, "machine.toml")


def test_a_prior_that_is_no_record_is_named(folder: Path) -> None:
    (folder / "old.axiscal").write_text("no record")
    (folder / "campaign.toml").write_text(f'prior = "old.axiscal"\n{GOOD}')
    with pytest.raises(InputError, match=r"old\.axiscal: This file is not a campaign record"):
        read_campaign(folder / "campaign.toml")


def test_a_wrong_machine_is_shown_in_its_own_file(folder: Path) -> None:
    (folder / "machine.toml").write_text(MACHINE.replace('"600 mm"', '"600"'))
    (folder / "campaign.toml").write_text(GOOD)
    with pytest.raises(InputError, match=r"machine\.toml, line 8"):
        read_campaign(folder / "campaign.toml")


def test_a_machine_that_is_not_there_is_named(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "campaign.toml").write_text(GOOD.replace("machine.toml", "mashine.toml"))
    monkeypatch.chdir(folder)
    with pytest.raises(InputError, match=r"mashine\.toml: there is no such file"):
        read_campaign("campaign.toml")


@given(st.data())
def test_a_garbled_campaign_is_read_or_refused(data: st.DataObject) -> None:
    start = data.draw(st.integers(0, len(GOOD)))
    end = data.draw(st.integers(start, min(len(GOOD), start + 30)))
    middle = data.draw(st.text(st.sampled_from('"[]{}=,.\n 0123456789eE+-umsxXnaif_#\\'), max_size=12))
    with contextlib.suppress(InputError):
        campaign_from_texts(GOOD[:start] + middle + GOOD[end:], "campaign.toml", MACHINE, "machine.toml")


@pytest.mark.parametrize(
    ("said", "there"), [('"no"', ""), ('["X=old.comp"]', "old.csv"), ('["X=old.comp"]', "old.comp")]
)
def test_a_compensation_that_was_active_is_in_a_file_that_is_there(tmp_path: Path, said: str, there: str) -> None:
    (tmp_path / (there or "machine.toml")).write_text(MACHINE)
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "campaign.toml").write_text(f"compensation_active = {said}\n{GOOD}")
    refused = pytest.raises(DescriptionError, match=r"campaign.toml, line 1: compensation_active names .* not there")
    with contextlib.nullcontext() if there == "old.comp" else refused:
        read_campaign(tmp_path / "campaign.toml")
