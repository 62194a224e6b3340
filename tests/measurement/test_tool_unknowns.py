"""A tool that is longer than stated, or sits aside of the spindle's axis, is no error of the machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from axiscal.answers.prediction import tcp_prediction
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.estimation.estimation import Estimation
from axiscal.machine import load_machine
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import Deviation, SmallMotions, frames, tool_motion
from axiscal.measurement.candidates import spread
from axiscal.measurement.instrument import model_of
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal.planning.unseen import hidden_of
from tests.generators.texts import TWO_SPHERES

_STATION = 'station = ["300 mm", "-800 mm", "-300 mm"]'
_LONGER = 50e-6
_AS_STATED = 'usual = "off"\nsure = "exactly"'
_ZEROS_ONLY = 'unknowns = { zero_x = "1 mm", zero_y = "1 mm", zero_z = "1 mm" }'


def _described(machine: str, setup: str, head: str = "") -> CampaignDescription:
    text = f'machine = "{machine}"\n{head}\n[target]\nreadings = 1\n[[setups]]\nname = "it"\n{setup}\n'
    return campaign_from_texts(text, "campaign.toml", load_machine(machine).text, machine)


def _poses(machine: Machine, count: int, seed: int) -> Array:
    low, high = np.clip(np.array([axis.travel for axis in machine.axes]).T, -np.pi, np.pi)
    return np.random.default_rng(seed).uniform(low, high, (count, len(low)))


@pytest.mark.parametrize("instrument", ["rtest", "tracker", "tracer", "ballbar"])
def test_it_moves_the_readings_as_another_tool_moves_the_point_of_the_chain(instrument: str) -> None:
    """The chain of a machine whose tool is longer by e is the judge: e along −z of the tool."""
    described = _described("dmu60", f'instrument = "{instrument}"\n{"" if instrument == "rtest" else _STATION}')
    machine, (setup,) = described.machine, described.setups
    poses = _poses(machine, 20, 1)
    still = SmallMotions(*(np.zeros((len(machine.axes), len(poses), 3)) for _ in range(3)))
    longer, stated = (tool_motion(m, poses, still) for m in (replace(machine, tool=machine.tool + _LONGER), machine))
    moved = Deviation(longer.translation - stated.translation, np.zeros((len(poses), 3)))
    kind = model_of(setup)(setup, machine)
    expected = kind.shown(kind.places(poses, deviation=moved), {})
    assert kind.shown(kind.places(poses), {"tool_z": -_LONGER}) == pytest.approx(expected, abs=1e-14)
    row = kind.own_slopes(kind.places(poses), ["tool_z"])[:, :, 0]
    assert -_LONGER * row == pytest.approx(expected, abs=_LONGER**2 / 0.1)


def test_a_tool_fifty_um_too_long_is_not_taken_for_an_error_of_the_machine() -> None:
    for head in ("", _AS_STATED):
        missed, promised = _missed("", head)
        assert missed < 1.5 * promised
    missed, promised = _missed(_ZEROS_ONLY, _AS_STATED)
    assert missed > 3 * promised  # what the unknown is for; readings that disagree are promised less well


def _missed(unknowns: str, head: str) -> tuple[float, float]:
    """Return RMS of the TCP's deviation less its prediction, and what is promised, by 30 readings of an R-test, m."""
    described = _described("dmu60", f'instrument = "rtest"\n{unknowns}', head)
    machine = Simulator(described.machine, described.setups).drawn(0)
    machine = replace(machine, offsets={"it": {"zero_x": 2e-4, "tool_z": -_LONGER}})
    readings, rng = list[Reading](), np.random.default_rng(0)
    ahead = (1,) * len(described.machine.axes)
    for pose in _poses(described.machine, 30, 2):
        value, *others = machine.read_all(described.setups[0], tuple(pose), ahead, rng)
        readings.append(Reading("it", tuple(map(float, pose)), ahead, value, others=tuple(others)))
    known, at = estimated(Case(described), readings), _poses(described.machine, 200, 3)
    mean, _ = tcp_prediction(known, at, np.ones_like(at))
    left = machine.deviation(at, np.ones_like(at)) - mean
    return float(np.sqrt(np.mean(np.sum((left - left.mean(axis=0)) ** 2, axis=1)))), known.accuracy.rms


def test_where_nothing_turns_the_tool_is_one_with_the_zero_and_no_unknown() -> None:
    assert not any("tool" in u.name for u in _described("three-axis-mill", 'instrument = "rtest"').setups[0].unknowns)
    turning = _described("dmu60", 'instrument = "rtest"').setups[0].unknowns
    assert {"tool_x", "tool_y", "tool_z"} < {unknown.name for unknown in turning}


_HEAD = """
chain = "w-b-X-Y-Z-C-B-t"
[tool]
length = "120 mm"
[axes.X]
travel = ["-300 mm", "300 mm"]
[axes.Y]
travel = ["-300 mm", "300 mm"]
[axes.Z]
travel = ["-100 mm", "500 mm"]
[axes.C]
travel = ["0 deg", "360 deg"]
[axes.B]
travel = ["-60 deg", "60 deg"]
origin = ["0 mm", "0 mm", "150 mm"]
[errors]
EXX = { std = "5 um", knots = 5 }
EZZ = { std = "5 um", knots = 5 }
X0C = { std = "15 um" }
Y0C = { std = "15 um" }
X0B = { std = "15 um" }
A0B = { std = "30 urad" }
"""
_TABLE = """
chain = "w-C'-B'-b-Y-X-Z-t"
[tool]
length = "120 mm"
[axes.X]
travel = ["-300 mm", "300 mm"]
[axes.Y]
travel = ["-250 mm", "250 mm"]
[axes.Z]
travel = ["0 mm", "500 mm"]
[axes.C]
travel = ["0 deg", "360 deg"]
[axes.B]
travel = ["-30 deg", "120 deg"]
origin = ["0 mm", "0 mm", "-200 mm"]
[errors]
EXX = { std = "5 um", knots = 5 }
EZZ = { std = "5 um", knots = 5 }
X0B = { std = "15 um" }
Z0B = { std = "15 um" }
X0C = { std = "15 um" }
Y0C = { std = "15 um" }
"""
_SPHERES = """
[target]
readings = 1
[[artefacts]]
name = "spheres"
balls = { low = ["120 mm", "0 mm", "-60 mm"], high = ["-60 mm", "100 mm", "80 mm"] }
[[setups]]
name = "it"
instrument = "rtest"
artefact = "spheres"
raster = { B = "30 deg", C = "60 deg" }
"""


def _at_spheres(machine: str, tool: str) -> CampaignDescription:
    return campaign_from_texts(f'machine = "m"\n{tool}{_SPHERES}', "campaign.toml", machine, "m")


@pytest.mark.parametrize(("text", "told"), [(_HEAD, True), (_TABLE, False)], ids=["head", "table"])
def test_a_longer_tool_at_spheres_is_found_or_within_what_is_promised(text: str, told: bool) -> None:
    """The machine that is read has the longer tool in its chain, and the estimate is not told."""
    described = _at_spheres(text, "")
    case, machine = Case(described), described.machine
    wrong, own = [], []
    for seed in range(3):
        places = spread(machine, described.setups, 30)
        moved = (
            frames(replace(machine, tool=machine.tool + _LONGER), places.poses).tcp - frames(machine, places.poses).tcp
        )
        actual, rng = Simulator(machine, described.setups).drawn(seed), np.random.default_rng(seed)
        actual = replace(actual, offsets={"it": {n: v for n, v in actual.offsets["it"].items() if "tool" not in n}})
        readings = []
        for pose, sides, shift in zip(places.poses, places.approaches, moved, strict=True):
            side = tuple(int(each) for each in sides)
            value, *others = (actual.read_all(described.setups[0], tuple(pose), side, rng) + shift).tolist()
            readings.append(Reading("it", tuple(map(float, pose)), side, value, others=tuple(others)))
        known, at = estimated(case, readings), _poses(machine, 200, 3)
        left = actual.deviation(at, np.ones_like(at)) - tcp_prediction(known, at, np.ones_like(at))[0]
        wrong.append(np.sqrt(np.mean(np.sum((left - left.mean(axis=0)) ** 2, axis=1))) / known.accuracy.rms)
        own.append(_length_found(known))
    assert np.sqrt(np.mean(np.square(wrong))) < 1.5
    assert all(abs(mean + _LONGER) < 3 * std for mean, std in own)
    assert (max(std for _, std in own) < 10e-6) is told
    assert any("Measure the tool" in each.text for each in hidden_of(case)) is not told


def test_what_the_tool_hides_is_what_an_exactly_known_tool_would_show() -> None:
    doubtful, exact = (Case(_at_spheres(_TABLE, tool)).yardstick.unseen_rms for tool in ("", 'tool_length = "0 um"\n'))
    (said,) = (each for each in hidden_of(Case(_at_spheres(_TABLE, ""))) if "Measure the tool" in each.text)
    assert said.effect == pytest.approx(np.sqrt(doubtful**2 - exact**2), rel=1e-6)
    assert 0.1 * doubtful < said.effect < 0.999 * doubtful


def _length_found(known: Estimation) -> tuple[float, float]:
    """Return mean and std of tool_z, m."""
    names = [unknown.name for unknown in known.case.observation.unknowns]
    column, belief = known.case.errors.size + names.index("tool_z"), known.knowledge.belief
    return float(belief.mean[column]), float(np.linalg.norm(belief.factor[column]))


_SOURCE = 'tool_certificate = "presetter"\n'


@pytest.mark.parametrize(
    ("tool", "stds"),
    [
        ("", {"tool_x": 5e-6, "tool_y": 5e-6, "tool_z": 1e-4}),
        (f'tool_length = "2 um"\n{_SOURCE}', {"tool_x": 2e-6, "tool_y": 2e-6, "tool_z": 2e-6}),
        ('tool_length = "2 um"\n', {"tool_x": 5e-6, "tool_y": 5e-6, "tool_z": 1e-4}),
        ('tool_length = "30 um"\n', {"tool_x": 5e-6, "tool_y": 5e-6, "tool_z": 3e-5}),
        ('tool_length = "0 um"\n', {}),
        ('tool_length = "0 um"\ntool_eccentricity = "9 um"\n', {"tool_x": 9e-6, "tool_y": 9e-6}),
    ],
)
def test_how_well_the_tool_is_known_is_stated_once_for_all_that_touch(tool: str, stds: Mapping[str, float]) -> None:
    (setup,) = _at_spheres(_TABLE, tool).setups
    assert {u.name: u.std for u in setup.unknowns if "tool" in u.name} == pytest.approx(stds)


def test_a_tool_that_is_stated_without_a_source_is_named_in_one_line_with_what_stays() -> None:
    stated = 'tool_length = "5 um"\ntool_eccentricity = "1 um"\n'
    lines = [each.words for each in _at_spheres(_TABLE, stated).unsourced]
    assert lines == [
        'tool_eccentricity = "1 um" has no source, so 5 um stays. Name one: tool_certificate = "presetter, 2026-03".',
        'tool_length = "5 um" has no source, so 100 um stays. Name one: tool_certificate = "presetter, 2026-03".',
    ]
    assert _at_spheres(_TABLE, stated + _SOURCE).unsourced == ()
    assert _at_spheres(_TABLE, 'tool_length = "0 um"\n').unsourced == ()


@pytest.mark.parametrize(
    ("usual", "stds"), [(True, {"tool_x": 5e-6, "tool_y": 5e-6, "tool_z": 1e-4}), (False, {"tool_z": 5e-6})]
)
def test_records_of_before_keep_the_doubt_of_the_tool_that_they_were_begun_with(
    usual: bool, stds: dict[str, float]
) -> None:
    machine = load_machine("dmu60").text
    described = campaign_from_texts(TWO_SPHERES, "campaign.toml", machine, "dmu60", usual_doubts=usual)
    tool = {each.name: each.std for each in described.setups[0].unknowns if each.name.startswith("tool")}
    assert tool == stds
