"""The method of the core against the paper, brute force and its own definitions."""

from typing import Any

import numpy as np
import pandas as pd
import pytest

import axiscal_core as ac
from axiscal_core.draws import as_stated
from axiscal_core.posing import posed
from axiscal_core.rigid import turned_about
from axiscal_core.unknowns import space_of
from tests.core.strangers import Warm, mill

TOGETHER = 0.0831806
"""J of the paper's seven readings chosen together; the product's own plan of them has it as well."""


def _paper() -> ac.Case:
    """Figure 4: ten units, seven control points of variance one, readings of variance 0.01, no zero."""
    machine = ac.Machine([ac.Axis.linear("X", "x", (0, 10))], [ac.Error("EXX", 1.0)])
    dial = ac.Laser("dial", "X", noise=0.1, unknowns={"zero": 0.0}, approach="+")
    return ac.Case(machine, [dial], usual="off", sure="exactly")


def test_readings_chosen_together_beat_those_one_after_another() -> None:
    plan = _paper().plan(readings=7, criterion="joint")
    assert pytest.approx(TOGETHER, rel=1e-5) == plan.J
    assert plan.course[-1] == pytest.approx(plan.J)
    assert np.all(np.diff(plan.course) < 0)


def test_a_callable_criterion_plans_what_its_matrix_plans() -> None:
    case = _paper()
    root = np.eye(case.size)[[2, 3]]
    by_matrix = case.plan(3, criterion=root, candidates=60)
    by_function = case.plan(3, criterion=lambda c: float(np.sum(np.diag(c)[[2, 3]])), candidates=60)
    assert pytest.approx(by_matrix.J, rel=1e-9, abs=0) == by_function.J


@pytest.mark.parametrize("index", ["O1", "O2", "O3", "O4", "O5"])
def test_indices_of_observability_are_those_of_the_jacobian(index: str) -> None:
    """By the singular values of the rows themselves, in the ways that even places everywhere see."""
    case = mill(usual="off", sure="exactly")
    places = case.lattice(90)

    def jacobian(at: ac.Places) -> ac.Array:
        n, prior = case.numbers(at), case.prior.covariance
        scale = np.sqrt(np.diagonal(prior))
        values, vectors = np.linalg.eigh(prior / np.outer(scale, scale))
        return np.asarray(n.rows @ (scale[:, None] * vectors * np.sqrt(values.clip(0))) / n.noise[:, None])

    _, all_seen, ways = np.linalg.svd(jacobian(case.lattice(800)))
    s = np.linalg.svd(jacobian(places) @ ways[: len(all_seen)][all_seen > 1e-4 * all_seen[0]].T, compute_uv=False)
    wanted = {
        "O1": float(np.prod(s) ** (1 / len(s))), "O2": s[-1] / s[0], "O3": s[-1], "O4": s[-1] ** 2 / s[0],
        "O5": 1 / np.sum(1 / s),
    }  # fmt: skip
    found: Any = index
    assert pytest.approx(wanted[index], rel=1e-3) == -case.evaluate(places, criterion=found).J


def test_kept_places_stay_and_own_candidates_are_not_left() -> None:
    case = mill()
    kept = ac.Places("x", [[0.123, 0.2]], [[1, 0]])
    own = ac.Places(["x", "y", "c"] * 4, np.linspace([0.0, 0.0], [0.4, 0.4], 12), np.ones((12, 2)))
    plan = case.plan(4, candidates=own, keep=kept)
    allowed = {(name, *pose) for name, pose in zip(own.instruments, own.poses.tolist(), strict=True)}
    found = {(name, *pose) for name, pose in zip(plan.places.instruments, plan.places.poses.tolist(), strict=True)}
    assert ("x", 0.123, 0.2) in found
    assert found - {("x", 0.123, 0.2)} <= allowed


def test_minutes_are_kept_and_more_of_them_leave_less() -> None:
    mounted = [ac.Laser("dial", "X", noise="9 um", setup_time="1 min"), ac.Laser("laser", "X", setup_time="6 min")]
    limits, case = np.array([2, 4, 6.5, 8]), ac.Case(mill().stated, mounted)
    plans = [case.plan(minutes=each if each < 5 else f"{60 * each} s", candidates=60) for each in limits.tolist()]
    assert np.abs(np.array([plan.minutes for plan in plans]) - limits).max() < 1e-9
    assert np.all(np.diff([plan.J for plan in plans]) < 0)


def test_an_rms_is_reached_with_as_few_readings_as_do() -> None:
    case = mill()
    few = case.plan(readings=5, candidates=90)
    found = case.plan(rms=1.02 * few.rms, candidates=90)
    assert found.rms <= 1.02 * few.rms
    assert len(found) <= 5


def _told(case: ac.Case, places: ac.Places, seed: int = 3) -> tuple[ac.Readings, ac.Array]:
    truth = case.prior.sample(1, seed)[0]
    return ac.Readings.simulated(case, places, seed, truth), truth


def test_where_sizes_are_exact_an_estimate_is_one_normal_update() -> None:
    """eq. 31-33, all at once, and one reading after another: the order does not matter (end of section IV)."""
    case = _paper()
    readings, _ = _told(case, ac.Places("dial", [[1.0], [3.5], [8.0]], [[1]] * 3))
    known, prior = case.estimate(readings), ac.Known.of(case, case.prior.mean, case.prior.covariance)
    steps = prior
    for i in (2, 0, 1):
        steps = steps.read(ac.Readings(readings.places.at([i]), readings.values[[i]]))
    for each in (prior.read(readings), steps):
        assert np.abs(known.mean - each.mean).max() < 1e-9
        assert np.abs(known.covariance - each.covariance).max() < 1e-9


def test_a_station_250_mm_off_is_found() -> None:
    """Rows are taken where the station is: at the place that is stated they would mislead."""
    axes = [ac.Axis.linear(name, name.lower(), (0, "400 mm")) for name in "XYZ"]
    machine = ac.Machine(axes, [ac.Error(f"E{name}{name}", "5 um", length="200 mm") for name in "XYZ"])
    own: dict[str, float | str] = {
        "zero": "1 mm",
        **{f"station_{a}": "0.3 m" for a in "xyz"},
        **{f"tool_{a}": 0.0 for a in "xyz"},
    }
    tracer = ac.BallBar("tracer", "XYZ", station=(1.2, 0.3, 0.1), noise="0.3 um", unknowns=own)
    case = ac.Case(machine, [tracer], usual="off", sure="exactly")
    truth = case.prior.sample(1, 4)[0]
    station = [case.names.index(f"tracer.station_{a}") for a in "xyz"]
    truth[station] = 0.2, -0.25, 0.18
    known = case.estimate(ac.Readings.simulated(case, case.lattice(60), 1, truth))
    assert np.abs(known.mean - truth)[station].max() < 5 * known.normal.std[station].max() < 2e-4


def test_causes_of_type_b_move_no_mean_and_widen_every_figure() -> None:
    """Schmidt's consider form: Var[F u] = F C Fᵀ + Σ (F G b − f)², which a person redoes by hand."""
    places = ac.Places("laser", [[t, 0.2] for t in (0.0, 0.1, 0.2, 0.3, 0.4)], [[1, 0]] * 5)
    machine = mill().stated
    cases = [ac.Case(machine, [kind("laser", "X")], usual="off", sure="exactly") for kind in (ac.Laser, Warm)]
    readings, _ = _told(cases[0], places)
    plain, warm = (case.estimate(readings) for case in cases)
    assert np.abs(plain.mean - warm.mean).max() < 1e-15
    moved = as_stated(space_of(posed(cases[1], readings))).type_b.gains
    assert np.abs(warm.covariance - (plain.covariance + moved @ moved.T)).max() < 1e-18
    assert pytest.approx(warm.U, rel=1e-6) == cases[1].evaluate(places).U
    figure = np.zeros(cases[1].size)
    figure[[0, 4]] = -1.0, 1.0
    budget = warm.budget(figure)
    assert sum(line**2 for line in budget.values()) == pytest.approx(
        figure @ warm.covariance @ figure, rel=1e-6, abs=0.0
    )
    assert budget["laser.warmer"] == pytest.approx(abs(figure @ moved[:, 0]))
    # where the answer is as read the cause moves the figure as it moves the mean
    assert warm.budget(figure, figure @ moved)["laser.warmer"] == pytest.approx(0.0, abs=1e-12)


def test_a_robot_moves_as_its_parameters_say() -> None:
    """Its errors are the derivatives of the product of the matrices by each parameter."""
    links = np.array([[0.1, 1.5, 0.4, 0.1], [0.7, 0.1, 0.05, 1.5], [0.1, 1.5, 0.0, 0.2]])
    tool, poses = np.array([0.05, 0.02, 0.15]), np.array([[0.3, -0.4, 0.5], [-1.0, 0.7, 2.0]])
    robot = ac.Machine.from_dh(links.tolist(), dict.fromkeys(("a", "alpha", "d", "theta"), 1e-3), tool=tool.tolist())

    def tcp(table: ac.Array, pose: ac.Array) -> ac.Array:
        turn, at = np.eye(3), np.zeros(3)
        for (a, alpha, d, theta), q in zip(table, pose, strict=True):
            at = at + turn @ [0, 0, d]
            turn = turn @ turned_about(np.array([0.0, 0, 1]), np.array([theta + q]))[0]
            at = at + turn @ [a, 0, 0]
            turn = turn @ turned_about(np.array([1.0, 0, 0]), np.array([alpha]))[0]
        return np.asarray(at + turn @ tool)

    assert np.abs(robot.frames(poses).tcp - [tcp(links, pose) for pose in poses]).max() < 1e-14
    rows = robot.rows(poses).displacement
    for i, error in enumerate(robot.errors):
        link, which = int(error.name[-1]) - 1, ("a", "alpha", "d", "theta").index(error.name[:-1])
        step = np.zeros_like(links)
        step[link, which] = 1e-6
        slopes = [(tcp(links + step, pose) - tcp(links - step, pose)) / 2e-6 for pose in poses]
        assert np.abs(rows[:, :, i] - slopes).max() < 1e-8


class Bend:
    """A bed that sags by the square of where the carriage stands: somebody's own error."""

    name, frame = "sag", "X"

    def rows(self, poses: ac.Array) -> ac.Array:
        result = np.zeros((len(poses), 6, 1))
        result[:, 2, 0] = poses[:, 0] ** 2
        return result

    def covariance(self) -> ac.Array:
        return np.array([[1e-8]])


def test_an_error_of_ones_own_is_planned_and_estimated() -> None:
    machine = ac.Machine([ac.Axis.linear("X", "x", (0, 1.0))], [Bend(), ac.Error("EXX", "5 um")])
    case = ac.Case(machine, [ac.Laser("dial", "X", along="z", noise="1 um")])
    readings, truth = _told(case, case.plan(readings=5, candidates=50).places)
    known = case.estimate(readings)
    sag = known.names.index("sag[0]")
    assert abs(known.mean[sag] - truth[sag]) < 4 * known.normal.std[sag] < 2e-5
    assert known.deviation([[1.0]]).mean[0, 2] == pytest.approx(known.mean[sag])


def test_samples_and_deviations_are_those_of_the_covariance() -> None:
    case = mill()
    readings, _ = _told(case, case.plan(readings=8).places)
    known = case.estimate(readings)
    drawn = known.sample(4000, seed=1)
    assert np.abs(drawn.std(axis=0) / known.normal.std - 1).max() < 0.06
    poses = [[0.1, 0.1], [0.11, 0.1], [0.3, 0.2]]
    each, joint = known.deviation(poses), known.deviation(poses, joint=True)
    assert np.abs(joint.mean.reshape(3, 3) - each.mean).max() < 1e-18
    blocks = joint.covariance.reshape(3, 3, 3, 3)[range(3), :, range(3)]
    assert np.abs(blocks - each.covariance).max() < 1e-18
    curve = known["EXX"]([0.1, 0.3])
    assert np.abs(curve.mean - known.deviation([[0.1, 0.0], [0.3, 0.0]]).mean[:, 0]).max() < 3e-5
    assert case.evaluate(readings).rms > 0 < known.rms < known.U


def test_tables_go_to_pandas_and_back() -> None:
    case = mill()
    readings, _ = _told(case, case.plan(readings=6).places)
    frame = pd.DataFrame(case.table(readings))
    again = case.readings(frame)
    assert np.array_equal(again.values, readings.values)
    assert np.array_equal(again.places.sides, readings.places.sides)
    assert np.array_equal(case.estimate(frame).mean, case.estimate(readings).mean)
    assert [*pd.DataFrame(case.estimate(readings).table())["name"]] == [*case.names]


def test_a_rigid_motion_of_the_volume_is_no_error_where_it_is_aligned() -> None:
    """A squareness alone of two axes is a rotation only in part; both straightness constants are nothing."""
    axes = [ac.Axis.linear(name, name.lower(), (0, 1.0)) for name in "XY"]
    machine = ac.Machine(axes, [ac.Error("EXX", 1.0, knots=1), ac.Error("C0Y", 1.0)])
    laser = ac.Laser("x", "X")
    shift, square = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    for aligned, wanted in ((False, (1.0, 1 / 3)), (True, (0.0, 1 / 24))):
        case = ac.Case(machine, [laser], usual="off", aligned=aligned)
        found = [float(np.sum((case.volume.root @ each) ** 2)) for each in (shift, square)]
        assert found == pytest.approx(wanted, abs=2e-3)
