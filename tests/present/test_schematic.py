"""Schematics of set-ups: where their parts are, against a chain of matrices of the tests' own, for every machine."""

import itertools
import re
from xml.etree import ElementTree

import numpy as np
import pytest

from axiscal.numerics import Array
from axiscal.present.drawing.scene import Arrow, RoundMark
from axiscal.present.schematic import (
    DrawnMachine,
    machine_schematic,
    plan_picture,
    setup_picture,
    setup_schematic,
)
from axiscal_core.machine import Machine
from tests.generators.kinematics import shifted, tip, turned
from tests.present.drawn_words import Box, boxes_of, held_inside
from tests.present.pictured import MACHINES, Placed, placed_campaigns

SVG = "{http://www.w3.org/2000/svg}"


def _poses(machine: Machine) -> list[Array]:
    rng = np.random.default_rng(len(machine.chain))
    low, high = np.array([axis.travel for axis in machine.axes]).T
    return [low, high, *(low + (high - low) * rng.random((3, len(low))))]


def _carried(machine: Machine, part: int, pose: Array) -> Array:
    """Return the motion of what an axis carries against the bed, (4, 4), link by link."""
    links = machine.chain.split("-")
    bed, own = links.index("b"), machine.axes[part].name
    names = (
        links[bed + 1 : -1]
        if not machine.axes[part].workpiece_side
        else [n.rstrip("'") for n in links[bed - 1 : 0 : -1]]
    )
    motion = np.eye(4)
    for name in names[: names.index(own) + 1]:
        axis, at = machine.axis(name), pose[machine.index(name)]
        if axis.counting == "reversed":
            at = -at
        origin = np.array(axis.origin)
        step = (
            shifted(origin) @ turned(name[0], at) @ shifted(-origin)
            if axis.rotary
            else shifted(at * np.eye(3)["XYZUVWPQR".index(name[0]) % 3])
        )
        motion = motion @ (np.linalg.inv(step) if axis.workpiece_side else step)
    return motion


@pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: machine.chain)
def test_the_tip_is_where_the_chain_puts_it(machine: Machine) -> None:
    tools = [k for k, axis in enumerate(machine.axes) if not axis.workpiece_side]
    for pose in _poses(machine):
        room = DrawnMachine(machine, pose)
        np.testing.assert_allclose(room.placed(tip(machine, pose)[None])[0], room.tip, atol=1e-12)
        if tools:
            held = _carried(machine, tools[-1], pose)
            on_bed = room.upright @ (held @ [0, 0, -machine.tool_length, 1])[:3]
            np.testing.assert_allclose(room.tip, on_bed, atol=1e-12)
            np.testing.assert_allclose(room.stem, room.upright @ held[:3, 2], atol=1e-12)


def _arrows(machine: Machine) -> dict[str, Arrow]:
    parts = machine_schematic(machine, lengths=False).parts
    return {part.words: part for part in parts if isinstance(part, Arrow)}


@pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: machine.chain)
def test_an_axis_is_drawn_along_the_way_on_which_its_part_moves(machine: Machine) -> None:
    room, arrows = DrawnMachine(machine, [0.0] * len(machine.axes)), _arrows(machine)
    assert set(arrows) == {axis.name + ("′" if axis.workpiece_side else "") for axis in machine.axes}
    for k, axis in enumerate(machine.axes):
        arrow, further = arrows[axis.name + ("′" if axis.workpiece_side else "")], room.home.copy()
        further[k] += 1e-6
        step = _carried(machine, k, further) @ np.linalg.inv(_carried(machine, k, room.home))
        if axis.rotary:
            _turns_with(room, arrow, step)
        else:
            way = room.upright @ step[:3, 3] / 1e-6
            drawn = arrow.points[-1] - arrow.points[0]
            np.testing.assert_allclose(drawn / np.linalg.norm(drawn), way, atol=1e-5)


def _turns_with(room: DrawnMachine, arrow: Arrow, step: Array) -> None:
    """An arc is about the line of its axis, and a point of it moves along it as the axis turns."""
    inside = room.upright.T @ arrow.points.T
    middle = inside.shape[1] // 2
    moved = step @ np.vstack([inside, np.ones(inside.shape[1])])
    went = (moved[:3] - inside)[:, middle]
    along = inside[:, middle + 1] - inside[:, middle - 1]
    assert went @ along / np.linalg.norm(went) / np.linalg.norm(along) == pytest.approx(1.0, abs=1e-4)
    axis = np.linalg.svd(step[:3, :3] - np.eye(3))[2][-1]
    heights = axis @ inside
    np.testing.assert_allclose(heights, heights[0], atol=1e-9)


@pytest.fixture(scope="module")
def campaigns(tmp_path_factory: pytest.TempPathFactory) -> list[Placed]:
    """Every campaign of the how-tos, the examples and the demos, with places of readings."""
    return placed_campaigns(tmp_path_factory.mktemp("campaigns"))


def test_readings_are_drawn_where_the_tool_is_on_the_table(campaigns: list[Placed]) -> None:
    for _, campaign, places in campaigns:
        for setup in campaign.setups:
            own = [place for place in places if place.setup == setup.name]
            scene = setup_schematic(campaign, setup, places, own[0])
            dots = [part.points for part in scene.parts if isinstance(part, RoundMark) and part.colour == "read"]
            machine, pose = campaign.machine, np.array(own[0].pose)
            room = DrawnMachine(machine, pose)
            work = [k for k, axis in enumerate(machine.axes) if axis.workpiece_side]
            held = _carried(machine, work[0], pose) if work else np.eye(4)
            for place in own:
                there = room.upright @ (held @ np.append(tip(machine, np.array(place.pose)), 1.0))[:3]
                assert min(np.linalg.norm(there - dot) for dot in dots) < 1e-9


def _heads(drawing: ElementTree.Element) -> list[Box]:
    """Return what the heads of the arrows of linear axes cover."""
    found = []
    for path in drawing.iter(f"{SVG}path"):
        numbers = [float(each) for each in re.findall(r"-?[\d.]+", path.get("d", ""))]
        if path.get("fill") == "var(--ink)" and len(numbers) == 6:
            found.append(Box(min(numbers[::2]), min(numbers[1::2]), max(numbers[::2]), max(numbers[1::2])))
    return found


Drawn = list[tuple[str, ElementTree.Element]]


@pytest.fixture(scope="module")
def drawn(campaigns: list[Placed]) -> Drawn:
    """The plan of every campaign as a file has it, and its first set-up on a telephone."""
    made = [(name, plan_picture(of.machine.name, of, places)) for name, of, places in campaigns]
    made += [(name, setup_picture(setup_schematic(of, of.setups[0], places), 360)) for name, of, places in campaigns]
    return [(name, ElementTree.fromstring(picture)) for name, picture in made]


def test_heads_of_arrows_lie_apart_and_no_word_over_them(drawn: Drawn) -> None:
    for name, root in drawn:
        heads = _heads(root)
        assert heads
        assert [name for one, other in itertools.combinations(heads, 2) if one.over(other)] == []
        assert [(name, words) for words, box in boxes_of(root) for head in heads if box.over(head)] == []


def test_words_are_inside_of_the_picture_and_none_lies_over_another(drawn: Drawn) -> None:
    for _, root in drawn:
        _, _, wide, high = map(float, root.get("viewBox", "").split())
        held_inside(boxes_of(root), wide, high)


def test_a_name_stays_a_name(campaigns: list[Placed]) -> None:
    hostile = "<script>alert(1)</script>"
    _, campaign, places = campaigns[0]
    text = plan_picture(hostile, campaign, places[:3])
    assert hostile not in text
    assert ElementTree.fromstring(text).findtext(f"{SVG}title") == hostile
