"""SINUMERIK's tables, read by a reader of its own: system variables into tables, tables into corrections."""

import re
from collections import defaultdict

import numpy as np
import pytest

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.description import machine_from_text
from axiscal.tables.controllers import sinumerik
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.offer import Export
from axiscal.tables.registry import export
from axiscal.tables.round_trip import drawn_and_known
from axiscal.tables.table import CompensationTable
from tests.generators.texts import machine_text

MACHINE = machine_text(
    "w-C'-X'-b-Y-t",
    {"X": (0, 400), "Y": (0, 300), "C": (0, 360)},
    {"EXX": ("10 um", 9, 150), "EXX_reversal": "5 um", "EYX": "10 um", "ECC": ("40 urad", 9, 120)},
    name="M",
)


def known() -> Estimate:
    return drawn_and_known(machine_from_text(MACHINE), 4)


def exported(**options: object) -> Export:
    return export(known(), "sinumerik", ExportOptions(**options))  # type: ignore[arg-type]


def variables(text: str) -> dict[str, dict[tuple[str, ...], str]]:
    found: dict[str, dict[tuple[str, ...], str]] = defaultdict(dict)
    for name, index, value in re.findall(r"^\$A([AN]_[A-Z_]+)\[(.*?)\]=(.*)$", text, re.MULTILINE):
        found[name][tuple(index.split(","))] = value.strip("()")
    return found


@pytest.mark.parametrize("system", [1, 2])
def test_encoder_compensation_is_of_the_chosen_measuring_system_and_repeats_after_a_turn(
    system: int,
) -> None:
    made = exported(encoder=system)
    found = variables(made.files["AX_EEC.INI"])
    assert set(found["A_ENC_COMP_STEP"]) == {(str(system - 1), axis) for axis in ("AX1", "AX3")}
    assert [found["A_ENC_COMP_IS_MODULO"][str(system - 1), axis] for axis in ("AX1", "AX3")] == ["0", "1"]
    assert f"measuring system {system} of each axis (index {system - 1})" in made.readme
    assert "MD30310 ROT_IS_MODULO" in made.readme


def test_the_sum_that_md32720_must_allow_is_that_of_the_tables() -> None:
    made = exported()
    cec = variables(made.files["NC_CEC.INI"])
    largest: dict[str, float] = defaultdict(float)
    for (table,), axis in cec["N_CEC_OUTPUT_AXIS"].items():
        values = [abs(float(value)) for key, value in cec["N_CEC"].items() if key[0] == table]
        if cec["N_CEC_DIRECTION"][table,] in ("0", "1"):
            largest[axis] += max(values)
    for axis, value in largest.items():
        stated = re.search(rf"above.*?([\d.]+) mm \({axis}\)", made.readme)
        assert stated is not None
        assert float(stated[1]) == pytest.approx(value, abs=2e-4)


def test_more_points_than_md18342_can_allow_are_refused() -> None:
    at = np.linspace(0.0, 2.0, 2001)
    flat = np.zeros(2001)
    table = CompensationTable("X", at, flat + 1e-6, flat, flat)
    with pytest.raises(TableError, match="has 2001 points, the control holds 2000"):
        sinumerik.cec_tables([table])
