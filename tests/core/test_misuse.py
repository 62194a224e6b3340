"""Every misuse is an `InputError` that names function and argument and, where there is one, the pose."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import axiscal_core as ac

anything: Any = ac
"""The package as a language without types sees it."""


def _machine() -> ac.Machine:
    return ac.Machine([ac.Axis.linear("X", "x", (0, "600 mm"))], [ac.Error("EXX", "10 um", length="200 mm")])


def _case() -> ac.Case:
    return ac.Case(_machine(), [ac.Laser("laser", "X")])


def _places(*at: float) -> ac.Places:
    return ac.Places("laser", [[t] for t in at])


def _seeing(name: str, shown: Callable[[ac.At, ac.Unknowns], list[ac.Array]], **own: object) -> ac.Instrument:
    """Return an instrument of a class of somebody's own.  shown : what it sees; own : what else the class says"""
    kind: Any = type(name, (ac.Instrument,), {"sees": lambda _, at, u: shown(at, u), **own})
    made: ac.Instrument = kind("one", "X")
    return made


def _hole(at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
    return [at.moved[:, 0] + np.where(at.poses[:, 0] > 0.3, np.nan, 0.0)]


def _clipped(at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
    return [np.maximum(at.moved[:, 0], 0.0)]


def _read(values: Any, **how: Any) -> ac.Readings:
    return ac.Readings(_places(0.1, 0.2), values, **how)


def _undeclared(at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
    return [at.moved[:, 0] + u["zero"]]


BELOW, UNIT = np.array([[1.0, 2.0], [2.0, 1.0]]), np.eye(2)
"""What is no covariance, and one that is."""


def _unit() -> ac.Normal:
    return ac.Normal(np.zeros(2), UNIT)


def _bend(rows: int, covariance: ac.Array) -> Any:
    """Return an error of somebody's own, of two unknowns.  rows : numbers at each pose"""
    own = {"rows": lambda _, poses: np.zeros((len(poses), rows, 2)), "covariance": lambda _: covariance}
    return type("Bend", (), {"name": "bend", "frame": "X", **own})()


def _with(error: Any) -> ac.Machine:
    return ac.Machine([ac.Axis.linear("X", "x", (0, 1))], [error])


def _mounted(instrument: Any) -> ac.Case:
    return ac.Case(_machine(), [instrument])


def _known() -> ac.Known:
    case = _case()
    return ac.Known.of(case, np.zeros(case.size), np.eye(case.size))


def _spun() -> ac.Case:
    """A table whose angle is off, and a laser along x at a tool point on its axis."""
    axes = [ac.Axis.turning("C", "z", ("-90 deg", "90 deg"))]
    return ac.Case(ac.Machine(axes, [ac.Error("ECC", "20 urad")]), [ac.Laser("laser", "C", along="x")], aligned=False)


def _one_value() -> ac.Readings:
    return ac.Readings(_places(0.1, 0.2), [0.0])


def _two() -> ac.Machine:
    return ac.Machine([*_machine().axes, ac.Axis.linear("Y", "y", (0, "400 mm"))], [ac.Error("EXX", "10 um")])


def _moved(at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
    return [at.moved[:, 0]]


def _of_a_bend() -> ac.Known:
    case = ac.Case(_with(_bend(6, UNIT)), [_seeing("Seen", _moved)], usual="off")
    return case.known(np.zeros(case.size), np.eye(case.size))


_WITHOUT: dict[str, list[object]] = {"instrument": ["laser"], "X": [0.1]}
_TABLE: dict[str, list[object]] = {**_WITHOUT, "length": [0.0]}
MISUSES: dict[str, tuple[Callable[[], object], str, str]] = {
    "noise below zero": (lambda: ac.Laser("laser", "X", noise=-1e-6), "Laser", "noise"),
    "noise of 1e300": (lambda: ac.Laser("laser", "X", noise=1e300), "Laser", "noise"),
    "an angle for a zero": (lambda: ac.Laser("laser", "X", unknowns={"zero": "1 rad"}), "Laser", "zero"),
    "an unknown that is a number": (lambda: anything.Laser("laser", "X", unknowns={1: 1e-3}), "Laser", "names"),
    "values that are hidden": (lambda: _read(np.ma.masked_equal([1e-6, 0.0], 0.0)), "Readings", "values"),
    "values that are dates": (lambda: _read(np.zeros(2, "datetime64[ns]")), "Readings", "values"),
    "a clipped number": (lambda: _mounted(_seeing("Clip", _clipped)), "Clip.sees", "result"),
    "noise of two numbers": (lambda: ac.Laser("laser", "X", noise=[1e-6, 1e-6]), "Laser", "noise"),
    "std below zero": (lambda: ac.Error("EXX", -1e-6), "Error", "std"),
    "an angle as a length": (lambda: ac.Error("EXX", "10 urad"), "Error", "std"),
    "how sure nobody is": (lambda: anything.Error("EXX", 1e-6, sure="very"), "Error", "sure"),
    "a length of waves": (lambda: ac.Error("EXX", 1e-6, period=0.01, length=0.2), "Error", "length"),
    "axes that are names": (lambda: anything.Machine(["X"], [ac.Error("EXX", 1e-6)]), "Machine", "axes"),
    "a tool of no length": (lambda: ac.Machine(_machine().axes, [_bend(6, UNIT)], tool=np.nan), "Machine", "tool"),
    "no errors at all": (lambda: anything.Machine(_machine().axes, None), "Machine", "errors"),
    "a tool held by no turn": (lambda: anything.Machine(_machine().axes, [_bend(6, UNIT)], held=3), "Machine", "held"),
    "a class for an error": (lambda: _with(type(_bend(6, UNIT))), "Machine", "errors"),
    "rows that cannot be computed": (lambda: _with(_bend(-1, UNIT)), "bend", "rows(poses)"),
    "a blind instrument": (lambda: _mounted(_seeing("Blind", lambda at, u: [at.tcp[:, 0]])), "Blind.sees", "result"),
    "more readings that are a number": (lambda: anything.Known.read(_known(), 3), "Known.read", "readings"),
    "a tool that no error moves": (lambda: _spun().plan(3), "Case.plan", "criterion"),
    "an axis named twice": (lambda: ac.Laser("laser", "XX"), "Laser", "moves"),
    "a list of unknowns": (lambda: anything.Laser("laser", "X", unknowns=["zero"]), "Laser", "unknowns"),
    "a number named twice": (lambda: _seeing("Twin", _undeclared, names=("a", "a"), units=("m", "m")), "Twin", "names"),
    "a criterion that fails": (lambda: _case().plan(2, criterion=lambda c: 1 / 0), "criterion", "result"),
    "a criterion of arrays": (lambda: _case().plan(2, criterion=lambda c: anything.Array), "criterion", "result"),
    "what is known of another case": (lambda: _mounted(ac.Level("a", "X")).next(after=_known()), "Case.next", "after"),
    "a table with a short column": (lambda: _case().estimate({**_WITHOUT, "length": []}), "Case.readings", "length"),
    "values of other rows": (lambda: ac.Normal(np.zeros(2), UNIT).read([[1, 0]], [1, 2], [1]), "Normal.read", "values"),
    "a normal of another size": (lambda: ac.Normal(np.zeros(3), UNIT), "Normal", "covariance"),
    "one small variance below zero": (lambda: ac.Normal(np.zeros(2), np.diag([1, -1e-14])), "Normal", "covariance"),
    "one indefinite of many": (lambda: ac.Normal(np.zeros((2, 2)), np.array([UNIT, BELOW])), "Normal", "covariance"),
    "a normal of one number": (lambda: anything.Normal(0.0, 1.0), "Normal", "mean"),
    "a reading of negative variance": (lambda: _unit().read([[1, 0]], [1], [-1e-12]), "Normal.read", "covariance"),
    "a criterion that rises": (lambda: _case().plan(2, criterion=lambda c: -np.trace(c)), "Case.plan", "criterion"),
    "a criterion of nought": (lambda: _case().plan(2, criterion=np.zeros((1, _case().size))), "Case.plan", "criterion"),
    "a billion readings": (lambda: _case().plan(10**9), "Case.plan", "readings"),
    "kept places of two axes": (lambda: _case().plan(2, keep=ac.Places("laser", [[0.1, 0.2]])), "Case.plan", "poses"),
    "a value that is an angle": (lambda: _case().estimate(_read(["1 rad", 0])), "Case.estimate", "values"),
    "noise of some readings alone": (lambda: _read([0, 0], std=[1, 1]) + _read([0, 0]), "Readings", "std"),
    "joint of a word": (lambda: anything.Known.deviation(_known(), [[0.1]], joint="yes"), "Known.deviation", "joint"),
    "shown by NaN": (lambda: _case().shows(_places(0.1), np.full(_case().size, np.nan)), "Case.shows", "x"),
    "places that are not there": (lambda: _places(0.1).at([7]), "Places.at", "which"),
    "a billion knots": (lambda: ac.Curve((0, 1), 1e-6, knots=10**9), "Curve", "knots"),
    "length of zero": (lambda: ac.Error("EXX", 1e-6, length=0.0), "Error", "length"),
    "no error's name": (lambda: ac.Error("straightness", 1e-6), "Error", "name"),
    "error of another axis": (lambda: _with(ac.Error("EXY", 1e-6)), "Machine", "errors"),
    "an error twice": (lambda: ac.Machine(_machine().axes, [ac.Error("EXX", 1e-6)] * 2), "Machine", "errors"),
    "no errors": (lambda: ac.Case(ac.Machine(_machine().axes), [ac.Laser("l", "X")]), "Case", "machine"),
    "an axis alone": (lambda: anything.Machine(_machine().axes[0], [ac.Error("EXX", 1)]), "Machine", "axes"),
    "travel turned round": (lambda: ac.Axis.linear("X", "x", (1, 0)), "Axis.linear", "travel"),
    "a direction without length": (lambda: ac.Axis.linear("X", (0, 0, 0), (0, 1)), "Axis.linear", "along"),
    "an unknown direction": (lambda: ac.Laser("laser", "X", along="up"), "Laser", "along"),
    "a basis without covariance": (lambda: _with(object()), "Machine", "errors"),
    "a covariance that is none": (lambda: _with(_bend(6, BELOW)), "bend", "covariance()"),
    "an unknown frame": (lambda: _with(ac.Offset("bend", "Z", [0] * 6, 1e-6)), "Machine", "errors"),
    "robot of unknown parameters": (lambda: ac.Machine.from_dh([[0] * 4], {"b": 1e-3}), "Machine.from_dh", "std"),
    "a case of a name": (lambda: anything.Case("dmu60", [ac.Laser("laser", "X")]), "Case", "machine"),
    "an instrument alone": (lambda: anything.Case(_machine(), ac.Laser("laser", "X")), "Case", "instruments"),
    "an axis that is not there": (lambda: _mounted(ac.Laser("laser", "Y")), "Laser", "moves"),
    "parked outside": (lambda: ac.Case(_two(), [ac.Laser("laser", "X", park={"Y": 2.0})]), "Laser", "poses"),
    "parked and moved": (lambda: ac.Laser("laser", "X", park={"X": 0.2}), "Laser", "park"),
    "an idle unknown": (lambda: _mounted(_seeing("Idle", _moved, unknowns={"a": 1e-3})), "Idle.sees", "u['a']"),
    "a number named as an axis": (lambda: _mounted(_seeing("Axis", _moved, names=("X",))), "Axis", "names"),
    "a table with a slip": (lambda: _case().estimate(_TABLE | {"sdt": [1e-6]}), "Case.readings", "table"),
    "rows at a list of one pose": (lambda: anything.Machine.rows(_machine(), [0.1]), "Machine.rows", "poses"),
    "rows outside": (lambda: _machine().rows([[0.1], [2.0]]), "Machine.rows", "poses"),
    "a deviation nowhere": (lambda: _known().deviation(), "Known.deviation", "poses"),
    "a curve of a basis": (lambda: _of_a_bend()["bend"], "Known", "name"),
    "millimetres as metres": (lambda: ac.Axis.linear("X", "x", (0, 600)), "Axis.linear", "travel"),
    "a pitch without period": (lambda: ac.Error("EXX_pitch", 1e-6), "Error", "period"),
    "a scale of straightness": (lambda: ac.Error("EYX", 1e-6, scale=1e-5), "Error", "scale"),
    "an unknown mounting": (lambda: anything.Laser("laser", "X", nosie=1e-6), "Laser", "mounting"),
    "an unknown approach": (lambda: anything.Laser("laser", "X", approach="left"), "Laser", "approach"),
    "abs": (lambda: _mounted(_seeing("Norm", lambda at, u: [np.abs(at.moved[:, 0])])), "Norm.sees", "result"),
    "a number of another shape": (lambda: _mounted(_seeing("Wide", lambda at, u: [at.moved])), "Wide.sees", "result"),
    "no number": (lambda: _mounted(_seeing("Hole", _hole)), "Hole.sees", "result"),
    "an unknown that is not declared": (lambda: _mounted(_seeing("Open", _undeclared)), "Open.sees", "u['zero']"),
    "an instrument without sees": (lambda: _mounted(ac.Instrument("none", "X")), "Instrument", "sees"),
    "an unknown word": (lambda: anything.Case(_machine(), [ac.Laser("l", "X")], sure="very"), "Case", "sure"),
    "a reading outside the travel": (lambda: _case().evaluate(_places(0.89)), "Case.evaluate", "poses"),
    "places of another instrument": (lambda: _case().evaluate(ac.Places("dial", [[0.1]])), "Case.evaluate", "places"),
    "places that are a list": (lambda: anything.Case.evaluate(_case(), [[0.1]]), "Case.evaluate", "places"),
    "a side of two": (lambda: ac.Places("laser", [[0.1]], [[2.0]]), "Places", "sides"),
    "−1 readings": (lambda: _case().plan(readings=-1), "Case.plan", "readings"),
    "no end": (lambda: _case().plan(), "Case.plan", "readings"),
    "0 candidates": (lambda: _case().plan(readings=3, candidates=0), "Case.plan", "candidates"),
    "more kept than planned": (lambda: _case().plan(readings=1, keep=_places(0.1, 0.2)), "Case.plan", "keep"),
    "an RMS out of reach": (lambda: _case().plan(rms="1 nm"), "Case.plan", "rms"),
    "minutes that are too few": (lambda: _case().plan(minutes=0.01), "Case.plan", "minutes"),
    "an unknown criterion": (lambda: anything.Case.plan(_case(), 3, criterion="best"), "Case.plan", "criterion"),
    "estimate of a list": (lambda: anything.Case.estimate(_case(), [1, 2]), "Case.estimate", "readings"),
    "a table without instruments": (lambda: _case().estimate({"X": [0.1]}), "Case.readings", "table"),
    "fewer values than readings": (lambda: ac.Readings(_places(0.1, 0.2), [[1e-6]]), "Readings", "values"),
    "a value that is no number": (lambda: ac.Readings(_places(0.1), [np.nan]), "Readings", "values"),
    "fewer values than numbers": (lambda: _case().estimate(_one_value()), "Case.estimate", "readings"),
    "places of readings that are none": (lambda: anything.Readings([[0.1]], [0.0]), "Readings", "places"),
    "known of another size": (lambda: ac.Known.of(_case(), [0.0], [[1.0]]), "Known.of", "mean"),
    "an unknown error": (lambda: _known()["EYX"], "Known", "name"),
    "no sample": (lambda: _known().sample(0), "Known.sample", "count"),
    "a curve read without noise": (lambda: ac.Curve((0, 1), 1.0).read(0.5, 0.0, 0.0), "Curve.read", "noise"),
    "a curve of one knot": (lambda: ac.Curve((0, 1), 1.0, knots=1), "Curve", "knots"),
}  # fmt: skip


@pytest.mark.parametrize("misuse", MISUSES)
def test_a_misuse_is_refused(misuse: str) -> None:
    given, function, argument = MISUSES[misuse]
    with pytest.raises(ac.InputError) as refused:
        given()
    assert (refused.value.function, refused.value.argument) == (function, argument)
    assert str(refused.value).startswith(f"{function}: {argument}")
    assert str(refused.value).endswith(".")


def test_the_pose_is_named() -> None:
    with pytest.raises(ac.InputError, match=r"pose 1 has X = 2, outside the travel. X goes from 0 to 0.6") as refused:
        _case().machine.poses([[0.1], [2.0]])
    assert refused.value.pose == 1


def test_a_face_that_is_seldom_seen_has_an_unknown() -> None:
    """Of a polygon of 100 faces each unknown counts in a hundredth of the travel: none of them is taken for idle."""

    def faces(at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
        which = np.minimum(at.poses[:, 0] // 6e-3, 99).astype(int)
        return [at.moved[:, 0] + np.array([u[f"face{i}"] for i in which])]

    polygon = _seeing("Polygon", faces, unknowns={f"face{i}": 1e-6 for i in range(100)})
    assert len(_mounted(polygon).names) == _case().machine.size + 100


def test_what_is_known_says_which_curves_it_has() -> None:
    assert [*_known()] == ["EXX"]
    assert "EYX" not in _known()
