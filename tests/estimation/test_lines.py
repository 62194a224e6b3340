"""Along which lines an axis was read, which rows they answer, and what is known of a row: by hand."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.functionals.asked import asked_rows
from axiscal.estimation.functionals.functional import PLACES, line_of, seen_by
from axiscal.measurement.reading import Reading
from tests.generators.campaigns import built_in
from tests.generators.texts import Said, campaign_text, setup_text


def described(*setups: tuple[str, str, str], **target: Said) -> CampaignDescription:
    """Return a campaign on the mill.  setups : name, moves and direction of each that reads a length"""
    texts = [
        setup_text(
            name, "interferometer" if moves.lower() == direction else "straightedge",
            direction=direction, moves=[moves], approach="both",
        )
        for name, moves, direction in setups
    ]  # fmt: skip
    return built_in(campaign_text("three-axis-mill", *texts, target={"readings": 5, **target}))


def at(name: str, *places: tuple[tuple[float, float, float], int]) -> list[Reading]:
    """Return readings of a set-up at poses, reached along X from a side."""
    return [Reading(name, pose, (side, 1, 1), 0.0) for pose, side in places]


def test_a_line_goes_from_end_to_end_of_what_was_read_where_most_of_it_was_read() -> None:
    described_one = described(("laser", "X", "x"))
    (setup,), axes = described_one.setups, described_one.machine
    readings = at(
        "laser", ((0.3, 0.1, 0.2), 1), ((0.1, 0.1, 0.2), -1), ((0.2, 0.1, 0.25), 1), ((0.3, 0.1, 0.2), 1),
        ((0.1, 0.1, 0.2), 1), ((0.4, 0.15, 0.2), -1),
    )  # fmt: skip
    other = at("other", ((0.0, 0.0, 0.0), 1))
    line = line_of(setup, [*other, *readings], axes)
    assert line.setup == "laser"
    assert line.poses.shape == (PLACES, 3)
    np.testing.assert_allclose(line.positions, np.linspace(0.1, 0.4, PLACES))
    assert np.unique(line.poses[:, 1:], axis=0).tolist() == [[0.1, 0.2]]
    assert (line.plus, line.minus, line.both) == ((0.1, 0.2, 0.3), (0.1, 0.4), (0.1,))
    assert line.read == 4
    np.testing.assert_allclose(line.poses_at([0.5, 0.0]), [[0.5, 0.1, 0.2], [0.0, 0.1, 0.2]])
    whole = line_of(setup, readings, axes, whole=True)
    np.testing.assert_allclose(whole.positions[[0, -1]], axes.axes[0].travel)
    assert whole.poses[0, 1:].tolist() == [0.1, 0.2]
    single = line_of(setup, readings[:1], axes)
    np.testing.assert_allclose(single.positions[[0, -1]], axes.axes[0].travel)
    assert single.poses[0, 1:].tolist() == [0.1, 0.2]
    never = line_of(setup, [], axes)
    assert never.poses[0, 1:].tolist() == list(setup.park[1:])
    assert never.read == 0


def test_places_a_micrometre_apart_are_one() -> None:
    found = described(("laser", "X", "x"))
    places = at("laser", *(((x, 0.0, 0.0), 1) for x in (0.1, 0.1 + 9e-7, 0.1 + 3e-6)), ((0.1 - 5e-7, 0.0, 0.0), -1))
    line = line_of(found.setups[0], places, found.machine)
    assert (line.plus, line.both) == ((0.1, 0.1 + 3e-6), (0.1,))


@pytest.mark.parametrize(
    ("changed", "seen"),
    [
        ({}, ("length", 0)),
        ({"direction": (-1.0, 0.0, 0.0)}, ("length", 0)),
        ({"direction": (0.0, 0.9991, math.sqrt(1 - 0.9991**2))}, ("length", 1)),
        ({"direction": (0.0, math.sqrt(1 - 0.998**2), 0.998)}, None),
        ({"moves": (0, 1)}, None),
        ({"moves": ()}, None),
        ({"base": 0.1}, None),
        ({"length": 0.1}, None),
        ({"balls": (0,)}, None),
        ({"station": (0.0, 0.0, 0.0)}, None),
    ],
)
def test_a_line_is_what_one_axis_alone_shows_along_one_direction(
    changed: dict[str, object], seen: tuple[str, int] | None
) -> None:
    mounted = described(("laser", "X", "x"))
    (setup,), mill = mounted.setups, mounted.machine
    changed_one = replace(setup, **changed)  # type: ignore[arg-type]
    assert seen_by(changed_one, mill, np.array(setup.park)) == seen


def names_of(found: CampaignDescription, readings: Sequence[Reading] = (), *, whole: bool = False) -> list[str]:
    return [each.want.row.name for each in asked_rows(found, readings, whole=whole)]


def test_where_an_accuracy_is_asked_for_what_a_plan_left_out_answers_nothing() -> None:
    found = described(("laser", "X", "x"), ("up", "Y", "x"), rms="3 um")
    readings = at("laser", ((0.1, 0.1, 0.1), 1), ((0.3, 0.1, 0.1), 1))
    assert names_of(found, readings) == ["positioning X", "scale X", "backlash X", "volume"]
    assert "straightness Y in X" in names_of(found, readings, whole=True)
    assert "straightness Y in X" in names_of(found)
    assert "straightness Y in X" in names_of(described(("laser", "X", "x"), ("up", "Y", "x")), readings)
