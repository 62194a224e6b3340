"""What no reading shows: the page that says it, and its columns worked out by hand."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.promise.causes import contributions
from axiscal.machine import load_machine
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import places_of
from axiscal.measurement.type_b import TypeB
from axiscal.numerics import Array
from axiscal.units import to_unit
from tests.generators.texts import machine_text, setup_text

AXIS = machine_text("w-b-X-t", {"X": (0, 1000)}, {"EXX": ("30 um", 7, 300)}, tool=0, name="one")
LASER = setup_text("laser", "interferometer", direction="x", noise="0.3 um", drift="0 um/h")
PPM = 1e-6
STATED = """temperature_std = "0.5 K"
expansion_std = "1 um/m/K"
type_b = { scale = "2 um/m", air = "1 um/m", cosine = "2 mrad" }
"""
WARM = 'temperature = "23 degC"\nexpansion = "11.7 um/m/K"'


def described(setups: str) -> CampaignDescription:
    """Return a campaign whose errors are as stated and nothing besides."""
    text = f'machine = "m.toml"\nusual = "off"\n[target]\nreadings = 20\n{setups}'
    return campaign_from_texts(text, "c.toml", AXIS, "m.toml")


def observed(campaign: CampaignDescription) -> Observation:
    return Observation(campaign.machine, campaign.setups)


class Met(NamedTuple):
    """A cause that is there: whether its size is stated, and what one standard deviation does to each number, (m,)."""

    stated: bool
    column: Array


def causes(observation: Observation, readings: Sequence[Reading], usual: bool = True) -> dict[str, Met]:
    places = places_of(observation.setups, readings)
    found = contributions(observation, places, [each.values for each in readings], usual)
    return {each.row.name: Met(each.stated, each.effects) for each in found}


def read_at(places: Array, values: Array | None = None, setup: str = "laser") -> list[Reading]:
    shown = np.zeros(len(places)) if values is None else values
    return [Reading(setup, (float(x),), (1,), float(y)) for x, y in zip(places, shown, strict=True)]


def _shown(row: TypeB) -> str:
    """Return a row as the page has it."""
    unit = row.unit if row.unit != "mm/m" else "%"
    size = 100 * row.size if unit == "%" else float(to_unit(row.size, unit))
    longer = f" + {row.longer * 1e6:g} um/m" if row.longer else ""
    instruments = sorted(name for name, kind in INSTRUMENTS.items() if _told(row) in map(_told, kind.type_b))
    named = "any length" if len(instruments) == 6 else ", ".join(instruments)
    least = f", at least {row.least * 1e6:g} um" if row.least else ""
    default = f"{size:.3g} {unit}{longer}{least}"
    return f"| {' | '.join((row.name, named, default, row.distribution, row.shared, row.source))} |"


def _told(row: TypeB) -> tuple[str, float, str]:
    return row.name, row.size, row.source


@pytest.mark.parametrize("row", [row for kind in INSTRUMENTS.values() for row in kind.type_b], ids=_told)
def test_the_page_has_every_row_with_its_source(row: TypeB) -> None:
    page = (Path(__file__).parents[2] / "docs" / "promise.md").read_text(encoding="utf-8")
    assert _shown(row) in page
    assert len(row.source) > 5
    assert row.size > 0
    assert all(kind.type_b for kind in INSTRUMENTS.values())  # none of them is perfect


def test_columns_of_a_laser_are_strains_of_the_way_from_the_middle_of_what_it_read() -> None:
    places = np.array([0.1, 0.2, 0.3, 0.9])
    found = causes(observed(described(LASER)), read_at(places))
    way = places - 0.375
    expected = {
        "scale": 1.0,
        "air": np.hypot(0.5, 0.54),
        "cosine": 0.5 / np.sqrt(3.0),
        "temperature": 11.7,
        "expansion": 1.0,
    }
    assert set(found) == set(expected)
    for name, strain in expected.items():
        assert found[name].column == pytest.approx(strain * PPM * way, abs=1e-15), name
        assert not found[name].stated


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (WARM, {"temperature": 0.3 * 11.7, "expansion": 3.0}),
        ('temperature = "23 degC"\nexpansion = "8 um/m/K"', {"temperature": 0.3 * 8.0, "expansion": 3.0}),
        (
            f'{WARM}\ntemperature_std = "0.2 K"',
            {"expansion": 3.0},
        ),
        (
            f'{WARM}\ntemperature_std = "0.2 K"\nexpansion_std = "1 um/m/K"',
            {},
        ),
        ('temperature_std = "0.2 K"', {"temperature": 0.2 * 11.7, "expansion": 0.2}),
        ('temperature_std = "0 K"', {}),
        ('unknowns = { zero = "1 mm", growth = "5 um/m" }', {}),
    ],
)
def test_what_is_said_of_the_temperature_replaces_what_is_usual(text: str, expected: dict[str, float]) -> None:
    """What is stated of a temperature that is corrected is the unknown growth: it does not count twice."""
    found = causes(observed(described(LASER + text)), read_at(np.array([0.0, 1.0])))
    material = {name: each.column[1] * 2 / PPM for name, each in found.items() if name in ("temperature", "expansion")}
    assert material == pytest.approx(expected)


def test_what_is_stated_counts_where_nothing_usual_does() -> None:
    readings = read_at(np.array([0.0, 1.0]))
    found = causes(observed(described(LASER + STATED)), readings, usual=False)
    assert set(found) == {"scale", "air", "cosine", "temperature", "expansion"}
    assert all(each.stated for each in found.values())
    assert found["scale"].column == pytest.approx([-1e-6, 1e-6])
    assert causes(observed(described(LASER)), readings, usual=False) == {}


BEDSIDE = """[[setups]]
name = "s"
moves = ["X"]
drift = "0"
"""


@pytest.mark.parametrize(
    ("setup", "name", "expected"),
    [
        ('instrument = "level"\ndirection = "y"', "gain", 0.02 * np.array([-25e-6, 0.0, 25e-6])),
        ('instrument = "autocollimator"\ndirection = "y"', "gain", 0.01 * np.array([-25e-6, 0.0, 25e-6])),
        ('instrument = "indicator"\ndirection = "y"', "gain", np.array([-0.5e-6, 0.0, 0.5e-6])),
        ('instrument = "straightedge"\ndirection = "y"', "bow", 2e-6 * np.array([1.0, 0.0, 1.0])),
        ('instrument = "probe"\ndirection = "x"\nunknowns = {}', "pre_travel", [1e-6, 1e-6, 1e-6]),
    ],
)
def test_columns_by_hand(setup: str, name: str, expected: Array) -> None:
    """The level reads 0 to 50 urad: 2 % of it. 1 % of the dial's 50 um would be 0.5 um between the ends; it is 1 um."""
    readings = read_at(np.array([0.0, 0.5, 1.0]), np.array([0.0, 25e-6, 50e-6]), "s")
    found = causes(observed(described(BEDSIDE + setup)), readings)
    assert found[name].column == pytest.approx(np.asarray(expected), abs=1e-15)
    assert "temperature" not in found  # it compares with no length


MILL, FIVE = "three-axis-mill", "dmu60"
POSES = [(0.1, 0.2, 0.3), (0.4, 0.1, 0.2), (0.5, 0.3, 0.1)]


def in_space(
    setup: str, artefact: str = "", machine: str = MILL, poses: Sequence[tuple[float, ...]] = POSES
) -> tuple[dict[str, Met], Observation]:
    """Return the causes of one set-up at poses, and what it sees."""
    text = f'machine = "{machine}"\nusual = "off"\n[target]\nreadings = 20\n{artefact}[[setups]]\nname = "s"\n{setup}'
    observation = observed(campaign_from_texts(text, "c.toml", load_machine(machine).text, machine))
    numbers = int(observation.counts[0])
    readings = [Reading("s", pose, (1,) * len(pose), 0.0, others=(0.0,) * (numbers - 1)) for pose in poses]
    return causes(observation, readings), observation


def tips(observation: Observation) -> Array:
    return observation.machine.frames(np.array(POSES)).tcp


def test_a_tracer_is_off_by_a_share_of_its_distance_and_grows_with_the_tool() -> None:
    found, observation = in_space('instrument = "tracer"\nstation = ["0 mm", "0 mm", "-300 mm"]')
    line = tips(observation) - [0.0, 0.0, -0.3]
    distance = np.linalg.norm(line, axis=1)
    assert found["scale"].column == pytest.approx(1.5e-6 * distance)
    way = tips(observation) - tips(observation).mean(axis=0)
    assert found["temperature"].column == pytest.approx(11.7e-6 * np.sum(way * line / distance[:, None], axis=1))


def test_a_tracker_is_off_by_a_share_of_the_way_along_each_of_its_directions() -> None:
    found, observation = in_space('instrument = "tracker"\nstation = ["3 m", "0 mm", "0 mm"]')
    way = tips(observation) - tips(observation).mean(axis=0)
    assert found["scale"].column.reshape(3, 3) == pytest.approx(1.5e-6 * way, rel=1e-6, abs=0.0)


def test_a_bar_of_known_length_is_off_by_it_and_one_that_is_open_is_not() -> None:
    bar = 'instrument = "ballbar"\nlength = "150 mm"\nstation = ["300 mm", "250 mm", "100 mm"]\nplane = "xy"\n'
    found, _ = in_space(bar + 'unknowns = { station_x = "1 um" }')
    assert found["length"].column == pytest.approx(np.full(3, 1.3e-6))
    assert "length" not in in_space(bar)[0]


def test_a_leg_of_a_square_is_off_by_half_of_the_variance_of_its_angle() -> None:
    square = '[[artefacts]]\nname = "square"\n'
    leg = 'instrument = "straightedge"\ndirection = "y"\nmoves = ["X"]\nreach = { X = ["50 mm", "550 mm"] }\n'
    found, observation = in_space(leg + 'artefact = "square"', square)
    way = np.array(POSES)[:, 0] - np.mean(observation.machine.axes[0].travel)
    assert found["square"].column == pytest.approx(10e-6 / np.sqrt(2.0) * way)
    assert "square" not in in_space(leg)[0]


def test_a_sphere_in_the_mean_of_opposite_sides_shows_its_size_at_the_pole() -> None:
    """The pole goes with the tool, as touch_frames says; a size that is an unknown holds what three touches show."""
    poses = np.zeros((3, 5))
    poses[:, [axis.rotary for axis in load_machine(FIVE).axes]] = np.radians([[0, 0], [30, 0], [30, 90]])
    ball = '[[artefacts]]\nname = "one"\nballs = { one = ["100 mm", "0 mm", "100 mm"] }\n'
    setup, visited = 'instrument = "sphere"\nartefact = "one"\n', [tuple(pose) for pose in poses.tolist()]
    found, observation = in_space(setup, ball, FIVE, visited)
    assert set(found) == {"radius"}
    pole = observation.machine.frames(poses).stem
    assert found["radius"].column.reshape(3, 3) == pytest.approx(-1e-6 * pole, abs=1e-15)


def test_one_laser_has_one_scale_in_all_its_set_ups_and_lies_anew_in_each() -> None:
    again = LASER.replace('"laser"', '"again"')
    readings = read_at(np.array([0.0, 1.0])) + read_at(np.array([0.0, 1.0]), setup="again")
    observation = observed(described(LASER + again))
    places = places_of(observation.setups, readings)
    found = contributions(observation, places)
    assert sorted((each.row.name, each.owner) for each in found) == [
        ("air", ""),
        ("cosine", "again"),
        ("cosine", "laser"),
        ("expansion", ""),
        ("scale", "interferometer"),
        ("temperature", ""),
    ]
