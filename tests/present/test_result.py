"""`result.json` against the contract."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.exceptions import SummaryError
from axiscal.present.result_document import result_json
from tests.generators.summaries import bare, written_error, written_row

CURVE = written_error([1.23456789, -0.0], 2.5) | {"position": [0.0, 1 / 3]}
READ = written_row(1, rejected=True, reason="too far off")
SUMMARY = bare(
    unseen_rms_um=0.5,
    history=[*bare().history, READ],
    errors={"EXX": CURVE, "EXX_reversal": CURVE},
)


def test_the_document_is_what_the_contract_says() -> None:
    document = result_json(SUMMARY)
    assert document["schema"] == "axiscal-result/1"
    assert set(document["errors"]) == {"EXX", "EXX_reversal"}
    assert document["errors"]["EXX"]["std"] == [2.5, 2.5]  # the whole standard deviation, not the part that is seen
    assert [row["position"] for row in document["history"]] == [None, {"X": 120.0}]
    assert document["unseen_rms_um"] == 0.5
    assert (document["U_um"], document["k"], document["U_axis_um"]) == (23.4, 1.65, {"x": 11.0, "y": 12.0, "z": 13.0})


def test_numbers_keep_six_digits_and_zero_has_no_sign() -> None:
    error = result_json(SUMMARY)["errors"]["EXX"]
    assert error["position"] == [0.0, 0.333333]
    assert json.dumps(error["mean"]) == "[1.23457, 0.0]"


def test_where_an_axis_stood_is_written_to_far_below_a_nanometre() -> None:
    stood = {"X": 120.12345678949, "C": -179.123456789}
    document = result_json(replace(SUMMARY, history=[written_row(1, position=stood)]))
    assert document["history"][0]["position"] == {"X": 120.123456789, "C": -179.123456789}
    with pytest.raises(SummaryError, match="position of X"):
        result_json(replace(SUMMARY, history=[written_row(1, position={"X": float("nan")})]))


@given(st.sampled_from(["minutes", "rms_um", "worst_um", "unseen_rms_um"]), st.sampled_from(["nan", "inf", "-inf"]))
def test_what_is_not_a_number_never_leaves(field: str, value: str) -> None:
    with pytest.raises(SummaryError, match=field):
        result_json(replace(SUMMARY, **{field: float(value)}))  # type: ignore[arg-type]
