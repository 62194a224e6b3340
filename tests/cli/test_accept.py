"""A mistake in a simulated campaign, through the command: it is named, accepted, gone, and back with `undo`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.estimation import expanded_uncertainty
from axiscal.estimation.inheritance import last_campaign
from axiscal.estimation.promise.agreement import Agreement
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal.present.answer_of_campaign import answer_of
from axiscal.present.result_of_campaign import result_of
from axiscal.record.carried import carried_text
from tests.commands import Command
from tests.generators.texts import campaign_text, machine_text, setup_text

MACHINE = machine_text(
    "w-b-X-Y-t",
    {"X": (0, 500), "Y": (0, 500)},
    {"EXX": 'std = "20 um", length = "150 mm"', "EYY": 'std = "2 um", length = "150 mm"'},
)
CAMPAIGN = campaign_text("m", target={"readings": 99}, usual="off", sure="exactly")
NAMES = {"X": "x", "X again": "x", "Y": "y"}
SETUP = setup_text(
    "{name}", "interferometer", direction="{axis}", moves=["{moves}"], noise="0.5 um", approach="both", drift="0"
)
COUNT = 12
SETUPS = "".join(SETUP.format(name=name, axis=axis, moves=axis.upper()) for name, axis in NAMES.items())
DESCRIBED = campaign_from_texts(CAMPAIGN + SETUPS, "c.toml", MACHINE, "m")


@cache
def right() -> tuple[Reading, ...]:
    """Return readings of three set-ups at uneven places, two of them of the same error."""
    drawn, rng = Simulator(DESCRIBED.machine, DESCRIBED.setups).drawn(3), np.random.default_rng(5)
    found = list[Reading]()
    for number, name in enumerate(NAMES):
        setup = DESCRIBED.setup(name)
        (moving,) = setup.moves
        for x in np.linspace(0.01, 0.48, COUNT) + 4e-3 * np.sin(3.0 * np.arange(COUNT) + number):
            pose = tuple(float(x) if axis == moving else 0.25 for axis in range(2))
            side = tuple(int(axis == moving) for axis in range(2))
            found.append(Reading(name, pose, side, drawn.read_all(setup, pose, side, rng)[0]))
    return tuple(found)


SECOND = np.arange(3)[:, None] == 1
BEHIND = SECOND & (np.arange(COUNT) >= 6)
"""Values by set-up, (3, COUNT), of the second one, and of them those behind the first six."""
Change = Callable[[Array], Array]


def spoilt(change: Change) -> tuple[Reading, ...]:
    """Return the readings after a change of their values by set-up."""
    values = change(np.array([each.value for each in right()]).reshape(3, COUNT)).ravel()
    return tuple(replace(each, value=value) for each, value in zip(right(), values.tolist(), strict=True))


class Wrong(NamedTuple):
    """A mistake: what it makes of values, what it is called, whose it is, and which reading is left out then.

    alone : without the readings of Y, so that what is wrong is more than a fifth of all
    """

    change: Change
    cause: str
    setup: str
    out: int = -1
    alone: bool = False


MISTAKES = {
    "jump": Wrong(lambda values: values + 30e-6 * BEHIND, "jump", "X again", alone=True),
    "um as mm": Wrong(lambda values: np.where(SECOND, 1e-3 * values, values), "unit", "X again"),
    "one late": Wrong(
        lambda values: np.where(SECOND, np.roll(values, -1, axis=1), values), "shifted", "X again", 12, alone=True
    ),
}


def recorded(path: Path, readings: Sequence[Reading]) -> Path:
    with Campaign.create(path, DESCRIBED) as campaign:
        campaign.adopt(tuple(readings))
    return path


def used(wrong: Wrong, readings: Sequence[Reading]) -> list[Reading]:
    return [each for each in readings if each.setup != "Y" or not wrong.alone]


def expanded(path: Path) -> float:
    """Return U over the volume, m."""
    with Campaign.open(path, write=False) as campaign:
        return expanded_uncertainty(campaign.estimate()).space


def known(path: Path) -> tuple[list[tuple[str, float]], Agreement]:
    """Return set-up and value of the readings that everything behind sees, and whether they agree."""
    with Campaign.open(path, write=False) as campaign:
        return [(each.setup, each.value) for each in campaign.state.readings], campaign.estimate().agreement


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_named_accepted_and_taken_back(name: str, tmp_path: Path, command: Command) -> None:
    wrong = MISTAKES[name]
    truth = used(wrong, right())
    u = expanded(recorded(tmp_path / "right.axiscal", truth))
    path = recorded(tmp_path / "mill.axiscal", used(wrong, spoilt(wrong.change)))
    before, found = known(path)
    assert (found.contradicts, found.withheld, found.explained[0].mistake) == (True, False, wrong.cause)
    assert f"axiscal step accept {path} {wrong.cause}" in command("status", path, "--details").printed
    said = command("accept", path, wrong.cause, "--setup", wrong.setup).printed.splitlines()
    assert said[0].startswith("Before: The readings contradict each other")
    count = len(truth) - (wrong.out >= 0)
    assert said[2] == f"Now: {count} of {count} readings agree with the others."
    now, agreement = known(path)
    assert not agreement.contradicts
    step = np.array([30e-6 if wrong.cause == "jump" and i >= 18 else 0.0 for i in range(len(truth))])
    kept = [i for i in range(len(truth)) if i != wrong.out]
    assert [value for _, value in now] == pytest.approx([truth[i].value + step[i] for i in kept], rel=1e-12)
    assert expanded(path) == pytest.approx(u, rel=0.2)
    assert "what was accepted" in command("undo", path).printed
    assert known(path) == (before, found)


def wrong_record(folder: Path, name: str) -> Path:
    """Return a record of readings with a mistake."""
    return recorded(folder / "mill.axiscal", used(MISTAKES[name], spoilt(MISTAKES[name].change)))


def test_status_report_and_an_heir_know_what_was_accepted(tmp_path: Path, command: Command) -> None:
    path = wrong_record(tmp_path, "jump")
    assert run(["accept", str(path), "jump"]) == 0
    said = 'the readings of "X again" before reading 19 have a zero of their own'
    assert f"Accepted: {said}" in command("status", path, "--details").printed
    with Campaign.open(path) as campaign:
        found = result_of(campaign, known := campaign.estimate(ended=True), answer_of(campaign, known, {}))
        description, readings = last_campaign(carried_text(path))
        assert (readings, description.setups[-1].name) == (campaign.state.readings, "X again, before reading 19")
    assert [each.text for each in found.warnings if each.code == "accepted"] == [f"A person accepted: {said}."]
