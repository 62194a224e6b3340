"""Each figure of a yardstick by its definition, pose after pose, for any directions that count or are zeroed."""

from dataclasses import replace

import numpy as np
import pytest

from axiscal.errors.volume import Counted
from axiscal.estimation.accuracy.yardstick import Yardstick
from axiscal.estimation.case import Case
from axiscal.numerics import Array
from axiscal_core.normal import Normal
from tests.generators.campaigns import on
from tests.generators.texts import machine_text, setup_text

MACHINE = machine_text(
    "w-X'-b-Z-t",
    {"X": (0, 600), "Z": (0, 400)},
    {
        "EXX": 'std = "10 um", knots = 4, length = "150 mm", rest = "2 um"',
        "EXX_reversal": "3 um",
        "EZX": 'std = "6 um", knots = 4, length = "150 mm", rest = "1 um"',
        "EBX": 'std = "20 urad", knots = 4, length = "200 mm"',
    },
    tool=100,
)
LASER = setup_text("laser", "interferometer", direction="x", moves=["X"], approach="both", unknowns={"zero": "1 mm"})
CASE = Case(on(MACHINE, LASER, target={"readings": 12, "aligned": False}, usual="off"))
ALL: Counted = (True, True, True)
WAYS = [
    ((False, False, False), ALL),
    ((True, False, True), ALL),
    ((True, False, False), (True, False, True)),
    ((True, True, True), (False, False, True)),
]


def yardstick_of(zeroed: tuple[bool, bool, bool], counted: Counted) -> Yardstick:
    """Return the yardstick of the axes with other directions, and with something of every error unseen."""
    own, rng = CASE.yardstick, np.random.default_rng(3)
    unseen = 1e-6 * rng.standard_normal((CASE.errors.size, 2))
    return replace(own, volume=replace(own.volume, counted=counted), zeroed=zeroed, unseen=unseen)


def belief() -> Normal:
    rng, count = np.random.default_rng(4), CASE.knowledge.belief.size
    root = 5e-6 * rng.standard_normal((count, count))
    return Normal(np.zeros(count), root @ root.T)


def defined(stick: Yardstick, covariance: Array) -> Array:
    """Return Σ at each pose: what readings could tell, what they cannot without its constant shift, and the rests."""
    errors, mean = CASE.errors, stick.volume.moments.mean
    rows, levers = errors.rows_at(*stick.volume.poses), errors.levers(stick.volume.poses[0])
    zeroed = np.diag([float(each) for each in stick.zeroed]) @ mean
    known, never = covariance[: errors.size, : errors.size], stick.unseen @ stick.unseen.T
    told = (rows - zeroed) @ (known - never) @ (rows - zeroed).transpose(0, 2, 1)
    hidden = (rows - mean) @ never @ (rows - mean).transpose(0, 2, 1)
    rests = np.einsum("t,tmc,tmd->mcd", [term.rest**2 for term in errors.terms], levers, levers)
    return np.asarray(told + hidden + rests)


def traces_of(covariances: Array, counted: Counted) -> Array:
    """Return the variances along the directions that count, added."""
    return np.asarray(np.einsum("pcc,c->p", covariances, np.array(counted, dtype=float)))


@pytest.mark.parametrize(("zeroed", "counted"), WAYS)
def test_covariances_at_the_poses_their_worst_and_their_rms(zeroed: tuple[bool, bool, bool], counted: Counted) -> None:
    """The mean by the poses that are spread evenly, which is within some percent of the closed form."""
    stick, known = yardstick_of(zeroed, counted), belief()
    expected = defined(stick, known.covariance)
    traces, scale = traces_of(expected, counted), float(np.abs(expected).max())
    np.testing.assert_allclose(stick.covariances(known.factor), expected, atol=1e-9 * scale)
    np.testing.assert_allclose(stick.variances(known.factor), traces, atol=1e-9 * scale)
    found = stick.measure(known)
    if counted == ALL:  # the moments of this case are those of all directions
        assert found.rms == pytest.approx(float(np.sqrt(traces[stick.volume.evenly].mean())), rel=0.02)
        assert stick.rms_of(stick.total(known.factor)) == pytest.approx(found.rms, rel=1e-9)
    assert found.worst == pytest.approx(max(float(np.sqrt(traces.max())), found.rms), rel=1e-9)
    at = int(np.argmax(traces))
    poses, sides = (each[[at]] for each in stick.volume.poses)
    rows = CASE.errors.rows_at(poses, sides)[0]
    rows = np.array(counted)[:, None] * (rows - np.array(zeroed)[:, None] * stick.volume.moments.mean)
    np.testing.assert_allclose(stick.worst_root(known), rows, atol=1e-12)


def test_endless_readings_leave_the_floor() -> None:
    stick = replace(yardstick_of((False, False, False), ALL), left=1e-6 * np.eye(CASE.errors.size))
    variances = traces_of(defined(stick, 1e-12 * np.eye(CASE.errors.size)), ALL)
    rms, worst = stick.floors
    assert rms == pytest.approx(float(np.sqrt(variances[stick.volume.evenly].mean())), rel=0.02)
    assert worst == pytest.approx(float(np.sqrt(variances.max())), rel=1e-9)
