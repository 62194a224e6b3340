"""What a campaign found, as plain data in display units: the only thing the report and `result.json` are made from.

Positions in mm and deg; deviations in um, urad or arcsec (the unit stands beside the value); time in minutes.
Every `std`, `rms` and `worst` is one standard deviation; `expanded` and the bands that the report draws hold 95 %.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from axiscal.accuracy.expanded import LEVEL
from axiscal.estimation.ruling import VerdictWord
from axiscal.planning.vouched import Vouched
from axiscal.report.digits import number, numbers
from axiscal.report.plane_summary import PlaneSummary, plane_json
from axiscal.report.promises import CheckReadings, Uncertainty

Position = Mapping[str, float]
"""Axis name to coordinate, mm or deg."""


@dataclass(frozen=True, slots=True)
class SetupUse:
    """A set-up, and how many readings were taken in it; `direction`, `noise` are text such as "x" and "0.3 um"."""

    name: str
    instrument: str
    direction: str
    moves: Sequence[str]
    noise: str
    readings: int


@dataclass(frozen=True, slots=True)
class HistoryRow:
    """One reading and the accuracy after it; reading 0 is the prior and has no position, value or innovation.

    unit : of `value_um`, `innovation`, `innovation_std`: "um" except for angle readings
    tcp_mm : nominal TCP in the workpiece frame, for the picture of where it was measured
    traditional_rms_um : RMS that the traditional plan has after as many readings, if it was computed
    """

    reading: int
    setup: str | None
    position: Position | None
    value_um: float | None
    innovation: float | None
    innovation_std: float | None
    rms_um: float
    worst_um: float
    minutes: float
    rejected: bool = False
    traditional_rms_um: float | None = None
    unit: str = "um"
    tcp_mm: tuple[float, float, float] | None = None
    approach: str = ""


@dataclass(frozen=True, slots=True)
class CurvePoint:
    """A reading as one curve sees it: its value minus what the rest of the model says, and the std of that."""

    position: float
    value: float
    std: float
    setup: str
    reading: int | None = None
    rejected: bool = False


@dataclass(frozen=True, slots=True)
class CurveSummary:
    """One error function over its axis; all sequences have the length of `position`.

    std : whole standard deviation, unmodelled rest and unseen part included
    std_seen : what the readings leave over, without the part that no allowed reading can see
    prior_std : before any reading
    truth : positions and values, where the truth is known
    from_readings : share of the prior variance that the readings have taken away, 0 to 1; the rest is the prior
    """

    name: str
    axis: str
    caption: str
    position: Sequence[float]
    mean: Sequence[float]
    std: Sequence[float]
    std_seen: Sequence[float]
    prior_std: Sequence[float]
    position_unit: str
    value_unit: str
    truth: tuple[Sequence[float], Sequence[float]] | None = None
    points: Sequence[CurvePoint] = ()
    from_readings: float = 0.0


@dataclass(frozen=True, slots=True)
class ConstantSummary:
    """A location error, a constant reversal or a set-up's unknown; `seen`: an allowed reading bears on it."""

    name: str
    words: str
    mean: float
    std: float
    prior_std: float
    unit: str
    seen: bool = True
    truth: float | None = None


@dataclass(frozen=True, slots=True)
class Finding:
    """A warning: `code` is one of lack-of-fit aliasing prior-misfit drift outlier unobservable."""

    code: str
    error: str | None
    text: str


@dataclass(frozen=True, slots=True)
class Rejection:
    """A reading that was not believed, and why."""

    reading: int
    setup: str
    position: Position
    value_um: float
    reason: str
    unit: str = "um"


@dataclass(frozen=True, slots=True)
class TableOffer:
    """A compensation file, and what it leaves uncorrected in words (empty: nothing).

    effect : of all files of the control together; None where none is written
    """

    file: str
    controller: str
    axis: str
    left_out: str = ""
    effect: TableEffect | None = None


@dataclass(frozen=True, slots=True)
class TableEffect:
    """What the files of one control do to the tool point over the volume, RMS, um.

    before, after : of the deviation as estimated; expected : with what is not known, a standard uncertainty
    """

    before: float
    after: float
    expected: float


@dataclass(frozen=True, slots=True)
class TruthCheck:
    """RMS promised by the estimate against RMS reached, where the truth is known."""

    promised_rms_um: float
    reached_rms_um: float
    before_rms_um: float | None = None


@dataclass(frozen=True, slots=True)
class Iso230:
    """ISO 230-2 figures of one axis: per target the mean and std of each direction, and A, E, R, B, M by name.

    uncertainties : expanded (k = 2), for the figures whose uncertainty is known
    """

    axis: str
    position_unit: str
    value_unit: str
    target: Sequence[float]
    mean_up: Sequence[float]
    std_up: Sequence[float]
    mean_down: Sequence[float]
    std_down: Sequence[float]
    figures: Mapping[str, float]
    uncertainties: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class ResidualCheck:
    """Chi-square of the readings against what was predicted; `probability` of a value at least as large."""

    chi_square: float
    degrees: int
    probability: float


@dataclass(frozen=True, slots=True)
class RecordState:
    """What all figures come from: a record's file, the number of its last event, the hash up to there."""

    file: str
    event: int
    hash: str


@dataclass(frozen=True, slots=True)
class Summary:
    """Everything the report shows."""

    title: str
    machine: str
    chain: str
    campaign_file: str
    date: str
    setups: Sequence[SetupUse]
    stopped_because: str
    readings: int
    minutes: float
    rms_um: float
    worst_um: float
    unseen_rms_um: float
    history: Sequence[HistoryRow]
    expanded: Uncertainty
    vouched: Vouched
    curves: Sequence[CurveSummary] = ()
    reversals: Sequence[CurveSummary] = ()
    constants: Sequence[ConstantSummary] = ()
    planes: Sequence[PlaneSummary] = ()
    observability: Sequence[str] = ()
    questions: Sequence[str] = ()
    rejected: Sequence[Rejection] = ()
    warnings: Sequence[Finding] = ()
    tables: Sequence[TableOffer] = ()
    target_rms_um: float | None = None
    target_worst_um: float | None = None
    target_u_um: float | None = None
    truth: TruthCheck | None = None
    iso230: Sequence[Iso230] = ()
    reading_residual: ResidualCheck | None = None
    versions: Mapping[str, str] = field(default_factory=dict)
    files: Sequence[str] = ()
    record: RecordState | None = None
    verdict: VerdictWord = "holds"
    verdict_words: str = ""
    checks: CheckReadings | None = None

    @property
    def withheld(self) -> bool:
        """Whether no accuracy is promised."""
        return self.verdict == "contradicted"


def result_json(summary: Summary) -> dict[str, Any]:
    """Return the document `axiscal-result/1`; raises SummaryError for a number that is not finite."""
    return {
        "schema": "axiscal-result/1",
        "machine": summary.machine,
        "readings": summary.readings,
        "minutes": number(summary.minutes, "minutes"),
        "stopped_because": summary.stopped_because,
        "verdict": summary.verdict,
        "verdict_words": summary.verdict_words,
        **_expanded(summary),
        "checks": _checks(summary.checks),
        "rms_um": number(summary.rms_um, "rms_um"),
        "worst_um": number(summary.worst_um, "worst_um"),
        "unseen_rms_um": number(summary.unseen_rms_um, "unseen_rms_um"),
        "defended_um": number(summary.vouched.defended, "defended_um"),
        "departures": [dict(row) for row in summary.vouched.departures],
        **_targets(summary),
        "history": [_history(row) for row in summary.history],
        "errors": {curve.name: _curve(curve) for curve in (*summary.curves, *summary.reversals)},
        "plane_errors": {plane.name: plane_json(plane) for plane in summary.planes},
        "constants": {constant.name: _constant(constant) for constant in summary.constants},
        "observability": list(summary.observability),
        "rejected": [_rejection(rejection) for rejection in summary.rejected],
        "warnings": [{"code": w.code, "error": w.error, "text": w.text} for w in summary.warnings],
        "tables": [_table(offer, summary) for offer in summary.tables],
        "versions": dict(sorted(summary.versions.items())),
        **({"record": {"event": summary.record.event, "hash": summary.record.hash}} if summary.record else {}),
    }


def _optional(value: float | None, what: str) -> float | None:
    return None if value is None else number(value, what)


def _position(position: Position | None) -> dict[str, float] | None:
    return (
        None if position is None else {axis: number(value, f"position of {axis}") for axis, value in position.items()}
    )


def _targets(summary: Summary) -> dict[str, Any]:
    found: dict[str, Any] = {
        "target_rms_um": _optional(summary.target_rms_um, "target_rms_um"),
        "target_worst_um": _optional(summary.target_worst_um, "target_worst_um"),
        "target_U_um": _optional(summary.target_u_um, "target_U_um"),
    }
    if summary.truth is not None:
        found["promised_rms_um"] = number(summary.truth.promised_rms_um, "promised_rms_um")
        found["reached_rms_um"] = number(summary.truth.reached_rms_um, "reached_rms_um")
    return found


def _checks(found: CheckReadings | None) -> dict[str, Any] | None:
    if found is None:
        return None
    names = ("promised_um", "found_um", "low", "high")
    return {"count": found.count, **{name: number(getattr(found, name), f"{name} of checks") for name in names}}


def _expanded(summary: Summary) -> dict[str, Any]:
    if summary.withheld:
        return dict.fromkeys(("U_um", "U_axis_um", "U_worst_um", "U_level", "k", "U_holds_for"))
    found = summary.expanded
    x, y, z = numbers(found.axes, "U_axis_um", 3)
    return {
        "U_um": number(found.space, "U_um"),
        "U_axis_um": {"x": x, "y": y, "z": z},
        "U_worst_um": number(found.worst, "U_worst_um"),
        "U_level": LEVEL,
        "k": number(found.factor, "k"),
        "U_holds_for": found.conditions,
    }


def _history(row: HistoryRow) -> dict[str, Any]:
    return {
        "reading": row.reading,
        "setup": row.setup,
        "position": _position(row.position),
        "value": _optional(row.value_um, "value of a reading"),
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
