"""`result.json` against the contract."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.exceptions import SummaryError
from axiscal.present.result import Result
from tests.generators.results import bare, curve, five_axis_result, row_read

AGREED = {
    "": "schema machine readings minutes stopped_because rms_um worst_um U_um U_axis_um k unseen_rms_um history errors "
    "constants plane_errors observability rejected warnings versions tables rows agreement checks budget identity",
    "history": "reading setup position approach value unit others rms_um worst_um minutes rejected",
    "errors.EXX": "axis position mean std position_unit value_unit std_seen prior_std",
    "constants.C0Y": "mean std unit prior_std",
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
    found: Any = _document(five_axis_result())
    for name in filter(None, where.split(".")):
        found = found[name]
    assert set(AGREED[where].split()) <= set(found[0] if isinstance(found, list) else found)


def test_a_document_that_was_written_can_be_read_again() -> None:
    result = five_axis_result()
    assert _document(Result.model_validate_json(result.model_dump_json(by_alias=True))) == _document(result)


def test_numbers_keep_six_digits_zero_has_no_sign_and_positions_keep_all() -> None:
    error = _document(bare(errors={"EXX": curve([1.23456789, -0.0], 2.5)}))["errors"]["EXX"]
    assert json.dumps([error["mean"], error["std"]]) == "[[1.23457, 0.0], [2.5, 2.5]]"
    stood = {"X": 120.123456789, "C": -179.123456789}
    assert _document(bare(history=[row_read(1, position=stood)]))["history"][0]["position"] == stood


@given(st.sampled_from(["minutes", "rms_um", "worst_um", "unseen_rms_um"]), st.sampled_from(["nan", "inf", "-inf"]))
def test_what_is_not_a_number_never_leaves(field: str, value: str) -> None:
    with pytest.raises(SummaryError, match=field):
        bare(**{field: float(value)})
    with pytest.raises(SummaryError, match="mean"):
        curve([0.0, float(value)], 1.0)
