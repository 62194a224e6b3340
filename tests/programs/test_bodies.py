"""No way of a program comes nearer to posts than it may: random machines and boards, judged by samples of its text."""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.description.first_campaign import Purpose, first_campaign
from axiscal.description.first_files import first_described, of_builtin
from axiscal.exceptions import DescriptionError, InputError
from axiscal.machine import machine_from_text
from axiscal.measurement.candidates import spread
from axiscal.measurement.reading import Place
from axiscal.numerics import Array
from axiscal.programs import dialect, programs
from axiscal.programs.program import standing
from tests.generators.kinematics import stem, tip, turned
from tests.generators.printed_machine import PrintedMachine, number, printed_machine
from tests.generators.program_ways import Reader
from tests.generators.said_places import spot
from tests.generators.solids import nearest, post, solids
from tests.generators.texts import machine_text

CLEAR = 5e-3
"""m between a post and anything that moves."""
_OWN = 60e-3
"""m from its middle, within which the stylus is at the ball that it touches."""
_DOWN = 0.3
"""m of a post that are looked at."""
CHAINS = ("w-X'-Y'-b-Z-t", "w-Y'-b-X-Z-t", "w-b-X-Y-Z-t", "w-X'-Y'-Z'-b-t")


def a_machine(rng: np.random.Generator) -> str:
    """Return the text of a machine with a probe, a holder and a nose of some size."""
    x, y, z = rng.uniform([200, 180, 100], [1200, 900, 500]).round(1).tolist()
    travels = {"X": (0.0, x), "Y": (-y / 2, y / 2), "Z": (-z, 0.0)}
    text = machine_text(str(rng.choice(CHAINS)), travels, {"EXX": 'std = "10 um"'}, tool=float(rng.uniform(60, 200)))
    reach, wide, head, high = rng.uniform([25, 12, 60, 60], [80, 40, 220, 200]).round(1).tolist()
    sizes = f'stylus = "{rng.choice([2, 4, 6, 8])} mm"\nreach = "{reach} mm"\nradius = "{wide} mm"\n'
    return text.replace("[tool]\n", f'[tool]\n{sizes}head = ["{head} mm", "{high} mm"]\n')


def a_board(rng: np.random.Generator, machine: PrintedMachine) -> str:
    """Return the text of a campaign with balls of some heights near each other, put down within the travels."""
    ends = np.array([[machine.axis(name).travel for name in "XYZ"]])[0]
    middle, span, count = ends.mean(axis=1), 350 * np.ptp(ends, axis=1), int(rng.integers(3, 6))
    places = rng.uniform([-span[0], -span[1], 0], [*span[:2], rng.choice([10, 90])], (count, 3))
    balls = ", ".join(f'b{k} = ["{x:.0f} mm", "{y:.0f} mm", "{z:.0f} mm"]' for k, (x, y, z) in enumerate(places))
    low = 1e3 * (ends[2, 0] - machine.tool_length) + 20
    return f"""
machine = "machine.toml"
[[artefacts]]
name = "board"
balls = {{ {balls} }}
calibrated = "0.3 mm"
diameter = "{rng.choice([12, 25, 30])} mm"
[[setups]]
name = "placement 1"
instrument = "sphere"
artefact = "board"
at = ["{1e3 * middle[0]:.0f} mm", "{1e3 * middle[1]:.0f} mm", "{low:.0f} mm"]
turn = "{rng.integers(-20, 20)} deg"
retract = "{rng.choice([25, 40])} mm"
"""


def offered_board(source: str) -> str:
    """Return the board that is offered for a machine, in its first placement; raises DescriptionError for none."""
    text = first_campaign(machine_from_text(source), ["sphere"], Purpose())
    return "[[setups]]".join(text.split("[[setups]]")[:2])


def program(campaign: CampaignDescription, rng: np.random.Generator) -> str:
    """Return the program of a few readings of the first set-up."""
    found = spread(campaign.machine, campaign.setups[:1], 40)
    chosen = rng.permutation(len(found))[:3]
    poses, sides = found.poses[chosen].tolist(), found.approaches[chosen].astype(int).tolist()
    places = [Place(campaign.setups[0].name, tuple(p), tuple(s)) for p, s in zip(poses, sides, strict=True)]
    (written,) = programs(campaign.machine, campaign.setups, places, dialect("linuxcnc"), log=True)
    return written.text


def poses_of(text: str, machine: PrintedMachine) -> list[Array]:
    """Return poses all along the ways of a program, and where its touches end that meet nothing."""
    reader, found = Reader(machine, "linuxcnc", 9), list[Array]()
    for line in text.splitlines():
        found += [pose for _, poses in reader.follow(line) for pose in poses]
        if line.startswith("O<axiscal_touch> CALL"):
            into = [1e-3 * float(each) for each in re.findall(r"\[(.*?)\]", line)[2:5]]
            there = reader.at | dict(zip("XYZ", into, strict=True))
            found.append(np.array([there[axis.name] for axis in machine.axes]))
    return found


def least(text: str, campaign: str, machine: PrintedMachine) -> float:
    """Return how near anything comes to a post, m; the stylus to others than the one that it touches.

    So is it to the board and its risers, which begin a diameter below the middle of the lowest ball.
    """
    tables = tomllib.loads(campaign)
    (board,), setup = tables["artefacts"], tables["setups"][0]
    put, radius = turned("C", number(setup["turn"]))[:3, :3], number(board["diameter"]) / 2
    places = {name: put @ spot(place) + spot(setup["at"]) for name, place in board["balls"].items()}
    posts = {name: post(place, _DOWN) for name, place in places.items()}
    poses = np.unique(np.round(poses_of(text, machine), 7), axis=0)
    tips, stems = (np.array([each(machine, pose) for pose in poses]) for each in (tip, stem))
    low, high = (each([*places.values()], axis=0) for each in (np.min, np.max))
    board = np.stack(np.meshgrid(*np.linspace(low[:2], high[:2], 21).T, low[2] - 3 * radius), -1).reshape(-1, 3)
    found, places = np.inf, places | {"board": board[0]}
    for ball, points in (posts | {"board": board}).items():
        for name, solid in solids(machine).items():
            own = np.linalg.norm(tips - places[ball], axis=1) < (_OWN if name == "stylus" and ball in posts else 0.0)
            apart = nearest(tips[~own], stems[~own], solid, points)
            found = min(found, float(apart.min(initial=np.inf)) - radius)
    return found


def judged(seed: int, careless: bool = False) -> str:
    """Return what becomes of one board on one machine.  careless : the program knows of no size of what moves"""
    rng = np.random.default_rng(seed)
    source = a_machine(rng)
    printed = printed_machine(source)
    offered = seed % 2 == 0
    try:
        text = offered_board(source) if offered else a_board(rng, printed)
    except DescriptionError:
        return "not offered"
    known = re.sub(r"(radius|reach) = .*\n", "", source) if careless else source
    known = re.sub(r"head = .*\n", 'radius = "1 mm"\nreach = "300 mm"\n', known) if careless else known
    try:
        written = program(campaign_from_texts(text, "campaign.toml", known, "machine.toml"), rng)
    except InputError:
        return "offered and refused" if offered else "refused"
    near = least(written, text, printed)
    assert careless or near >= CLEAR - 1e-5, (seed, near)
    return "near" if near < CLEAR else "far"


@pytest.mark.parametrize("seeds", [range(5), pytest.param(range(5, 25), marks=pytest.mark.long)])
def test_nothing_comes_nearer_to_a_post_than_the_clearance(seeds: range) -> None:
    found = Counter(judged(seed) for seed in seeds)
    assert found["far"] >= len(seeds) / 3
    assert found["refused"] > 0
    assert found["offered and refused"] == 0


@pytest.mark.parametrize("seed", [33, 35])
def test_the_judge_sees_a_program_that_knows_of_no_sizes(seed: int) -> None:
    assert judged(seed, careless=True) == "near"
    assert judged(seed) == "refused"


def test_posts_that_init_offers_are_below_the_nose_that_touches_beside_them() -> None:
    described = first_described(of_builtin("three-axis-mill"), ["sphere"], Purpose())
    printed = printed_machine(described.machine.text)
    heights = [number(at[2]) for at in tomllib.loads(described.text)["artefacts"][0]["balls"].values()]
    assert printed.nose.head == (0.13, 0.13)
    assert 0.02 < max(heights) - min(heights) < printed.tool_length - CLEAR


def test_a_program_says_at_its_head_and_at_its_stops_what_stands_where() -> None:
    rng = np.random.default_rng(0)
    source = a_machine(rng)
    campaign = campaign_from_texts(offered_board(source), "campaign.toml", source, "machine.toml")
    lines = program(campaign, rng).splitlines()
    assert sum(line.startswith("(BALL ") and line.endswith("AND ITS POST)") for line in lines) == 8
    assert "(IT IS ASSUMED THAT NOTHING ELSE STANDS IN THE WAY)" in lines
    assert sum(line.startswith(("(STYLUS", "(HOLDER", "(NOSE")) for line in lines) == 3
    under = lines[: lines.index("(MSG, PUT DOWN BOARD THEN PRESS START)")]
    assert under[-1].startswith("G53 G1 X")  # above, where there is room to put it down
    (setup, *_), artefact = campaign.setups, campaign.setups[0].artefact
    assert artefact is not None
    unsaid = list(standing(campaign.machine, replace(setup, artefact=replace(artefact, diameter=None))))
    assert unsaid[0] == "NOTHING KEEPS CLEAR OF THE BALLS AS NOBODY SAID HOW LARGE THEY ARE"
