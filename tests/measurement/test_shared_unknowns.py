"""What a set-up does not know of its ball, bar and tool: one column for one thing, whoever reads it."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.machine.kinematics import Deviation
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal_core.instrument import TOOL
from tests.generators.campaigns import built_in
from tests.generators.kinematics import stem, tip
from tests.generators.texts import setup_text

DMU = load_machine("dmu60")
five_axes = partial(built_in, machine="dmu60")
SPHERES = """
[[artefacts]]
name = "spheres"
balls.low = ["200 mm", "0 mm", "-80 mm"]
balls.high = ["-100 mm", "170 mm", "120 mm"]
balls.third = ["-100 mm", "-170 mm", "20 mm"]
"""
TOUCHED = '[[setups]]\nname = "touched"\ninstrument = "sphere"\nartefact = "spheres"\napproach = "both"\n'
NEST = '[[setups]]\nname = "nest"\ninstrument = "rtest"\nartefact = "spheres"\nball = "low"\n'
BAR = setup_text("bar {0}", "ballbar", length="150 mm", plane="{0}", station=["0 mm", "0 mm", "100 mm"])


def names(observation: Observation, setup: int) -> dict[str, int]:
    columns = observation.unknowns_of(setup)
    own = observation.setups[setup].unknowns
    return {unknown.name: int(column) for unknown, column in zip(own, columns, strict=True)}


def test_set_ups_at_one_ball_share_its_place_and_those_with_one_tool_that_tool() -> None:
    observation = Observation(DMU, five_axes(SPHERES + TOUCHED + NEST).setups)
    touched, nest = names(observation, 0), names(observation, 1)
    assert set(nest) == {"low_x", "low_y", "low_z", *TOOL}
    assert all(touched[name] == column for name, column in nest.items())
    assert observation.size == observation.errors.size + 12
    spread = np.sqrt(np.diagonal(observation.prior_covariance())[observation.errors.size :])
    assert spread == pytest.approx([*[1e-3] * 9, 5e-6, 5e-6, 1e-4])


def test_planes_of_a_bar_about_one_centre_share_it_and_the_bar_s_length() -> None:
    observation = Observation(DMU, five_axes(BAR.format("xy") + BAR.format("zx")).setups)
    assert names(observation, 0) == names(observation, 1)
    assert set(names(observation, 0)) == {"zero", "station_x", "station_y", "station_z", *TOOL}


def test_what_is_calibrated_shares_its_turn_and_scale_and_stands_anew_when_mounted_again() -> None:
    calibrated = (
        SPHERES + 'calibrated = "0.7 um"\n' + TOUCHED + TOUCHED.replace('"touched"', '"again"') + "mounted = 2\n"
    )
    observation = Observation(DMU, five_axes(calibrated).setups)
    first, second = names(observation, 0), names(observation, 1)
    stands = {f"{what}_{axis}" for what in ("place", "turn") for axis in "xyz"}
    assert {name for name in first if first[name] != second[name]} == stands
    assert {"scale", "low_x", "third_z"} <= set(first)


@pytest.mark.parametrize("kept", ["", 'calibrated = "0.7 um"\nscale = "0.5 um/m"\n'])
def test_the_columns_are_what_a_small_change_of_each_unknown_does_to_what_is_shown(kept: str) -> None:
    description = five_axes(SPHERES + kept + TOUCHED + BAR.format("zx"))
    observation, rng = Observation(DMU, description.setups), np.random.default_rng(1)
    for index, setup in enumerate(description.setups):
        assert setup.chart is not None
        low, high = (np.array([each[end] for each in setup.chart.coordinates]) for end in (0, 1))
        poses = setup.chart.poses(
            np.round(rng.uniform(low, high, (6, len(low)))) if len(low) > 3 else rng.uniform(low, high, (6, len(low)))
        )
        rows = observation.numbers(Places.of_setup(index, poses, np.zeros_like(poses))).rows.reshape(
            6, -1, observation.size
        )
        for name, column in names(observation, index).items():
            up, down = (setup.shown(setup.places(poses), {name: sign * 1e-7}) for sign in (1, -1))
            np.testing.assert_allclose(rows[:, :, column], (up - down) / 2e-7, atol=1e-6)


def test_a_ball_that_stands_aside_reads_like_a_machine_that_is_off_the_other_way() -> None:
    (setup,) = five_axes(SPHERES + TOUCHED).setups
    assert setup.chart is not None
    poses = setup.chart.poses(np.array([[0.0, 1.0, 0.3], [1.0, 1.0, 0.3], [2.0, 4.0, 0.0]]))
    kind = setup
    moved: Array = np.array([3e-6, -2e-6, 1e-6])
    own = {
        f"{ball}_{axis}": value for ball in ("low", "high", "third") for axis, value in zip("xyz", moved, strict=True)
    }
    actual = Deviation(np.tile(moved, (3, 1)), np.zeros((3, 3)))
    np.testing.assert_allclose(kind.shown(kind.places(poses, deviation=actual), own), 0.0, atol=1e-15)
    longer = kind.shown(kind.places(poses), {"tool_z": 1e-5})
    np.testing.assert_allclose(longer, [1e-5 * stem(DMU, pose) for pose in poses], atol=1e-12)
    for pose, ball in zip(poses, ("low", "high", "third"), strict=True):
        assert setup.artefact is not None
        place = {each.name: each.place for each in setup.artefact.balls}[ball]
        np.testing.assert_allclose(tip(DMU, pose), place, atol=1e-12)


def test_a_sphere_touched_from_both_sides_does_not_show_the_reversal_of_a_linear_axis() -> None:
    (setup,) = five_axes(SPHERES + TOUCHED).setups
    observation = Observation(DMU, (setup,))
    assert setup.chart is not None
    poses = setup.chart.poses(np.array([[0.0, 1.0, 0.3]]))
    approaches = np.zeros_like(poses)
    approaches[0, :2] = 1.0
    seen = observation.numbers(Places.of_setup(0, poses, approaches))
    variances = observation.variances(seen)
    for function in observation.errors.curves:
        if function.kind == "reversal" and not DMU.axes[function.axis].rotary:
            assert np.all(seen.rows[:, function.columns] == 0)
    rests = sum(f.rest**2 for f in observation.errors.curves) * 3
    assert np.all((setup.noise**2 <= variances) & (variances <= setup.noise**2 + rests))


def test_a_bar_is_looked_at_again_about_where_its_ball_is_found_and_what_touches_is_not() -> None:
    cup = '[[artefacts]]\nname = "cup"\nballs = { centre = ["0 mm", "0 mm", "100 mm"] }\n'
    bar = BAR.format("xy").replace('station = ["0 mm", "0 mm", "100 mm"]', 'artefact = "cup"')
    for text, found in ((cup + bar, (1e-3, 0.0, 0.0)), (SPHERES + 'calibrated = "1 um"\n' + TOUCHED, None)):
        case = Case(five_axes(text))
        mean = np.zeros(case.observation.size)
        columns = names(case.observation, 0)
        mean[columns["centre_x" if found else "turn_x"]] = 1e-3
        located = case.located(mean)
        assert (None if located is None else located.description.setups[0].found) == found
