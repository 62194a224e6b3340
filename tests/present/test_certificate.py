"""The certificate and the CSV file: elements in the order of DCC 3.3.0, the numbers of the summary."""

from __future__ import annotations

import csv
import io
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.exceptions import ReadingError
from axiscal.measurement.readers.files import read_any
from axiscal.present.rendering import certificate
from axiscal.present.result_document import readings_csv, result_json
from axiscal.present.sentences import values_text
from tests.present.test_page import HOSTILE, _with_every_text, five_axis_summary

DCC, SI = "https://ptb.de/dcc", "https://ptb.de/si"
ORDER = {
    "digitalCalibrationCertificate": ["administrativeData", "measurementResults"],
    "administrativeData": [
        "dccSoftware", "coreData", "items", "calibrationLaboratory", "respPersons", "customer",
    ],
    "coreData": [
        "countryCodeISO3166_1", "usedLangCodeISO639_1", "mandatoryLangCodeISO639_1", "uniqueIdentifier",
        "beginPerformanceDate", "endPerformanceDate", "performanceLocation",
    ],
    "item": ["name", "manufacturer", "identifications"],
    "identification": ["issuer", "value", "name"],
    "respPerson": ["person", "role", "mainSigner"],
    "measurementResults": ["usedMethods", "measuringEquipments", "influenceConditions", "measurementResult"],
    "usedMethod": ["name", "norm"],
    "measuringEquipment": ["name", "description", "identifications"],
    "measurementResult": ["name", "description", "results"],
    "result": ["name", "data"],
    "realListXMLList": ["valueXMLList", "unitXMLList", "measurementUncertaintyUnivariateXMLList"],
    "expandedMUXMLList": ["valueExpandedMUXMLList", "coverageFactorXMLList", "coverageProbabilityXMLList"],
    "real": ["value", "unit", "measurementUncertaintyUnivariate"],
}  # fmt: skip
"""Children of each element in the order in which the schemas DCC 3.3.0 and D-SI 2.2 ask for them."""


def _name(element: ET.Element) -> str:
    return element.tag.rpartition("}")[2]


@pytest.fixture(scope="module")
def root() -> ET.Element:
    return ET.fromstring(certificate(five_axis_summary(12)))


def test_elements_stand_in_the_order_of_the_schema(root: ET.Element) -> None:
    met = set()
    for element in root.iter():
        if (order := ORDER.get(_name(element))) is not None:
            places = [order.index(_name(child)) for child in element]
            assert places == sorted(places)
            met.add(_name(element))
    assert met == set(ORDER)
    assert root.get("schemaVersion") == "3.3.0"


def test_curves_have_their_numbers_and_expanded_uncertainties(root: ET.Element) -> None:
    curve = five_axis_summary(12).curves[3]
    results = root.findall(f".//{{{DCC}}}result")
    (mine,) = [each for each in results if each.findtext(f"{{{DCC}}}name/{{{DCC}}}content", "").startswith(curve.name)]
    series = mine.findall(f".//{{{SI}}}realListXMLList")
    position, value = ([float(x) for x in each.findtext(f"{{{SI}}}valueXMLList", "").split()] for each in series)
    half = [float(x) for x in series[1].findtext(f".//{{{SI}}}valueExpandedMUXMLList", "").split()]
    np.testing.assert_allclose(position, curve.position, rtol=1e-5, atol=1e-9)
    np.testing.assert_allclose(value, curve.mean, rtol=1e-5)
    np.testing.assert_allclose(half, 1.96 * np.array(curve.std), rtol=1e-5)


_PLUS = r"\+?((\d*\.\d+)|(\d+\.\d*)|(\d+\.?))([Ee][-+]?\d+)?"
PATTERNS = {
    "value": r"[-+]?" + _PLUS[3:],
    "valueExpandedMU": _PLUS,
    "coverageFactor": r"\+?(([1-9]\d*\.\d*)|([1-9]\d*))",
    "coverageProbability": r"\+?((0(\.\d*)?)|(1(\.0*)?))",
}
"""How D-SI 2.2 writes numbers, alone and in lists, without NaN."""


def test_rows_have_the_figures_of_the_answer(root: ET.Element) -> None:
    given = {
        each.findtext(f"{{{DCC}}}name/{{{DCC}}}content", ""): each.findtext(f"{{{SI}}}real/{{{SI}}}value", "")
        for each in root.findall(f".//{{{DCC}}}quantity")
    }
    rows = [row for row in five_axis_summary(12).answer.rows if row.measured]
    assert rows
    for row in rows:
        named = {"as found": row.found, "U, 95%": row.known_to}
        named |= {f"as left with {name}": size for name, size in row.left.items()}
        for name, size in named.items():
            assert float(given[f"{row.row}, {name}"]) == pytest.approx(size, rel=1e-5)


def test_numbers_are_written_as_the_schema_wants_them(root: ET.Element) -> None:
    met = set()
    for element in root.iter():
        name = _name(element).removesuffix("XMLList")
        if element.tag.startswith(f"{{{SI}}}") and name in PATTERNS:
            met.add(name)
            assert all(re.fullmatch(PATTERNS[name], each) for each in (element.text or "").split())
            assert element.text
    assert met == set(PATTERNS)


def test_any_text_makes_a_certificate_that_parses() -> None:
    text = certificate(_with_every_text(five_axis_summary(2), HOSTILE + "\ud800\x07"))
    assert "alert(1)" in "".join(ET.fromstring(text).itertext())


def test_all_numbers_of_a_reading_are_in_its_row() -> None:
    summary = five_axis_summary(3)
    last = replace(summary.history[-1], others=(0.25, -3.5), columns=["value_x_um", "value_y_um", "value_z_um"])
    shown = replace(summary, history=[*summary.history[:-1], last])
    rows = list(csv.DictReader(io.StringIO(readings_csv(shown).decode())))
    assert [(row["value_y_um"], row["value_z_um"]) for row in rows] == [("", ""), ("", ""), ("0.25", "-3.5")]
    assert b"value_y_um" not in readings_csv(summary)
    assert result_json(shown)["history"][-1]["others"] == [0.25, -3.5]
    assert values_text(last.values, *last.units).endswith(" / 0.25 / \N{MINUS SIGN}3.50\N{NO-BREAK SPACE}µm")
    turned = replace(last, columns=["value_x_um", "value_y_um", "value_a_urad"])
    assert values_text(turned.values, *turned.units).endswith(
        "µm / 0.25\N{NO-BREAK SPACE}µm / \N{MINUS SIGN}3.50\N{NO-BREAK SPACE}µrad"
    )


def test_a_name_that_a_spreadsheet_would_compute_is_shielded() -> None:
    assert b"'=1+1" in readings_csv(_with_every_text(five_axis_summary(2), "=1+1"))


def test_the_file_of_readings_is_read_as_it_is_written(tmp_path: Path) -> None:
    """Each reading comes back with its own std and time, without those that were not used."""
    summary = five_axis_summary(12)
    first, *rows = summary.history
    rows = [replace(row, std=0.25, time=60.0 * row.reading) for row in rows]
    rows[4] = replace(rows[4], reason="far away")
    rows[7] = replace(rows[7], others=(0.25, -3.5), columns=["value_x_um", "value_y_um", "value_z_um"])
    path = tmp_path / "readings.csv"
    path.write_bytes(readings_csv(replace(summary, history=[first, *rows])))
    found = read_any(path)
    assert [raw.number for raw in found] == [row.reading for row in rows if not row.rejected]
    assert [raw.setup for raw in found] == [row.setup for row in rows if not row.rejected]
    assert [1e6 * raw.value for raw in found] == pytest.approx([row.value_um for row in rows if not row.rejected], 1e-5)
    assert [raw.std for raw in found] == pytest.approx([0.25e-6] * 11)
    assert [raw.time for raw in found] == [60.0 * (raw.number - 1) for raw in found if raw.number]
    assert found[6].others == pytest.approx((0.25e-6, -3.5e-6))
    path.write_text(re.sub(",yes,", ",no,", path.read_text()))
    with pytest.raises(ReadingError, match="no reading of this file was used"):
        read_any(path)
