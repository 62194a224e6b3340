"""What two axes do together in CEC tables: a reader of its own, on both readings of what Siemens says of products."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import whole_travel
from axiscal.estimation.belief import Belief
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.description import machine_from_text
from axiscal.numerics import Array
from axiscal.tables.controllers.sinumerik.read_back import read, read_all
from axiscal.tables.controllers.sinumerik.surfaces import products
from axiscal.tables.export_options import ExportOptions
from axiscal.tables.offer import Export
from axiscal.tables.registry import export
from tests.generators.texts import machine_text
from tests.tables.test_sinumerik_tables import variables

PLANES = """EZXY = { std = "20 um", knots = [6, 5], length = ["150 mm", "120 mm"] }
EXYZ = { std = "10 um", knots = [5, 5], length = ["120 mm", "120 mm"] }
"""


def known(chain: str = "w-X'-b-Y-Z-t", planes: str = PLANES) -> Estimate:
    text = machine_text(
        chain,
        {"X": (0, 400), "Y": (-100, 200), "Z": (0, 300)},
        {"EXX": ("10 um", 9, 150), "EZX": "5 um", "EZY": "5 um", "EXY": "5 um", "EXZ": "5 um"},
        name="M",
    )
    model = ErrorModel(machine_from_text(text.rstrip() + "\n" + planes))
    mean = np.linalg.cholesky(model.prior_covariance() + 1e-30 * np.eye(model.size)) @ np.random.default_rng(
        4
    ).standard_normal(model.size)
    return Estimate(model, Belief(mean, 1e-20 * np.eye(model.size)), whole_travel(model))


def added(text: str, output: str, places: dict[str, Array], factors_act: bool, flip: bool = False) -> Array:
    """Return what the tables of an axis add, mm: the sum of values and products, taken away unless flipped."""
    v = variables(text)
    total = np.zeros(len(next(iter(places.values()))))

    def value(table: str) -> Array:
        low, step = (float(v[f"N_CEC_{name}"][table,]) for name in ("MIN", "STEP"))
        count = round((float(v["N_CEC_MAX"][table,]) - low) / step) + 1
        values = [float(v["N_CEC"][table, str(k)]) for k in range(count)]
        return np.interp(places[v["N_CEC_INPUT_AXIS"][table,]], low + step * np.arange(count), values)

    times = {table: int(number) for (table,), number in v["N_CEC_MULT_BY_TABLE"].items()}
    factors = {str(number - 1) for number in times.values() if number} | {t for t, number in times.items() if number}
    for table, number in times.items():
        if v["N_CEC_OUTPUT_AXIS"][table,] != output:
            continue
        if number:
            total += value(table) * value(str(number - 1))
        if table not in factors or factors_act:
            total += value(table)
    return total if flip else -total


@pytest.mark.parametrize("chain", ["w-X'-b-Y-Z-t", "w-b-X-Y-Z-t"])
@pytest.mark.parametrize("flip", [False, True])
def test_a_surface_is_held_on_either_reading_of_products(chain: str, flip: bool) -> None:
    estimate = known(chain)
    made = export(estimate, "sinumerik", ExportOptions(flip=flip))
    rng = np.random.default_rng(0)
    poses = np.zeros((400, 3))
    names = [axis.name for axis in estimate.machine.axes]
    for name, (low, high) in {"X": (0.0, 0.4), "Y": (-0.1, 0.2), "Z": (0.0, 0.3)}.items():
        poses[:, names.index(name)] = rng.uniform(low, high, 400)
    found = estimate.deviation(poses, np.zeros_like(poses))
    places = {f"AX{number}": 1e3 * poses[:, names.index(name)] for number, name in enumerate("XYZ", 1)}
    text = made.files["NC_CEC.INI"]
    for output, way in (("AX3", 2), ("AX1", 0)):
        one, other = (added(text, output, places, acts, flip) for acts in (True, False))
        np.testing.assert_allclose(one, other, atol=1e-9)
        own = encoder(made, output, places)
        left = 1e-3 * (one + own) + found[:, way]
        assert np.std(left) < 0.05 * np.std(found[:, way])
    assert "What two axes do together: as products of CEC tables." in made.readme
    assert "no table over one axis holds it" not in made.readme


def encoder(made: Export, output: str, places: dict[str, Array]) -> Array:
    """Return what encoder compensation adds to an axis, mm."""
    v = variables(made.files.get("AX_EEC.INI", ""))
    if ("0", output) not in v["A_ENC_COMP_STEP"]:
        return np.zeros(len(places[output]))
    low, step = (float(v[f"A_ENC_COMP_{name}"]["0", output]) for name in ("MIN", "STEP"))
    values = [float(v["A_ENC_COMP"]["0", str(k), output]) for k in range(sum(k[2] == output for k in v["A_ENC_COMP"]))]
    return -np.interp(places[output], low + step * np.arange(len(values)), values)


def test_every_factor_has_its_negative_and_the_note_says_so() -> None:
    made = export(known(), "sinumerik", ExportOptions())
    v = variables(made.files["NC_CEC.INI"])
    times = {int(table): int(number) for (table,), number in v["N_CEC_MULT_BY_TABLE"].items() if int(number)}
    assert 4 <= len(times) <= 16
    for table, number in times.items():
        if table + 1 in times and number == table + 3:
            for one, twin in ((table, table + 1), (table + 2, table + 3)):
                first, second = ([float(x) for (t, _), x in v["N_CEC"].items() if t == str(k)] for k in (one, twin))
                assert first == [-each for each in second]
    low, high = min(times), max(number - 1 for number in times.values())
    assert f"Tables {low} to {high} are what two axes do together" in " ".join(made.readme.split())
    limit = re.search(r"above.*?([\d.]+) mm \(AX3\)", made.readme)
    assert limit is not None
    assert 0.005 < float(limit[1]) < 0.2


def test_multiplied_tables_of_before_are_not_taken_over() -> None:
    made, machine = export(known(), "sinumerik", ExportOptions()), known().machine
    names, texts = {"X": "AX1", "Y": "AX2", "Z": "AX3"}, list(made.files.values())
    assert read_all(texts, names, machine)[1]
    with pytest.raises(TableError, match="is multiplied by another one"):
        read(texts, names, machine)
    broken = re.sub(r"MULT_BY_TABLE\[(\d+)\]=[1-9]\d*", r"MULT_BY_TABLE[\1]=99", made.files["NC_CEC.INI"])
    with pytest.raises(TableError, match="multiplied by table 99, which is not there"):
        read_all([broken], names, machine)


def test_where_a_table_turns_or_nothing_was_found_there_are_no_products() -> None:
    estimate = known()
    options = ExportOptions()
    assert products(estimate, options, 1000, 1e-6)
    turned = known(planes='EAXY = { std = "20 urad", knots = [5, 5], length = ["120 mm", "120 mm"] }\n')
    assert products(turned, options, 1000, 1e-6) == ()
    nothing = replace(estimate, belief=Belief(np.zeros(estimate.model.size), estimate.belief.covariance))
    assert products(nothing, options, 1000, 1e-6) == ()
    text = machine_text(
        "w-C'-X'-b-Y-Z-t", {"X": (0, 400), "Y": (-100, 200), "Z": (0, 300), "C": (0, 360)}, {"EXX": "5 um"}
    )
    model = ErrorModel(machine_from_text(text.rstrip() + "\n" + PLANES))
    turning = Estimate(model, Belief(np.ones(model.size) * 1e-5, np.eye(model.size)), whole_travel(model))
    assert products(turning, options, 1000, 1e-6) == ()


def test_which_factor_is_turned_over_is_settled() -> None:
    """F G and (−F)(−G) are the same product: the largest number of the first factor is positive on every computer."""
    for product in products(known(), ExportOptions(), 1000, 1e-6):
        values = product.first.added
        assert values[np.argmax(np.abs(values))] > 0
