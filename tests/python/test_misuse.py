"""Every misuse of the library is refused by a class of ours, which says where: function and argument, file and line."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import axiscal as ac
import axiscal_core
from axiscal.exceptions import AxiscalError

anything: Any = ac
"""The library as a language without types sees it."""
NAN, INF = float("nan"), float("inf")


@cache
def mill() -> Any:
    laser = ac.setup("interferometer", "x", moves=["X"], name="laser", approach="both", park={"Y": "100 mm"})
    return ac.Case(ac.load_machine("three-axis-mill"), [laser])


@cache
def own() -> Any:
    machine = ac.Machine([ac.Axis.linear("X", "x", (0, "600 mm"))], [ac.Error("EXX", "10 um", length="200 mm")])
    return axiscal_core.Case(machine, [ac.Laser("laser", "X")])


LINE = ac.Places("laser", [[x, 0.1, 0.2] for x in (0.1, 0.3, 0.5)], [[1.0, 0.0, 0.0]] * 3)
SHORT = ac.Places("laser", [[0.1], [0.3]])
OUTSIDE, NO_PLACE = ac.Places("laser", [[9.0, 0.1, 0.2]]), ac.Places("laser", np.zeros((0, 3)))
ELSEWHERE, TURNED = ac.Places("dial", [[0.1, 0.1, 0.2]]), ac.Places("laser", [["1 rad", 0.1, 0.2]])


TABLE = {"setup": ["laser"], "X_mm": [100.0], "value_um": [1.0]}


def elsewhere() -> Any:
    return ac.Case(ac.load_machine("one-axis"), [ac.setup("interferometer", "x")]).estimate([])


def size(case: Any) -> int:
    return len(case.prior.mean)


def read(places: ac.Places = LINE, **how: Any) -> ac.Readings:
    return ac.Readings(places, [0.0] * len(places), **how)


@cache
def known() -> Any:
    return mill().estimate(read())


@cache
def own_known() -> Any:
    return own().estimate(read(SHORT))


def simulator() -> Any:
    return ac.Simulator(mill().description.machine, mill().description.setups)


def mounted(*keys: Any, **named: Any) -> Any:
    return anything.Case(mill().description.machine, [ac.setup("level", "x"), anything.setup(*keys, **named)])


MISUSES: dict[str, tuple[Callable[[], object], str]] = {
    "keep: numbers": (lambda: mill().plan(3, keep=[1, 2]), "Case.plan: keep"),
    "keep: a name": (lambda: mill().plan(3, keep="laser"), "Case.plan: keep"),
    "keep: an empty list": (lambda: mill().plan(3, keep=[]), "Case.plan: keep"),
    "keep: outside": (lambda: mill().plan(3, keep=OUTSIDE), "Case.plan: keep, line 1"),
    "keep: of no set-up": (lambda: mill().plan(3, keep=ELSEWHERE), "Case.plan: keep, line 1"),
    "keep: of another machine": (lambda: mill().plan(3, keep=SHORT), "Case.plan: keep, line 1"),
    "keep: an angle": (lambda: mill().plan(3, keep=TURNED), "Case.plan: keep, pose 0 = '1 rad' is no length"),
    "keep: too many": (lambda: mill().plan(2, keep=LINE), "Case.plan: keep holds 3 places of 2"),
    "keep: too long": (lambda: mill().plan(minutes=5, keep=LINE), "Case.plan: the places to keep take 30"),
    "criterion: a word": (lambda: mill().plan(3, criterion="best"), "Case.plan: criterion"),
    "criterion: a number": (lambda: mill().plan(3, criterion=3), "Case.plan: criterion"),
    "criterion: a vector": (lambda: mill().plan(3, criterion=np.ones(size(mill()))), "Case.plan: criterion"),
    "criterion: too wide": (lambda: mill().plan(3, criterion=np.ones((1, 999))), "Case.plan: criterion"),
    "criterion: NaN": (lambda: mill().plan(3, criterion=[[NAN] * size(mill())]), "Case.plan: criterion"),
    "criterion: nought": (lambda: mill().plan(3, criterion=np.zeros((1, size(mill())))), "Case.plan: criterion"),
    "criterion: empty": (lambda: mill().plan(3, criterion=np.zeros((0, size(mill())))), "Case.plan: criterion"),
    "criterion: complex": (lambda: mill().plan(3, criterion=[[1j] * size(mill())]), "Case.plan: criterion"),
    "criterion: texts": (lambda: mill().plan(3, criterion=[["a"] * size(mill())]), "Case.plan: criterion"),
    "criterion: a function plans": (lambda: mill().plan(3, criterion=np.trace), "Case.plan: criterion is a function"),
    "criterion: a function is next": (lambda: mill().next(criterion=np.trace), "Case.next: criterion is a function"),
    "criterion: a function fails": (lambda: mill().evaluate(LINE, criterion=lambda c: 1 / 0), "criterion: result"),
    "criterion: a function of NaN": (lambda: mill().evaluate(LINE, criterion=lambda c: NAN), "criterion: result"),
    "criterion: a function of arrays": (lambda: mill().evaluate(LINE, criterion=lambda c: c), "criterion: result"),
    "plan: nothing ends it": (lambda: mill().plan(), "Case.plan: readings is not said"),
    "plan: NaN readings": (lambda: mill().plan(NAN), "Case.plan: readings"),
    "plan: a billion readings": (lambda: mill().plan(10**9), "Case.plan: a plan of 1,000,000,000 readings"),
    "plan: a billion places": (lambda: mill().plan(3, candidates=10**9), "Case.plan: a choice among 1,000,000,000"),
    "plan: a life of minutes": (lambda: mill().plan(minutes=1e9), "Case.plan: 1.67e+07 h are time for"),
    "plan: half a reading": (lambda: mill().plan(2.5), "Case.plan: readings = 2.5 is no whole number"),
    "plan: −1 readings": (lambda: mill().plan(-1), "Case.plan: readings = -1 is below 1"),
    "plan: an RMS below zero": (lambda: mill().plan(rms=-1e-6), "Case.plan: rms = -1e-06 makes no sense"),
    "plan: minutes that are a length": (lambda: mill().plan(minutes="3 mm"), "Case.plan: minutes = '3 mm' is no time"),
    "plan: 0 candidates": (lambda: mill().plan(3, candidates=0), "Case.plan: candidates = 0 is below 1"),
    "plan: NaN minutes": (lambda: mill().plan(minutes=NAN), "Case.plan: minutes"),
    "plan: minutes of a list": (lambda: mill().plan(minutes=[3]), "Case.plan: minutes"),
    "plan: too few minutes": (lambda: mill().plan(minutes=0.1), "Case.plan: 0.1 min is less than the 30"),
    "plan: an RMS out of reach": (lambda: mill().plan(rms="1 nm"), "Case.plan: an RMS of 0.001 um cannot be reached"),
    "plan: an RMS that is an angle": (lambda: mill().plan(rms="1 urad"), "Case.plan: rms"),
    "plan: an endless RMS": (lambda: mill().plan(rms=INF), "Case.plan: rms"),
    "plan: no candidates": (lambda: mill().plan(3, candidates=NO_PLACE), "Case.plan: candidates are none"),
    "plan: candidates of None": (lambda: mill().plan(3, candidates=None), "Case.plan: candidates"),
    "evaluate: None": (lambda: mill().evaluate(None), "Case.evaluate: places"),
    "evaluate: an angle": (lambda: mill().evaluate(TURNED), "Case.evaluate: places, pose 0 = '1 rad'"),
    "evaluate: after other places": (lambda: mill().evaluate(LINE, after=SHORT), "Case.evaluate: after, line 1"),
    "next: after what the core knows": (lambda: mill().next(after=own_known()), "Case.next: after"),
    "estimate: a std that is an angle": (
        lambda: mill().estimate(read(std=["1 rad"] * 3)),
        "Case.estimate: std, pose 0 = '1 rad' is no length",
    ),
    "estimate: a value that is an angle": (
        lambda: mill().estimate(anything.Readings(LINE, ["1 urad", 0.0, 0.0])),
        "Case.estimate: values = '1 urad' is no length",
    ),
    "estimate: a table outside": (lambda: mill().estimate(TABLE | {"X_mm": [9e3]}), "readings, line 2: X = 9000 mm"),
    "estimate: a short column": (lambda: mill().estimate(TABLE | {"X_mm": []}), "readings: the table has columns of"),
    "estimate: a name for a column": (lambda: mill().estimate(TABLE | {"setup": "l"}), "readings: the table has col"),
    "estimate: another unit": (lambda: mill().estimate(ac.Readings(LINE, [9.0] * 3)), "readings: 3 of 3 readings are"),
    "estimate: of another machine": (lambda: mill().estimate(read(SHORT)), "Case.estimate: places, line 1"),
    "read: None": (lambda: known().read(None), "Estimated.read: readings"),
    "read: places": (lambda: known().read(LINE), "Estimated.read: readings"),
    "read: numbers": (lambda: known().read([1, 2]), "Estimated.read: readings"),
    "read: of another machine": (lambda: known().read(read(SHORT)), "Estimated.read: places, line 1"),
    "read: too few": (lambda: known().read(ac.Readings(LINE, [0.0])), "Estimated.read: values"),
    "read: a std that is an angle": (lambda: known().read(read(std=["1 rad"] * 3)), "Estimated.read: std"),
    "read: no such file": (lambda: known().read("no such file.csv"), "no such file.csv: there is no such file"),
    "deviation: nowhere": (lambda: known().deviation(joint=True), "Estimated.deviation: poses are none"),
    "deviation: no poses": (lambda: known().deviation(NO_PLACE.poses), "Estimated.deviation: poses are none"),
    "deviation: joint of a word": (lambda: known().deviation(LINE.poses, joint="yes"), "Estimated.deviation: joint"),
    "deviation: outside": (lambda: known().deviation(OUTSIDE.poses), "Estimated.deviation: poses: X = 9000 mm"),
    "deviation: NaN": (lambda: known().deviation([[NAN, 0.1, 0.2]]), "Estimated.deviation: poses"),
    "deviation: of two axes": (lambda: known().deviation([[0.1, 0.2]]), "Estimated.deviation: poses"),
    "deviation: no such axis": (lambda: known().deviation({"Q": 1}), "Estimated.deviation: poses: the machine has no"),
    "known: a covariance below zero": (lambda: mill().known(np.zeros(168), -np.eye(168)), "Case.known: covariance"),
    "known: NaN": (lambda: mill().known(np.full(168, NAN), np.eye(168)), "Case.known: mean"),
    "known: too short": (lambda: mill().known([0.0], [[1.0]]), "Case.known: mean has the shape (1,)"),
    "known: no such error": (lambda: known()["EXQ"], "Estimated: name = 'EXQ' is no error. Errors are EXX, "),
    "deviation: both sides": (lambda: known().deviation(LINE.poses, approach="both"), "Estimated.deviation: approach"),
    "export: nowhere": (lambda: known().export("linuxcnc", None), "Estimated.export: folder = None is none"),
    "case: learn of a word": (
        lambda: anything.Case(mill().description.machine, [], learn="yes"),
        "Case: learn = 'yes'",
    ),
    "case: set-ups of names": (lambda: anything.Case(mill().description.machine, ["a"]), "Case: setups = 'a' is none"),
    "next: after another machine": (
        lambda: mill().next(after=elsewhere()),
        "Case.next: after is an estimate of another",
    ),
    "shows: None": (lambda: mill().shows(LINE, None), "Case.shows: x"),
    "curve: a ragged list": (lambda: known()["EXX"]([[1, 2], [3]]), "Curve: t"),
    "curve: a billion knots": (lambda: ac.Curve([0, 1], 1e-6, knots=10**9), "Spline: knots"),
    "spline: a text": (lambda: anything.NaturalSpline("abc"), "Spline: knots"),
    "spline: rows at a text": (lambda: ac.NaturalSpline(np.arange(3.0)).rows("a"), "Spline: t"),
    "spline: a constant of texts": (lambda: anything.Constant("a", "b"), "Spline: knots"),
    "belief: texts": (lambda: ac.Belief("a", "b"), "Mean or covariance is no array of numbers"),
    "load_machine: 3": (lambda: anything.load_machine(3), "load_machine: source"),
    "read_campaign: 3": (lambda: anything.read_campaign(3), "read_campaign: path"),
    "ErrorModel: a name": (lambda: anything.ErrorModel("dmu60"), "ErrorModel: machine"),
    "Simulator: a name": (lambda: anything.Simulator("dmu60", []), "Simulator: machine"),
    "Simulator: set-ups of numbers": (lambda: anything.Simulator(mill().description.machine, [3]), "Simulator: setups"),
    "Simulator.drawn: −1": (lambda: simulator().drawn(-1), "Simulator.drawn: seed"),
    "Simulator: too few coefficients": (lambda: simulator().with_coefficients([1], 1), "Simulator.with_coefficients"),
    "Simulator: a list of curves": (lambda: simulator().with_curves([1], 1), "Simulator.with_curves: curves"),
    "Simulator: curves of seed −1": (lambda: simulator().with_curves({}, -1), "Simulator.with_curves: seed"),
    "Campaign.create: 3": (lambda: anything.Campaign.create(3, mill().description), "Campaign.create: path"),
    "Campaign.create: of 3": (lambda: anything.Campaign.create("a.axiscal", 3), "Campaign.create: description"),
    "Campaign.open: 3": (lambda: anything.Campaign.open(3), "Campaign.open: path"),
    "set-up: a unit": (lambda: mounted("interferometer", noise="1 kg", name="b"), 'Case: setup "b": noise: "1 kg" has'),
    "set-up: an axis": (lambda: mounted("probe", "x", moves=["Q"]), 'Case: setup "probe x Q": moves: there is no'),
    "set-up: a key": (lambda: mounted("probe", "x", nosie="1 um"), 'Case: setup "probe x": unknown key "nosie". '),
    "set-up: a key of a table": (
        lambda: mounted("probe", "x", unknowns={"zro": "1 um"}),
        'Case: setup "probe x": unknowns.zro',
    ),
    "set-up: axes that are numbers": (lambda: mounted("probe", "x", moves=[1]), "setup: moves"),
    "set-up: of no name": (
        lambda: anything.Case(mill().description.machine, [{}]),
        'Case: setup "number 1": "name" is',
    ),
    "set-up: parked outside": (
        lambda: ac.Case(mill().description.machine, [ac.Laser("laser", "X", park={"Y": 9.0})]),
        'Case: setup "laser": park.Y: "9000 mm" is outside the travel',
    ),
    "target: a unit": (
        lambda: ac.Case(mill().description.machine, [ac.setup("probe", "x")], {"rms": "1 kg"}),
        'Case: target.rms: "1 kg"',
    ),
    "own: a billion readings": (lambda: own().plan(10**9), "Case.plan: readings = 1000000000 are too many"),
    "own: nought for V": (lambda: own().plan(3, criterion=np.zeros((1, size(own())))), "Case.plan: criterion weighs"),
    "own: keep of another machine": (lambda: own().plan(4, keep=LINE), "Case.plan: poses"),
    "own: keep of a list": (lambda: own().plan(4, keep=[[0.1]]), "Case.plan: keep"),
    "own: a std that is an angle": (
        lambda: own().estimate(read(SHORT, std=["1 rad"] * 2)),
        "Case.estimate: std, pose 0 = '1 rad' is no length",
    ),
    "own: a value that is an angle": (
        lambda: own().estimate(anything.Readings(SHORT, ["1 urad", 0.0])),
        "Case.estimate: values = '1 urad' is no length",
    ),
    "own: places by an angle": (
        lambda: own().evaluate(SHORT + ac.Places("laser", [["1 rad"]])),
        "Case.evaluate: poses, pose 2 = '1 rad' is no length",
    ),
    "own: a target": (
        lambda: anything.Case(own().machine, [ac.Laser("laser", "X")], {"rms": "2 um"}),
        "Case: target and",
    ),
    "own: learnt": (
        lambda: anything.Case(own().machine, [ac.Laser("laser", "X")], learn=True),
        "Case: target and learn",
    ),
    "own: read places": (lambda: own_known().read(SHORT), "Known.read: readings"),
    "own: read of another machine": (lambda: own_known().read(read()), "Known.read: poses"),
    "own: read with a std of its own": (lambda: own_known().read(read(SHORT, std=[1e-6] * 2)), "Readings: std"),
    "own: joint of a word": (lambda: own_known().deviation([[0.1]], joint="yes"), "Known.deviation: joint"),
    "own: shows NaN": (lambda: own().shows(SHORT, [NAN] * size(own())), "Case.shows: x"),
    "own: a belief too short": (lambda: own().known([0.0], [[1.0]]), "Known.of: mean"),
    "own: a table of one number": (
        lambda: own().estimate({"instrument": ["laser"], "X": 0.3, "length": []}),
        "Case.readings: length",
    ),
    "places: one that is not there": (lambda: SHORT.at([7]), "Places.at: which"),
    "places: a name": (lambda: anything.Places.at(SHORT, "a"), "Places.at: which"),
    "instrument: axes that are numbers": (lambda: anything.Laser("laser", [1]), "Laser: moves"),
    "plane: axes of a number": (lambda: anything.Plane("EZXY", 1e-6, 3, [1, 1]), "Plane: axes"),
}


@pytest.mark.parametrize("misuse", MISUSES)
def test_a_misuse_is_refused_where_it_is(misuse: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    given, says = MISUSES[misuse]
    with pytest.raises((ac.InputError, AxiscalError)) as refused:
        given()
    assert str(refused.value).startswith(says)
    assert [*tmp_path.iterdir()] == []


def test_faults_of_several_set_ups_are_said_together() -> None:
    with pytest.raises(AxiscalError) as refused:
        ac.Case(mill().description.machine, [ac.setup("probe", "x", name=name, noise="1 kg") for name in "ab"])
    assert [line.partition(": noise")[0] for line in str(refused.value).splitlines()] == [
        'Case: setup "a"',
        '- Case: setup "b"',
    ]


def test_an_rms_that_a_plan_misses_says_what_it_leaves() -> None:
    """Below the floor, above what the most readings of a plan leave: neither comes back as if it were reached."""
    floor = mill().inner.yardstick.rms_floor
    with pytest.raises((ac.InputError, AxiscalError), match="leave"):
        mill().plan(rms=floor * 1.0001, candidates=40)
    with pytest.raises(ac.InputError, match=r"rms = .* is out of reach: .* leave"):
        own().plan(rms=1e-9, candidates=40)
