"""Ways of programs, entries too, keep out of boxes: read from their text by kinematics of the tests' own."""

from decimal import Decimal

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.exceptions import InputError, ProgramError
from axiscal.machine import load_machine
from axiscal.measurement.charts.room import Room
from axiscal.measurement.reading import Place
from axiscal.numerics import Array
from axiscal.programs import dialect, programs
from axiscal.programs.kept_out import free, refuse_kept_out
from axiscal.programs.scale import AxisScale, ReadingTarget
from axiscal.programs.steps import Move
from tests.generators.printed_machine import printed_machine
from tests.generators.program_ways import Reader
from tests.generators.said_places import Said
from tests.generators.texts import machine_text
from tests.generators.ways_said import WaysSaid
from tests.programs.test_drawn_back import places_of

TEXT = """
machine = "{machine}"
[[artefacts]]
name = "ball"
balls = {{ one = ["120 mm", "0 mm", "-60 mm"] }}
keep_out = [{box}]
[[setups]]
name = "s"
instrument = "{instrument}"
artefact = "ball"
raster = {{ B = "15 deg", C = "15 deg" }}
approach = "both"
"""
SWIVEL = machine_text(
    "w-C'-b-X-Y-Z-B-t",
    {"X": (-500, 500), "Y": (-500, 500), "Z": (-400, 600), "B": (-100, 100), "C": (0, 360)},
    {"EXX": 'std = "10 um"'},
    tool=200,
    name="head that swivels",
)
VICE = '{ x = ["-60 mm", "60 mm"], y = ["-60 mm", "60 mm"], z = ["-300 mm", "60 mm"] }'
"""Beside the ball, higher than it: a tool that is tilted away from the spindle's way up runs into it."""
FAR = '{ z = ["-900 mm", "-800 mm"] }'
SOURCES = {"dmu60": load_machine("dmu60").text, "machine.toml": SWIVEL}


def described(instrument: str, box: str, machine: str) -> CampaignDescription:
    text = TEXT.format(instrument=instrument, box=box, machine=machine)
    return campaign_from_texts(text, "c.toml", SOURCES[machine], machine)


def a_box(rng: np.random.Generator) -> str:
    """Return a box of some size beside the ball, as text."""
    low = rng.uniform([-200, -250, -300], [60, 200, -250])
    high = low + rng.uniform([60, 60, 100], [150, 150, 400])
    pairs = zip("xyz", low.tolist(), high.tolist(), strict=True)
    return "{ " + ", ".join(f'{axis} = ["{a:.1f} mm", "{b:.1f} mm"]' for axis, a, b in pairs) + " }"


def moves(text: str) -> list[str]:
    """Return the lines of a program without what its head says."""
    return [line for line in text.splitlines() if "KEPT OUT" not in line]


def hits(instrument: str, box: str, machine: str, places: list[Place], text: str, controller: str) -> bool:
    """Return whether the tests' own kinematics see a pose of a program with the tool in the box."""
    said = Said(TEXT.format(instrument=instrument, box=box, machine=machine), printed_machine(SOURCES[machine]))
    twin = WaysSaid(said, "s", controller)
    reader = Reader(said.machine, controller, 15)
    try:
        for _, poses in reader.follow(text):
            for pose in poses:
                twin.keeps_out(pose)
    except AssertionError:
        return True
    return False


@pytest.mark.parametrize("machine", ["machine.toml", pytest.param("dmu60", marks=pytest.mark.long)])
def test_programs_beside_boxes_keep_out_or_are_refused(machine: str) -> None:
    found, instrument = set(), "sphere"
    for seed in range(4):
        rng = np.random.default_rng(seed)
        box, controller = (VICE, a_box(rng))[seed % 2], ("heidenhain", "sinumerik", "isg")[seed % 3]
        try:
            campaign, free = described(instrument, box, machine), described(instrument, FAR, machine)
        except InputError:
            continue  # the ball is in the box
        places = places_of(campaign, 2, seed)
        (careless,) = programs(free.machine, free.setups, places, dialect(controller))
        before = hits(instrument, box, machine, places, careless.text, controller)
        try:
            (program,) = programs(campaign.machine, campaign.setups, places, dialect(controller))
        except ProgramError as refused:
            found.add((before, "refused", "kept out" in str(refused)))
            continue
        assert not hits(instrument, box, machine, places, program.text, controller), (seed, box, places)
        found.add((before, "written", moves(program.text) == moves(careless.text)))
    assert (False, "written", True) in found
    assert not {each for each in found if each[1:] == ("refused", False)}


def test_a_way_is_free_where_no_fine_sample_of_it_meets_a_box() -> None:
    machine, rng = load_machine("dmu60"), np.random.default_rng(8)
    low, high = np.array([axis.travel for axis in machine.axes]).T
    rotary = np.array([axis.rotary for axis in machine.axes])
    found: list[tuple[bool, bool]] = []
    for _ in range(120):
        corner = rng.uniform(-0.3, 0.1, 3)
        room = Room(machine, np.stack([corner, corner + rng.uniform(0.02, 0.2, 3)], axis=1)[None])
        start = rng.uniform(low, high)
        stop = np.where(rotary == (rng.random() < 0.5), rng.uniform(low, high), start)
        shares: Array = np.linspace(0, 1, 2001)[:, None]
        at = machine.frames(start + shares * (stop - start))
        found.append((free(room, start, stop), not room.hit(at.tcp, at.stem, -2e-6).any()))
    assert all(sampled for proven, sampled in found if proven)
    assert sum(sampled and not proven for proven, sampled in found) <= 1  # what only grazes may be refused
    assert {proven for proven, _ in found} == {True, False}


def test_a_way_into_a_box_is_refused_with_the_reading_it_leads_to() -> None:
    machine = load_machine("dmu60")
    box = '{ x = ["0 mm", "100 mm"], y = ["-100 mm", "100 mm"], z = ["-500 mm", "500 mm"] }'
    (setup,) = described("rtest", box, "dmu60").setups
    scales = [AxisScale.of_axis(axis, 4) for axis in machine.axes]
    x, y, z = (machine.index(name) for name in "XYZ")
    start = {k: Decimal(0) for k in range(len(machine.axes))} | {x: Decimal(-200), z: Decimal(0)}
    through, around = Move({x: Decimal(200)}, 500, 1.0), Move({y: Decimal(200)}, 500, 1.0)
    reached = ReadingTarget(4, (), (), ())
    begun = Move(start, 500, 1.0)
    refuse_kept_out(machine, setup, {4: 0}, scales, [begun, around, reached])
    with pytest.raises(ProgramError, match=r'the way to reading 4 of the set-up "s" leads into "ball"'):
        refuse_kept_out(machine, setup, {4: 0}, scales, [begun, through, reached])
    with pytest.raises(ProgramError, match="the way from the last reading"):
        refuse_kept_out(machine, setup, {4: 0}, scales, [begun, reached, through])


def test_a_sphere_is_not_asked_for_where_the_tool_drawn_back_meets_a_box() -> None:
    above = '{ x = ["80 mm", "160 mm"], y = ["-40 mm", "40 mm"], z = ["105 mm", "130 mm"] }'  # the tool is 120 mm long
    poses = {}
    for instrument in ("rtest", "sphere"):
        (setup,) = described(instrument, above, "dmu60").setups
        assert setup.chart is not None
        poses[instrument] = setup.chart.feasible(setup.chart.poses(np.zeros((1, 2)))).tolist()
    assert poses == {"rtest": [True], "sphere": [False]}
