"""Rotary tables over all turns: a `COMP_FILE`, read by a reader of its own, is right wherever the joint may stand."""

import numpy as np
import pytest

from axiscal.estimation.machine_estimate import Estimate
from axiscal.machine.description import machine_from_text
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.offer import Export
from axiscal.tables.registry import export
from axiscal.tables.round_trip import drawn_and_known
from tests.generators.texts import Std, machine_text


def known(limits: str = "", knots: int = 17) -> Estimate:
    errors: dict[str, Std] = {
        "EXX": ("10 um", 5, 150),
        "ECC": f'std = "40 urad", knots = {knots}',
        "ECC_reversal": "30 urad",
    }
    text = machine_text("w-C'-X'-b-Y-t", {"X": (0, 400), "Y": (0, 300), "C": (-180, 180)}, errors)
    stated = f"[axes.C]\nlimits = {limits}\n" if limits else "[axes.C]\n"
    return drawn_and_known(machine_from_text(text.replace("[axes.C]\n", stated)), 4)


def exported(estimate: Estimate) -> Export:
    return export(estimate, "linuxcnc", ExportOptions())


def added(text: str, joint: float, up: bool) -> float:
    """Return what LinuxCNC adds, deg: nominal less actual, linear between rows, constant outside, 256 rows at most."""
    rows = np.array([[float(word) for word in line.split()] for line in text.splitlines()])
    assert rows.shape[0] <= 256
    assert np.all(np.diff(rows[:, 0]) > 0)
    return float(np.interp(joint, rows[:, 0], rows[:, 0] - rows[:, 1 if up else 2]))


def deviation(estimate: Estimate, angle: float, up: bool) -> float:
    """Return how much further the table turns than it was told, deg, from the control values themselves."""
    model = estimate.model
    own, back = model.by_name["ECC"], model.by_name["ECC_reversal"]
    within = (np.radians(angle) + np.pi) % (2 * np.pi) - np.pi
    value = own.spline.rows(np.array([within]))[0] @ estimate.mean[own.columns]
    value += (0.5 if up else -0.5) * estimate.mean[back.columns][0]
    return -float(np.degrees(value))  # C' carries the workpiece


@pytest.mark.parametrize("up", [True, False])
@pytest.mark.parametrize("angle", [-890.0, -500.0, -100.0, 33.0, 200.0, 475.0, 890.0])
def test_a_full_turn_is_corrected_over_five_turns(angle: float, up: bool) -> None:
    estimate = known()
    found = added(exported(estimate).files["C.comp"], angle, up)
    wanted = -deviation(estimate, angle, up)
    assert found == pytest.approx(wanted, abs=np.degrees(1.5e-6))
    assert abs(wanted) > np.degrees(5e-6) or abs(deviation(estimate, angle, not up)) > np.degrees(5e-6)


@pytest.mark.parametrize(
    ("limits", "ends"),
    [
        ("", (-900, 900)),
        ('["-180 deg", "180 deg"]', (-180, 180)),
        ('["-270 deg", "1000 deg"]', (-540, 1260)),
        ('["-180 deg", "3600 deg"]', (-180, 1620)),
        ('["-9999 deg", "9999 deg"]', (-900, 900)),
    ],
)
def test_the_table_reaches_as_far_as_the_limits_and_at_most_five_turns(limits: str, ends: tuple[int, int]) -> None:
    rows = [float(line.split()[0]) for line in exported(known(limits)).files["C.comp"].splitlines()]
    assert (rows[0], rows[-1]) == pytest.approx(ends)


def test_one_turn_only_is_as_fine_as_256_rows_allow_and_the_note_says_what_it_holds() -> None:
    one, five = exported(known('["-180 deg", "180 deg"]', knots=33)), exported(known(knots=33))
    assert len(one.files["C.comp"].splitlines()) == 33 * 4 - 3
    assert len(five.files["C.comp"].splitlines()) == 5 * 51 + 1
    assert "this one holds one turn." in one.readme
    assert "this one holds 5 turns. The joint counts on after 360 deg, with WRAPPED_ROTARY" in five.readme
