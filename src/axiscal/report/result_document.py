"""`result.json`: what a summary says, as the document `axiscal-result/1`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from axiscal.accuracy.expanded import LEVEL
from axiscal.report.answer import AnswerLine, AnswerRow
from axiscal.report.digits import coordinate, number, numbers
from axiscal.report.plane_summary import plane_json
from axiscal.report.promises import Linear, ReadingAgreement
from axiscal.report.summary import (
    BudgetRow,
    ConstantSummary,
    CurveSummary,
    HistoryRow,
    Position,
    Rejection,
    Summary,
    TableOffer,
)
from axiscal.report.volume_error import VolumeError


def result_json(summary: Summary) -> dict[str, Any]:
    """Return the document `axiscal-result/1`; raises SummaryError for a number that is not finite."""
    return {
        "schema": "axiscal-result/1",
        "machine": summary.machine,
        "readings": summary.readings,
        "minutes": number(summary.minutes, "minutes"),
        "stopped_because": summary.stopped_because,
        "agreement": _agreement(summary.agreement),
        **_expanded(summary),
        "unseen_rms_um": number(summary.unseen_rms_um, "unseen_rms_um"),
        "budget": [_source(row) for row in summary.budget],
        **_linear(summary.linear),
        **_targets(summary),
        "history": [_history(row) for row in summary.history],
        "errors": {curve.name: _curve(curve) for curve in (*summary.curves, *summary.reversals)},
        "plane_errors": {plane.name: plane_json(plane) for plane in summary.planes},
        "volume": None if summary.volume is None else _volume(summary.volume),
        "constants": {constant.name: _constant(constant) for constant in summary.constants},
        "observability": list(summary.observability),
        "rejected": [_rejection(rejection) for rejection in summary.rejected],
        "warnings": [{"code": w.code, "error": w.error, "text": w.text} for w in summary.warnings],
        "rows": [] if summary.answer is None or summary.withheld else [_row(row) for row in summary.answer.rows],
        "tables": [_table(offer, summary) for offer in summary.tables],
        "versions": dict(sorted(summary.versions.items())),
        **({"record": {"event": summary.record.event, "hash": summary.record.hash}} if summary.record else {}),
    }


def _optional(value: float | None, what: str) -> float | None:
    return None if value is None else number(value, what)


def _position(position: Position | None) -> dict[str, float] | None:
    if position is None:
        return None
    return {axis: coordinate(value, f"position of {axis}") for axis, value in position.items()}


def _volume(volume: VolumeError) -> dict[str, Any]:
    def vectors(rows: Sequence[tuple[float, float, float]], what: str) -> list[list[float]]:
        return [numbers(row, f"{what} of the volume") for row in rows]

    return {
        "axes": list(volume.axes),
        "parked": volume.parked,
        "tcp_mm": vectors(volume.tcp_mm, "tcp_mm"),
        "found_um": vectors(volume.found_um, "found_um"),
        "half_um": vectors(volume.half_um, "half_um"),
        "left_um": vectors(volume.left_um, "left_um"),
        "controller": volume.controller,
    }


def _source(row: BudgetRow) -> dict[str, Any]:
    return {
        "source": row.words,
        "rms_um": number(row.rms_um, "rms_um of a source"),
        "share": number(row.share, "share"),
    }


def _targets(summary: Summary) -> dict[str, Any]:
    found: dict[str, Any] = {
        "target_rms_um": _optional(summary.target_rms_um, "target_rms_um"),
        "target_worst_um": _optional(summary.target_worst_um, "target_worst_um"),
        "target_U_um": _optional(summary.target_u_um, "target_U_um"),
        "target_reached": summary.target_reached,
    }
    if summary.truth is not None:
        found["promised_rms_um"] = number(summary.truth.promised_rms_um, "promised_rms_um")
        found["reached_rms_um"] = number(summary.truth.reached_rms_um, "reached_rms_um")
    return found


def _agreement(found: ReadingAgreement) -> dict[str, Any]:
    return {
        "count": found.count,
        "agreeing": found.agreeing,
        "c2": number(found.c2, "c2"),
        "p": number(found.p, "p of the agreement"),
        "contradict": found.contradict,
        "explained": [
            {
                "mistake": each.mistake,
                "odds": number(each.odds, "odds of a mistake"),
                "setups": list(each.setups),
                "text": each.words,
            }
            for each in found.explained
        ],
        "text": found.words,
    }


def _linear(found: Linear | None) -> dict[str, Any]:
    if found is None:
        return {"linear_to_um": None, "nonlinearity": None}
    return {
        "linear_to_um": number(found.bound_um, "linear_to_um"),
        "nonlinearity": number(found.index, "nonlinearity"),
    }


def _expanded(summary: Summary) -> dict[str, Any]:
    if summary.withheld:
        return dict.fromkeys(("U_um", "U_axis_um", "U_worst_um", "U_level", "k", "U_holds_for", "rms_um", "worst_um"))
    found = summary.expanded
    x, y, z = numbers(found.axes, "U_axis_um", 3)
    return {
        "U_um": number(found.space, "U_um"),
        "U_axis_um": {"x": x, "y": y, "z": z},
        "U_worst_um": number(found.worst, "U_worst_um"),
        "U_level": LEVEL,
        "k": number(found.factor, "k"),
        "U_holds_for": found.conditions,
        "rms_um": number(summary.rms_um, "rms_um"),
        "worst_um": number(summary.worst_um, "worst_um"),
    }


def _history(row: HistoryRow) -> dict[str, Any]:
    return {
        "reading": row.reading,
        "setup": row.setup,
        "position": _position(row.position),
        "value": _optional(row.value_um, "value of a reading"),
        "others": numbers(row.others, "values of a reading"),
        "unit": None if row.value_um is None else row.unit,
        "rms_um": number(row.rms_um, "rms_um of the history"),
        "worst_um": number(row.worst_um, "worst_um of the history"),
        "minutes": number(row.minutes, "minutes of the history"),
        "rejected": row.rejected,
    }


def _curve(curve: CurveSummary) -> dict[str, Any]:
    size = len(curve.position)
    return {
        "axis": curve.axis,
        "position": numbers(curve.position, f"position of {curve.name}"),
        "mean": numbers(curve.mean, f"mean of {curve.name}", size),
        "std": numbers(curve.std, f"std of {curve.name}", size),
        "position_unit": curve.position_unit,
        "value_unit": curve.value_unit,
        "std_seen": numbers(curve.std_seen, f"std_seen of {curve.name}", size),
        "prior_std": numbers(curve.prior_std, f"prior_std of {curve.name}", size),
        "from_readings": number(curve.from_readings, f"from_readings of {curve.name}"),
    }


def _constant(constant: ConstantSummary) -> dict[str, Any]:
    return {
        "mean": number(constant.mean, f"mean of {constant.name}"),
        "std": number(constant.std, f"std of {constant.name}"),
        "unit": constant.unit,
        "prior_std": number(constant.prior_std, f"prior_std of {constant.name}"),
        "seen": constant.seen,
    }


def _row(row: AnswerRow) -> dict[str, Any]:
    return {
        "row": row.name,
        "unit": row.unit,
        "found": number(row.found, "found of a row"),
        "largest": number(row.largest, "largest of a row"),
        "known_to": number(row.known, "known_to of a row"),
        "known_before": number(row.before, "known_before of a row"),
        "floor": number(row.floor, "floor of a row"),
        "left": {control: number(value, "left of a row") for control, value in row.left.items()},
        "limit": _optional(row.limit, "limit of a row"),
        "reached": row.reached,
        "measured": row.measured,
        "one_more": _optional(row.then, "one_more of a row"),
        "lines": [_line(line) for line in row.lines],
    }


def _line(line: AnswerLine) -> dict[str, Any]:
    ends = (line.low, line.high)
    return {
        "setup": line.setup,
        "axis": line.axis,
        "ends": [coordinate(end, f"end along {line.axis}") for end in ends],
        "at": _position(line.at),
        "places": {"+": line.plus, "-": line.minus, "both": line.both},
    }


def _table(offer: TableOffer, summary: Summary) -> dict[str, Any]:
    found, factor = offer.effect, summary.expanded.factor
    return {
        "controller": offer.controller,
        "file": offer.file if found is not None else None,
        "axis": offer.axis,
        "before_um": None if found is None else number(found.before, "before_um of a table"),
        "after_um": None if found is None else number(found.after, "after_um of a table"),
        "expected_um": None if found is None else number(found.expected, "expected_um of a table"),
        "U_um": None if found is None or summary.withheld else number(factor * found.expected, "U_um of a table"),
        "left_out": offer.left_out,
    }


def _rejection(rejection: Rejection) -> dict[str, Any]:
    return {
        "reading": rejection.reading,
        "setup": rejection.setup,
        "position": _position(rejection.position),
        "value": number(rejection.value_um, "value of a rejected reading"),
        "unit": rejection.unit,
        "reason": rejection.reason,
    }
