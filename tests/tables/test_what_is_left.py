"""What tables leave, over the part as it is aligned, and are added to: planes, old points, turns, reversals."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.errors.volume import whole_travel
from axiscal.estimation.estimate import estimated
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.machine_estimate import Estimate, LeftUnknown
from axiscal.machine import load_machine, machine_from_text
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal.ports.linuxcnc.volumetric_tables import LinuxcncVolumetric
from axiscal.tables import registry
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import Loaded
from axiscal.tables.offer import effect_sentence, foreword
from axiscal.tables.round_trip import drawn_and_known
from axiscal.tables.surface import CommandedMachine, Effect, effect_of_control, planes_left
from axiscal.tables.table import CompensationTable
from axiscal.tables.vcomp_file import whole_control
from axiscal_core.normal import Normal
from tests.evaluation.said import idle
from tests.generators.known import sure
from tests.generators.planes import BED
from tests.generators.texts import TWO_SPHERES
from tests.tables.test_controllers import known
from tests.tables.test_sampling import CHAINS, machine

ONE_PLANE = BED.replace("EAYZ", "#").replace('EAX = { std = "100 urad", knots = 4, length = "100 mm" }', "")


def plane_of(estimate: Estimate, poses: Array) -> Array:
    """Return what its error of two axes does along z, (m,) m: the whole deviation less that of all the others."""
    without = estimate.mean.copy()
    for plane in estimate.model.planes:
        without[plane.columns] = 0.0
    others = replace(estimate, belief=sure(without))
    sides = np.zeros_like(poses)
    return (estimate.deviation(poses, sides) - others.deviation(poses, sides))[:, 2]


@pytest.mark.parametrize(
    ("share", "says", "part"),
    [(1.0, False, False), (0.92, False, False), (0.88, True, True), (0.12, True, True), (0.08, True, False)],
)
def test_what_files_leave_of_two_axes_is_said_below_nine_tenths_and_part_of_it_above_a_tenth(
    share: float, says: bool, part: bool
) -> None:
    estimate = drawn_and_known(machine_from_text(ONE_PLANE))
    axes = estimate.machine.axes
    index = estimate.machine.index("Z")
    low, high = np.array(estimate.box).T
    poses = np.random.default_rng(2).uniform(low, high, (800, len(axes)))

    def control(at: Array, sides: Array) -> Array:
        """Take the whole deviation along z away, but of what two axes do a share only."""
        added = np.zeros_like(at)
        whole = estimate.deviation(at, np.zeros_like(at))[:, 2]
        added[:, index] = -whole + (1 - share) * plane_of(estimate, at)
        return added

    words = planes_left(estimate, control, poses, np.zeros_like(poses))
    assert bool(words) == says
    assert ("Part of it is held" in words) == part
    if says:
        size = np.std(plane_of(estimate, poses)) * 1e6
        assert f"(EZXY: {size:.3g} um RMS over the volume)" in words


def old_table(count: int, low: float = 0.0, high: float = 0.4, size: float = 3e-6) -> CompensationTable:
    """Return an old table of Y over itself: what it adds is a parabola."""
    at = np.linspace(low, high, count)
    return CompensationTable("Y", at, -size * at**2, -size * at**2)


def new_table(count: int) -> CompensationTable:
    """Return a new one that takes a line away."""
    at = np.linspace(0.0, 0.4, count)
    return CompensationTable("Y", at, 5e-6 * at, 5e-6 * at, np.full(count, 1e-6), "Y")


@pytest.mark.parametrize(
    ("old", "new", "most", "even", "points"),
    [
        (9, 5, 9, True, 9),
        (9, 5, 8, True, 5),
        (9, 5, 100, True, 9),
        (5, 9, 100, True, 9),
        (4, 5, 7, False, 7),
        (4, 5, 6, False, 5),
        (9, 5, 100, False, 9),
    ],
    ids=["just fits", "does not", "finer", "coarser", "all of both just fit", "all do not", "one holds the other"],
)
def test_points_of_a_sum_are_those_of_both_as_far_as_they_fit(
    old: int, new: int, most: int, even: bool, points: int
) -> None:
    before, table = old_table(old), new_table(new)
    (found,) = Loaded((before,)).under_tables([table], machine(CHAINS[0]), most, even=even)
    assert len(found.positions) == points
    assert np.all(np.diff(found.positions) > 1e-9)
    own = np.interp(found.positions, table.positions, table.forward)
    added = np.interp(found.positions, before.positions, 3e-6 * before.positions**2)
    assert found.forward == pytest.approx(own - added, abs=1e-15)
    assert found.reverse == pytest.approx(own - added, abs=1e-15)


def test_a_reversal_takes_a_fifth_of_the_acceleration_of_each_joint_within_5_ms_and_5_s() -> None:
    """T = √(4 J/(0.2 a)): J the largest step of a joint between both sides of an axis, all over the volume."""
    estimate = known("dmu60")[0]
    rng, axes = np.random.default_rng(1), estimate.machine.axes
    low, high = np.array(estimate.box).T
    poses = rng.uniform(low, high, (500, len(axes)))
    control, steps = whole_control(estimate.model, estimate.mean), []
    for k in range(len(axes)):
        way = np.zeros_like(poses)
        way[:, k] = 1.0
        steps.append(np.max(np.abs(control(poses, way) - control(poses, -way)), axis=0))
    for factor in (1.0, 1e6, 1e-8):
        accelerations = [factor * axis.acceleration for axis in axes]
        scaled = tuple(replace(axis, acceleration=each) for axis, each in zip(axes, accelerations, strict=True))
        model = replace(estimate.machine, axes=scaled)
        found = LinuxcncVolumetric().seconds(replace(estimate, model=model))
        worst = [max(np.sqrt(4 * j / (0.2 * a)) for j, a in zip(step, accelerations, strict=True)) for step in steps]
        assert found == pytest.approx(np.clip(worst, 0.005, 5.0).tolist(), rel=0.1)
        assert max(found) <= 5.0
        assert min(found) >= 0.005
        assert factor < 1e6 or found == [0.005] * len(axes)
    assert 5.0 in found


def test_what_files_move_is_the_mean_of_both_directions() -> None:
    """Axes count as the tool moves relative to the workpiece, whichever of the two they carry."""
    carrying = machine("w-X'-b-Y-Z-t")
    x, y = carrying.index("X"), carrying.index("Y")

    def control(at: Array, sides: Array) -> Array:
        added = np.zeros_like(at)
        added[:, x], added[:, y] = 10e-6 + 4e-6 * sides[:, x], 3e-6 * at[:, y]
        return added

    model = carrying
    estimate = Estimate(model, Normal(np.zeros(model.size), np.eye(model.size)), whole_travel(model))
    (sentence,) = foreword(estimate, control)
    assert "at machine zero, X 0 mm Y 0 mm Z 0 mm by x +10.0, y +0.0, z +0.0 um;" in sentence
    assert "X 200 mm Y 200 mm Z -150 mm by x +10.0, y +0.6, z +0.0 um (both" in sentence


@cache
def unread() -> tuple[Estimation, Estimate]:
    """Return a five-axis machine of which nothing was read, for a part on its table."""
    machine = load_machine("dmu60").text
    known = estimated(case_of(campaign_from_texts(TWO_SPHERES, "campaign.toml", machine, "dmu60")), ())
    return known, known.estimate()


def test_what_is_not_known_with_the_files_is_what_is_not_known_without_them() -> None:
    known, estimate = unread()
    factor = estimate.belief.factor
    mean = np.random.default_rng(3).normal(size=factor.shape[1])
    moved = replace(estimate, belief=Normal(factor @ mean, factor @ factor.T))
    found = registry.export(moved, "linuxcnc-volumetric", ExportOptions())
    assert found.known.rms == pytest.approx(known.accuracy.rms, rel=0.03)
    assert found.effect.after < 0.02 * found.effect.before
    assert found.expected == pytest.approx(known.accuracy.rms, rel=0.03)


def test_a_part_that_is_off_as_a_whole_is_aligned_and_not_in_error() -> None:
    estimate = unread()[1]
    assert estimate.sample is not None
    poses = estimate.sample[:200]
    turn, shift = np.array([2e-5, -1e-5, 3e-5]), np.array([1e-4, 2e-4, -3e-4])

    def whole(at: Array, approaches: Array) -> Array:
        return shift + np.cross(turn, estimate.machine.frames(at).tcp)

    as_box, as_part = (
        effect_of_control(estimate.machine, whole, idle, poses, estimate.box, alignment)
        for alignment in (None, estimate.alignment)
    )
    places = estimate.machine.frames(poses).tcp
    turned = np.cross(turn, places - places.mean(axis=0))
    assert as_box.before == pytest.approx(float(np.sqrt(np.mean(np.sum(turned**2, axis=1)))))
    assert max(as_part) < 1e-12


def test_an_instrument_that_knows_commands_sees_where_the_control_sent_the_axes() -> None:
    """The control turns C a little too far and moves X: the tool is where the machine is there, from the command."""
    estimate = unread()[1]
    truth = Simulator(estimate.machine, ()).drawn(2)
    names, rng = [axis.name for axis in estimate.machine.axes], np.random.default_rng(1)
    further = np.array([{"C": 40e-6, "X": 3e-5}.get(name, 0.0) for name in names])
    seen = CommandedMachine.behind(truth, lambda poses, _: np.tile(further, (len(poses), 1)))
    low, high = np.array([axis.travel for axis in estimate.machine.axes]).T
    poses, ways = rng.uniform(low, high, (7, len(low))), rng.choice([-1.0, 1.0], (7, len(low)))
    there, here = (estimate.machine.frames(each) for each in (poses + further, poses))
    moved = truth.deviation(poses + further, ways) + there.tcp - here.tcp
    np.testing.assert_allclose(seen.deviation(poses, ways), moved, atol=1e-15)
    turn = there.tool @ here.tool.transpose(0, 2, 1)
    turned = 0.5 * np.stack([turn[:, k - 1, k - 2] - turn[:, k - 2, k - 1] for k in range(3)], axis=1)
    assert np.abs(turned).max() > 30e-6
    found = seen.does(poses, ways).rotation - truth.does(poses + further, ways).rotation
    np.testing.assert_allclose(found, turned, atol=1e-9)


def test_readme_says_u_in_the_digits_of_the_row_beside_its_limit() -> None:
    text = effect_sentence("They", Effect(27.7e-6, 12e-6), LeftUnknown(28.6e-6, 49.469e-6, 50e-6))
    assert "from 40 um RMS to 31 um. U of the estimate is 49.5 um; with what the files leave, 95 %" in text
