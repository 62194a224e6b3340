"""What files are said to reach counts what the accuracy counts: over the part, as it is aligned."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.belief import Belief
from axiscal.estimation.estimate import estimated
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.machine_estimate import Estimate
from axiscal.machine import load_machine
from axiscal.machine.kinematics import frames
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal.tables import registry
from axiscal.tables.effect import CommandedMachine, effect_of_control
from axiscal.tables.export_options import ExportOptions
from tests.generators.texts import TWO_SPHERES


@cache
def unread() -> tuple[Estimation, Estimate]:
    """Return a five-axis machine of which nothing was read, for a part on its table."""
    machine = load_machine("dmu60").text
    known = estimated(case_of(campaign_from_texts(TWO_SPHERES, "campaign.toml", machine, "dmu60")), ())
    return known, known.estimate()


def idle(poses: Array, approaches: Array) -> Array:
    """Send the axes where they were told to go."""
    return np.zeros_like(poses)


def test_what_is_not_known_with_the_files_is_what_is_not_known_without_them() -> None:
    known, estimate = unread()
    factor = estimate.belief.factor
    mean = np.random.default_rng(3).normal(size=factor.shape[1])
    moved = replace(estimate, belief=Belief(factor @ mean, factor @ factor.T))
    found = registry.export(moved, "linuxcnc-volumetric", ExportOptions())
    assert found.unknown == pytest.approx(known.accuracy.rms, rel=0.03)
    assert found.effect.after < 0.02 * found.effect.before
    assert found.expected == pytest.approx(known.accuracy.rms, rel=0.03)


def test_a_part_that_is_off_as_a_whole_is_aligned_and_not_in_error() -> None:
    estimate = unread()[1]
    assert estimate.sample is not None
    poses = estimate.sample[:200]
    turn, shift = np.array([2e-5, -1e-5, 3e-5]), np.array([1e-4, 2e-4, -3e-4])

    def whole(at: Array, approaches: Array) -> Array:
        off: Array = shift + np.cross(turn, frames(estimate.machine, at).tcp)
        return off

    as_box, as_part = (
        effect_of_control(estimate.machine, whole, idle, poses, estimate.box, alignment)
        for alignment in (None, estimate.alignment)
    )
    places = frames(estimate.machine, poses).tcp
    turned = np.cross(turn, places - places.mean(axis=0))
    assert as_box.before == pytest.approx(float(np.sqrt(np.mean(np.sum(turned**2, axis=1)))))
    assert max(as_part) < 1e-12


def test_an_instrument_that_knows_commands_sees_where_the_control_sent_the_axes() -> None:
    """The control turns C a little too far and moves X: the tool is where the machine is there, from the command."""
    estimate = unread()[1]
    truth = Simulator(estimate.machine, ()).drawn(2)
    names, rng = [axis.name for axis in estimate.machine.axes], np.random.default_rng(1)
    further = np.array([{"C": 40e-6, "X": 3e-5}.get(name, 0.0) for name in names])
    seen = CommandedMachine.corrected(truth, lambda poses, _: np.tile(further, (len(poses), 1)))
    low, high = np.array([axis.travel for axis in estimate.machine.axes]).T
    poses, ways = rng.uniform(low, high, (7, len(low))), rng.choice([-1.0, 1.0], (7, len(low)))
    there, here = (frames(estimate.machine, each) for each in (poses + further, poses))
    moved = truth.deviation(poses + further, ways) + there.tcp - here.tcp
    np.testing.assert_allclose(seen.deviation(poses, ways), moved, atol=1e-15)
    turn = there.tool @ here.tool.transpose(0, 2, 1)
    turned = 0.5 * np.stack([turn[:, k - 1, k - 2] - turn[:, k - 2, k - 1] for k in range(3)], axis=1)
    assert np.abs(turned).max() > 30e-6
    found = seen.rotation(poses, ways) - truth.rotation(poses + further, ways)
    np.testing.assert_allclose(found, turned, atol=1e-9)
