"""Files of people, on which the program failed: each command of theirs answers what is known to be right."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.zoo.answers import Answer
from benchmarks.zoo.running import given
from tests.generators.field import FIELD

FOLDER = FIELD / "01-lead-error-eaten"
BESIDE = pytest.mark.skipif(not FIELD.is_dir(), reason="needs the files of the field beside the checkout")


@BESIDE
@pytest.mark.parametrize(
    ("campaign", "readings", "slope"),
    [
        ("lb", "iso20", 0.02),
        *(pytest.param("asread", *each, marks=pytest.mark.long) for each in (("iso60", 0.06), ("S11", 0.02))),
    ],
)
def test_a_straight_line_that_was_read_is_in_the_table(
    tmp_path: Path, campaign: str, readings: str, slope: float
) -> None:
    estimated = given("data", "estimate", FOLDER / f"{campaign}.toml", FOLDER / f"{readings}.csv", "--out", tmp_path)
    assert estimated.status == 0, estimated
    answer = Answer(tmp_path, estimated)
    where, values = answer.axis_table("X")
    left = slope * where - values.mean(axis=0)
    assert np.polyfit(where, values.mean(axis=0), 1)[0] >= 0.98 * slope
    assert np.quantile(np.abs(left - left.mean()), 0.95) <= answer.expanded_with_tables()


def estimated(campaign: Path, readings: str, out: Path) -> Answer:
    """Return the answer to `data estimate` of a file."""
    outcome = given("data", "estimate", campaign, readings, "--out", out)
    assert outcome.status == 0, outcome
    return Answer(out, outcome)


@BESIDE
def test_an_angular_test_is_one(tmp_path: Path) -> None:
    folder = FIELD / "02-angular-rtl"
    linear, angular = (given("data", "iso230", folder / name) for name in ("a.rtl", "b.rta"))
    assert "a.rtl: a positioning test (.rtl), 36 readings" in linear.err
    assert "b.rta: an angular test (.rta), 36 readings" in angular.err
    document = given("data", "iso230", folder / "b.rta", "--json").document
    assert (document["unit"], document["target_unit"]) == ("arcsec", "mm")
    assert document["E"] == pytest.approx(206.26 * ((0.0461 + 0.0465) / 2 + (0.0094 + 0.0102) / 2), abs=0.001)
    assert "um" not in angular.printed
    assert "arcsec" not in linear.printed
    other = given("data", "estimate", folder / "campaign.toml", folder / "b.rta", "--out", tmp_path / "none")
    other.refused("an angular test needs a set-up that moves one linear axis and reads an angle")
    text = (folder / "campaign.toml").read_text().replace("interferometer", "autocollimator").replace('"x"', '"y"')
    (tmp_path / "pitch.toml").write_text(text)
    answer = estimated(tmp_path / "pitch.toml", str(folder / "b.rta"), tmp_path / "out")
    assert "an angular test (.rta), 36 readings, for set-up laser along X" in answer.text
    assert answer.result["history"][2]["value"] == pytest.approx(5.1)


@BESIDE
@pytest.mark.parametrize("name", ["base.csv", "de.csv", "de_bom.csv", "apos.csv", "fwd.csv", "wide.csv"])
def test_spreadsheets_of_the_field_are_one_test(name: str) -> None:
    found = given("data", "iso230", FIELD / "17-spreadsheet-csv" / name, "--json")
    assert found.document["A"] == pytest.approx(11.0 if name == "wide.csv" else 11.221, abs=5e-4)
    assert ("in mm and um (it names no unit)" in found.err) is (name == "wide.csv")
