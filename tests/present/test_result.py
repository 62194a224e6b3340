"""`result.json` against the contract."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.exceptions import SummaryError
from axiscal.present.result import ConstantFigures, HistoryRow, Result
from tests.generators.results import golden_result

AGREED = {
    "": "schema machine readings minutes stopped_because rms_um worst_um U_um U_axis_um k unseen_rms_um history errors "
    "constants plane_errors observability rejected warnings versions tables rows agreement checks budget identity",
    "history": "reading setup position approach value unit others rms_um worst_um minutes rejected",
    "errors": "axis position mean std position_unit value_unit std_seen prior_std",
    "constants": "mean std unit prior_std",
    "warnings": "code error text",
    "rejected": "reading setup position value unit reason",
    "rows": "row found known_to left limit reached measured signed",
    "agreement": "count agreeing c2 p contradict explained text",
    "checks": "count as_promised s each",
    "tables": "controller file axis before_um after_um expected_um U_um left_out",
}
"""Names that programs of others read."""


def _document(result: Result) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(result.model_dump_json(by_alias=True))
    return found


@pytest.mark.parametrize("where", AGREED)
def test_what_others_read_stays(where: str) -> None:
    found: Any = _document(golden_result("densities/out"))
    found = found[where] if where else found
    if where in ("errors", "constants"):
        found = next(iter(found.values()))
    found = found[-1] if isinstance(found, list) else found
    assert set(AGREED[where].split()) <= set(found)


def test_a_document_that_was_written_can_be_read_again() -> None:
    result = golden_result("mill/out")
    assert _document(Result.model_validate_json(result.model_dump_json(by_alias=True))) == _document(result)


def test_numbers_keep_six_digits_zero_has_no_sign_and_positions_keep_all() -> None:
    figures = ConstantFigures(words="", mean=1.23456789, std=-0.0, unit="um", prior_std=2.5)
    assert figures.model_dump_json(include={"mean", "std"}) == '{"mean":1.23457,"std":0.0}'
    stood = {"X": 120.123456789, "C": -179.123456789}
    row = HistoryRow(reading=1, position=stood, rms_um=1.0, worst_um=1.0, minutes=1.0)
    assert row.model_dump(mode="json")["position"] == stood


@given(st.sampled_from(["minutes", "rms_um", "worst_um", "unseen_rms_um"]), st.sampled_from(["nan", "inf", "-inf"]))
def test_what_is_not_a_number_never_leaves(field: str, value: str) -> None:
    with pytest.raises(SummaryError, match=field):
        golden_result("one_spline/from-a-file", **{field: float(value)})
