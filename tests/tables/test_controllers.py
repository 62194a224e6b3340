"""Every controller: what is read back of its files corrects a machine that really turns; nothing else is offered."""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from axiscal.errors.volume import whole_travel
from axiscal.estimation.machine_estimate import Estimate, LeftUnknown
from axiscal.exceptions import TableError
from axiscal.machine.description import load_machine, machine_from_text
from axiscal.measurement.simulation import VirtualMachine
from axiscal.numerics import Array
from axiscal.ports.linuxcnc.tables import exporting, writer
from axiscal.ports.printers.contents import PrinterFormat
from axiscal.tables.exporter import ExportOptions, Written
from axiscal.tables.offer import Export, tried_out
from axiscal.tables.registry import controllers, export, exporter
from axiscal.tables.round_trip import drawn_and_known
from axiscal.tables.sampling import axis_tables
from axiscal.tables.surface import Effect, effect_of_control, rms, tour
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal
from tests.generators.known import truth_of
from tests.generators.texts import machine_text

TOOTHED = machine_text(
    "w-X'-b-Y-Z-t",
    {"X": (-100, 500), "Y": (0, 400), "Z": (-300, 0)},
    {
        "EXX EYX": "10 um",
        "EZX": "20 um",
        "EYY": "10 um",
        "EZY": ("20 um", 5, 200),
        "EZZ": "10 um",
        "C0Y B0Z": "90 urad",
        "EXX_reversal EYY_reversal": "5 um",
    },
    curve=(7, 200),
    tool=100,
    name="M",
)

FANUC = "\n".join(
    [
        "%",
        "N3620Q1A1P20A2P100A3P240;",
        "N3621Q1A1P10A2P100A3P200;",
        "N3622Q1A1P80A2P140A3P241;",
        "N3623Q1A1P1A2P1A3P1;",
        "N3624Q1A1P10000A2P10.000A3P10000;",
        *(f"N{number}Q1P0;" for number in range(10000, 10300)),
        "%",
    ]
)
COM = """BEGIN OLD_AXIS .COM MM
NR        AXISPOS    BACKLASH           X           Y           Z
0       -100.0000      0.0000      0.0000      0.0000      0.0000
1          0.0000      0.0000      0.0000      0.0000      0.0000
[END]
"""
OPTIONS = {"fanuc": ExportOptions(template=FANUC), "heidenhain": ExportOptions(template=COM)}
_ALWAYS_WHOLE = {"fanuc", "isg"}  # their files name every axis, with zeros where nothing is known
LEAVES = {  # the largest share of the error that may be left on this machine
    "csv": 0.01, "fanuc": 0.98, "grblhal": 0.001, "heidenhain": 0.02, "isg": 0.3, "klipper": 0.95, "linuxcnc": 0.03,
    "linuxcnc-volumetric": 0.001, "marlin": 0.95, "reprapfirmware": 0.95, "sinumerik": 0.01,
}  # fmt: skip


def counting(name: str, *ways: str) -> Machine:
    """A built-in machine, its B and C counting in stated ways."""
    text = load_machine(name).text
    for axis, way in zip("BC", ways, strict=bool(ways)):
        text = text.replace(f"[axes.{axis}]", f'[axes.{axis}]\ndirection = "{way}"')
    return machine_from_text(text)


@cache
def known(name: str, seed: int = 3) -> tuple[Estimate, VirtualMachine]:
    """A machine drawn from the prior, and the belief of somebody who knows it."""
    estimate = drawn_and_known(machine_from_text(TOOTHED) if name == "small" else counting(*name.split()), seed)
    return estimate, truth_of(estimate)


@cache
def draft(controller: str, name: str = "small") -> tuple[Estimate, Written]:
    estimate, _ = known(name)
    return estimate, exporter(controller).make(estimate, OPTIONS.get(controller, ExportOptions()))


@cache
def offered(controller: str, name: str = "small") -> Export:
    return tried_out(controller, *draft(controller, name))


def on_the_truth(estimate: Estimate, truth: VirtualMachine, made: Written) -> Effect:
    low, high = np.array(estimate.box).T
    poses: Array = low + (high - low) * np.random.default_rng(1).uniform(size=(500, len(low)))
    return effect_of_control(estimate.machine, truth.deviation, made.control, poses, estimate.box)


@pytest.mark.parametrize("controller", controllers())
def test_what_is_read_back_corrects_the_true_machine_as_stated(controller: str) -> None:
    estimate, truth = known("small")
    stated = offered(controller).effect
    found = on_the_truth(estimate, truth, draft(controller)[1])
    assert found.after < LEAVES[controller] * found.before
    assert found.after == pytest.approx(stated.after, rel=0.1, abs=0.02e-6)
    assert found.before == pytest.approx(stated.before, rel=0.1)


@pytest.mark.parametrize("controller", ["linuxcnc", "linuxcnc-volumetric", "sinumerik", "csv", "isg"])
def test_five_axes_are_corrected_as_stated(controller: str) -> None:
    estimate, truth = known("dmu60")
    stated = offered(controller, "dmu60").effect
    found = on_the_truth(estimate, truth, draft(controller, "dmu60")[1])
    assert found.after < (0.2 if controller.startswith("isg") else 0.6) * found.before
    assert found.after == pytest.approx(stated.after, rel=0.1, abs=1e-9)  # a nanometre is what linearity neglects


@pytest.mark.parametrize("controller", controllers())
def test_the_wrong_sign_is_never_offered(controller: str) -> None:
    estimate, made = draft(controller)
    wrong = replace(made, control=lambda poses, approaches: -made.control(poses, approaches))
    with pytest.raises(TableError, match="more or less than they should"):
        tried_out(controller, estimate, wrong)
    with pytest.raises(TableError, match="would take the error from"):
        tried_out(controller, estimate, replace(wrong, wanted=wrong.control))


@pytest.mark.parametrize("controller", controllers())
def test_nothing_is_written_when_nothing_is_known(controller: str) -> None:
    model = known("small")[0].model
    blank = Estimate(model, Normal(np.zeros(model.size), model.covariance()), whole_travel(model))
    options = OPTIONS.get(controller, ExportOptions())
    if controller in _ALWAYS_WHOLE:
        assert export(blank, controller, options).effect == (0, 0)
        return
    with pytest.raises(TableError, match="no deviation"):
        export(blank, controller, options)


def test_what_is_expected_is_what_machines_of_the_belief_show() -> None:
    """The mean square over machines drawn from the belief, each corrected as estimated, up to its one shift.

    So much of the volume as U says is within it, in the mean over the machines.
    """
    estimate, _ = known("small")
    estimate = replace(estimate, belief=Normal(estimate.belief.mean, 1e8 * estimate.belief.covariance))
    apart = np.random.default_rng(5).standard_normal((400, estimate.factor.shape[1])) @ estimate.factor.T
    low, high = np.array(estimate.box).T
    poses, approaches = tour(np.random.default_rng(6).uniform(low, high, (3000, 3)), estimate.box)
    rows = estimate.model.rows_at(poses, approaches)
    off = [np.linalg.norm(one - one.mean(axis=0), axis=1) for one in (rows @ each for each in apart)]
    unknown = LeftUnknown(float(np.sqrt(np.mean(np.square(off)))), float(np.quantile(off, 0.95)))
    offered = export(replace(estimate, unknown=unknown), "csv", ExportOptions())
    added = offered.control(poses, approaches)
    moved = estimate.machine.frames(poses + added).tcp - estimate.machine.frames(poses).tcp
    each = [rows @ (estimate.mean + one) + moved for one in apart]
    assert np.sqrt(np.mean([rms(one) ** 2 for one in each])) == pytest.approx(offered.expected, rel=0.05)
    assert offered.known.rms > 0
    inside = [np.mean(np.linalg.norm(one - one.mean(axis=0), axis=1) <= offered.certain) for one in each]
    assert np.mean(inside) == pytest.approx(0.95, abs=0.02)


@pytest.mark.parametrize("controller", controllers())
def test_machine_zero_stays_where_it_is(controller: str) -> None:
    """Every axis at 0, or at the end of its travel nearest to it: the mean of both directions moves nothing.

    A mesh is nothing in the middle, where its printer homes Z.
    """
    estimate, made = draft(controller)
    travels = np.array([axis.travel for axis in estimate.machine.axes])
    zero = np.clip(0.0, *travels.T)[None]
    if isinstance(exporter(controller), PrinterFormat):
        zero[0, :2] = travels[:2].mean(axis=1)
        assert abs(made.control(zero, np.zeros_like(zero))[0, 2]) < 1e-6
        return
    moved = (made.control(zero, np.ones_like(zero)) + made.control(zero, -np.ones_like(zero))) / 2
    far = made.control(zero + np.array([0.3, 0.3, -0.2]), np.ones_like(zero))
    assert np.max(np.abs(moved)) < (0.6e-6 if controller == "fanuc" else 2e-8)
    assert np.max(np.abs(far)) > 2e-6


def test_a_constant_that_nothing_shows_is_not_in_a_table() -> None:
    """It makes no value of a table uncertain that counts from machine zero, and the shape not at all."""
    model = known("small")[0].model
    prior, ones = model.covariance(), np.zeros(model.size)
    ones[model.by_name["EXX"].columns] = 1.0
    estimates = [
        Estimate(model, Normal(np.ones(model.size), c), whole_travel(model))
        for c in (prior, prior + 1e-6 * np.outer(ones, ones))
    ]
    before, after = (axis_tables(e)[0] for e in estimates)
    assert after.std == pytest.approx(before.std, rel=1e-6, abs=1e-12)
    assert after.shape_std == pytest.approx(before.shape_std, rel=1e-6)
    assert 0 < before.shape_std <= np.max(before.std)


@pytest.mark.parametrize("controller", ["sinumerik", "isg", "fanuc", "heidenhain"])
def test_a_control_that_takes_the_other_sign_gets_it(controller: str) -> None:
    estimate, plain = draft(controller)
    options = replace(OPTIONS.get(controller, ExportOptions()), flip=True)
    other = exporter(controller).make(estimate, options)
    assert other.files != plain.files
    poses = np.array(estimate.box).mean(axis=1)[None] * 0.7
    up = np.ones_like(poses)
    assert other.control(poses, up) == pytest.approx(plain.control(poses, up), abs=2e-6)
    tried_out(controller, estimate, other)


def test_heidenhain_has_the_decimals_of_its_template_from_three_on() -> None:
    for decimals in (3, 6):
        text = COM.replace(".0000", "." + decimals * "0")
        found = export(known("small")[0], "heidenhain", ExportOptions(template=text)).files["X_AXIS.COM"]
        row = dict(zip(COM.splitlines()[1].split(), found.splitlines()[3].split(), strict=True))
        assert {len(row[head].partition(".")[2]) for head in ("AXISPOS", "BACKLASH", "X")} == {decimals}


@pytest.mark.parametrize(
    "change",
    [
        lambda text: "# made by us\n" + text,
        lambda text: text.replace("\n", "\n\n", 1),
        lambda text: text.replace(".", ","),
        lambda text: "".join(f"{a} {c} {b}\n" for a, b, c in map(str.split, text.splitlines())),
        lambda text: re.sub(r"(\d\d)$", "99", text, count=1, flags=re.MULTILINE),
        lambda text: re.sub(r"\S+$", "nan", text, count=1, flags=re.MULTILINE),
        lambda text: re.sub(r"\S+$", "inf", text, count=1, flags=re.MULTILINE),
    ],
)
def test_a_table_that_linuxcnc_reads_differently_is_refused(
    change: Callable[[str], str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(exporting, "write", lambda table, unit: change(writer.write(table, unit)))
    with pytest.raises(TableError, match=r"more or less than they should|reads no row|too large for a machine"):
        export(known("small")[0], "linuxcnc", ExportOptions())
