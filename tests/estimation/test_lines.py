"""Along which lines an axis was read, which rows they answer, and what is known of a row: by hand."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription
from axiscal.description.target import RowName
from axiscal.estimation.functionals.asked import asked_rows
from axiscal.estimation.functionals.functional import PLACES, line_of, seen_by, through_the_volume
from axiscal.estimation.known_rows import KnownRow
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


def test_a_line_through_the_volume_is_in_its_middle_and_rotary_axes_stand_at_nought() -> None:
    volume: dict[str, Said] = {"X": ["10 mm", "50 mm"], "Z": ["150 mm", "250 mm"], "B": ["10 deg", "50 deg"]}
    nest = setup_text("nest", "rtest", station=["150 mm", "0 mm", "100 mm"])
    found = built_in(campaign_text("dmu60", nest, target={"readings": 5, "volume": volume}))
    names = [axis.name for axis in found.machine.axes]
    middle = {name: sum(bounds) / 2 for name, bounds in zip(names, found.target.volume, strict=True)} | {"C": 0.0}
    line = through_the_volume(found, names.index("X"), [])
    for name, column in zip(names, line.poses.T, strict=True):
        expected = np.linspace(0.01, 0.05, PLACES) if name == "X" else np.full(PLACES, middle[name])
        np.testing.assert_allclose(column, expected, atol=1e-12)
    assert middle["B"] == pytest.approx(np.radians(30))
    pose = tuple(0.01 for _ in names)
    line = through_the_volume(found, names.index("C"), [Reading("nest", pose, (1,) * 5, 0.0)])
    assert (line.setup, line.plus, line.minus) == ("", (0.01,), ())


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


def test_rows_are_those_that_set_ups_show_and_two_that_face_each_other_are_square() -> None:
    found = described(("laser", "X", "x"), ("up", "X", "y"), ("back", "Y", "x"), ("aside", "Z", "x"))
    assert names_of(found) == [
        "positioning X",
        "scale X",
        "backlash X",
        "straightness X in Y",
        "straightness Y in X",
        "straightness Z in X",
        "squareness XY",
        "volume",
    ]


def test_of_two_set_ups_that_show_a_row_it_is_of_the_one_with_more_places() -> None:
    found = described(("one", "X", "x"), ("two", "X", "x"))
    few = at("one", ((0.1, 0.1, 0.1), 1), ((0.1, 0.1, 0.1), -1))
    more = at("two", ((0.1, 0.2, 0.1), 1), ((0.2, 0.2, 0.1), 1))
    lines = {each.want.row.name: each.lines for each in asked_rows(found, [*few, *more])}
    assert [line.setup for line in lines["positioning X"]] == ["two"]
    equal = asked_rows(found, [*few, *more[:1]])
    assert equal[0].lines[0].setup == "one"


def test_where_an_accuracy_is_asked_for_what_a_plan_left_out_answers_nothing() -> None:
    found = described(("laser", "X", "x"), ("up", "Y", "x"), rms="3 um")
    readings = at("laser", ((0.1, 0.1, 0.1), 1), ((0.3, 0.1, 0.1), 1))
    assert names_of(found, readings) == ["positioning X", "scale X", "backlash X", "volume"]
    assert "straightness Y in X" in names_of(found, readings, whole=True)
    assert "straightness Y in X" in names_of(found)
    assert "straightness Y in X" in names_of(described(("laser", "X", "x"), ("up", "Y", "x")), readings)


def test_a_wanted_row_without_a_line_of_its_own_takes_that_of_its_axis_unread() -> None:
    found = described(("laser", "X", "x"), wants=["pitch X", "straightness Y in Z"])
    readings = at("laser", ((0.1, 0.1, 0.1), 1), ((0.3, 0.1, 0.1), -1))
    pitch, straight = asked_rows(found, readings)
    assert [(line.setup, line.read) for line in pitch.lines] == [("", 0)]
    np.testing.assert_allclose(pitch.lines[0].positions[[0, -1]], [0.1, 0.3])
    low, high = found.target.volume[1]
    np.testing.assert_allclose(straight.lines[0].positions[[0, -1]], [low, high])


def row(**changed: object) -> KnownRow:
    """Return a row that is known to 4 um, was known to 10, and can be known to 3."""
    stated = {
        "row": RowName("backlash", ("X",)), "angular": False, "known": 4e-6, "before": 10e-6, "floor": 3e-6,
        "limit": None, "measured": True, "lines": (),
    }  # fmt: skip
    return KnownRow(**(stated | changed))  # type: ignore[arg-type]


def test_a_row_is_measured_at_half_of_what_it_was_and_reached_at_its_limit() -> None:
    assert (row().goal, row(limit=4.5e-6).goal, row(limit=6e-6).goal) == (5e-6, 4.5e-6, 5e-6)
    volume = RowName("volume")
    assert row(row=volume).goal == math.inf
    assert row(row=volume, limit=2e-6).goal == 2e-6
    assert [row(floor=floor).reachable for floor in (5e-6, 5.1e-6)] == [True, False]
    assert [row(limit=limit).reached for limit in (None, 4e-6, 3.9e-6)] == [None, True, False]
    assert row(limit=4e-6, measured=False).reached is False
    assert [row(known=known, floor=6e-6).settled for known in (6.59e-6, 6.61e-6)] == [True, False]
    assert [row(known=known).settled for known in (5e-6, 5.1e-6)] == [True, False]
    described_by = ((0.0, None), (2e-12, None), (0.0, 1e-6))
    assert [row(before=before, limit=limit).described for before, limit in described_by] == [False, True, True]
