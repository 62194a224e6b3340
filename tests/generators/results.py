"""A result such as a five-axis campaign has, a bare one, and one whose every text is an attack."""

from typing import Any

import numpy as np

from axiscal.answers.answer import NextStep, Outcome
from axiscal.answers.answer_words import answer_text
from axiscal.answers.row_words import row_names
from axiscal.description.target import rows_of
from axiscal.errors.iso230 import words
from axiscal.machine import load_machine
from axiscal.present.result import (
    AgreementFigures,
    ChecksFigures,
    ConstantFigures,
    CurveFigures,
    Finding,
    HistoryRow,
    Iso230Figures,
    ReadPoints,
    RecordState,
    RejectedReading,
    Result,
    ResultWords,
    SetupUse,
    TableFile,
)
from tests.generators.answers import aim, answer, answer_row

TRAVEL = {"C": (0.0, 360.0), "B": (-30.0, 110.0), "Y": (0.0, 500.0), "X": (0.0, 600.0), "Z": (0.0, 500.0)}
HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\"'`&{{ 7*7 }}\u2028javascript:alert(3)"
CONTRADICT = "The readings contradict each other (p = 1e-09)"
AT_ODDS = AgreementFigures(count=24, agreeing=11, c2=80.0, p=1e-9, contradict=True, text=CONTRADICT)


def bare(**changes: Any) -> Result:
    """Return the result of a campaign without readings, with changes."""
    first = HistoryRow(reading=0, rms_um=14.2, worst_um=31.0, minutes=0.0)
    known = {"U_um": 23.4, "U_axis_um": {"x": 11.0, "y": 12.0, "z": 13.0}, "U_worst_um": 46.8, "U_level": 0.95}
    known |= {"k": 1.65, "U_holds_for": "for a tool of 120 mm", "U_along": "xyz", "rms_um": 14.2, "worst_um": 31.0}
    found = changes.pop("answer", None) or answer(verdict="nothing", readings=0, compared=0, minutes=0.0)
    told = answer_text(found, changes["agreement"].text if "agreement" in changes else "")
    names = {row.row: row_names([row]) for row in found.rows}
    usual = {
        "identity": {"campaign_file": "c.toml", "begun": "2026-03-14"},
        "words": ResultWords(**dict(told), names=names),
        "machine": "m",
        "readings": 0,
        "minutes": 0.0,
        "stopped_because": "nothing measured",
        "agreement": AgreementFigures(count=0, agreeing=0, c2=1.0, p=1.0, contradict=False, text=""),
        "checks": ChecksFigures(),
        "history": [first],
        "answer": found,
        "rows": found.rows,
        "record": RecordState(file="c.axiscal", event=1, hash=64 * "0"),
        **dict.fromkeys(("unseen_rms_um", "budget_smaller_um"), 0.0),
        **dict.fromkeys(("nonlinearity", "target_rms_um", "target_worst_um", "target_U_um")),
        **{name: {} for name in ("errors", "plane_errors", "constants", "versions", "inputs")},
        **{name: [] for name in ("setups", "budget", "iso230", "observability", "questions", "rejected", "warnings")},
        "tables": [],
        "target_reached": None,
        "volume": None,
    }
    return Result(**(usual | (dict.fromkeys(known) if found.withheld else known) | changes))


def curve(mean: list[float], std: float, axis: str = "X", unit: str = "um") -> CurveFigures:
    """Return an error over its axis."""
    return CurveFigures(
        axis=axis,
        words=words(f"EX{axis}"),
        position=[float(n) for n in range(len(mean))],
        mean=mean,
        **{name: [std] * len(mean) for name in ("std", "std_seen", "prior_std")},
        position_unit="deg" if axis in "BC" else "mm",
        value_unit=unit,
        from_readings=0.0,
        read=ReadPoints(position=[0.0], value=[0.0]),
    )


def _errors(rng: np.random.Generator) -> dict[str, CurveFigures]:
    """Return thirty smooth curves."""
    found = {}
    for axis in TRAVEL:
        for way in "XYZABC":
            wave = 8 * np.sin(np.linspace(0, rng.uniform(3, 12), 61) + rng.uniform(0, 6))
            found[f"E{way}{axis}"] = curve(wave.tolist(), 1.5, axis, "urad" if way in "ABC" else "um")
    return found


def constant(name: str, mean: float, std: float, unit: str) -> ConstantFigures:
    """Return a constant."""
    return ConstantFigures(words=words(name), mean=mean, std=std, prior_std=20.0, unit=unit)


def _setup(name: str, instrument: str, along: str, moves: str, noise: str) -> SetupUse:
    return SetupUse(name=name, instrument=instrument, along=along, moves=moves.split(), noise=noise, readings=15)


def row_read(number: int, **changes: Any) -> HistoryRow:
    """Return a row of the history: a reading in X."""
    read = {"setup": "laser", "position": {"X": 120.0}, "approach": "X+", "unit": "um", "units": ["um"], "value": 1.5}
    known = {"rms_um": 14.2, "worst_um": 31.0, "minutes": 0.7 * number, "innovation": 0.1, "surprise": 0.2}
    return HistoryRow(**({"reading": number, **read, **known} | changes))


def _history(rng: np.random.Generator, readings: int) -> list[HistoryRow]:
    rows = [HistoryRow(reading=0, rms_um=14.2, worst_um=31.0, minutes=0.0)]
    for n in range(1, readings + 1):
        at = {axis: round(float(rng.uniform(*span)), 1) for axis, span in TRAVEL.items()}
        odd = {"rejected": True, "surprise": 7.3} if n == 31 else {}
        name, value = f"set-up {n * 4 // (readings + 1) + 1}", float(rng.normal(0, 6))
        rows.append(row_read(n, setup=name, position=at, value=value, rms_um=1.75, **odd))
    return rows


def _answered(readings: int) -> Outcome:
    built = load_machine("dmu60")
    rows = [answer_row(row, built, row.kind != "backlash") for row in rows_of(built)]
    steps = [NextStep(code="load", control="linuxcnc"), NextStep(code="verify")]
    return answer(verdict="reached", readings=readings, rows=rows, aims=[aim("rms", 1.93, 2.0, 1.0)], steps=steps)


def five_axis_result(readings: int = 60, **changes: Any) -> Result:
    """Return a result such as a five-axis campaign with a known truth has, with changes."""
    rng = np.random.default_rng(7)
    places = dict.fromkeys(("A0B", "C0B", "A0C", "B0C", "C0Y", "B0Z", "A0Z"), "urad")
    places |= dict.fromkeys(("X0C", "Y0C", "X0B", "Z0B", "EXX_reversal", "EYY_reversal"), "um")
    constants = {name: constant(name, float(rng.normal(0, 12)), 2.0, unit) for name, unit in places.items()}
    figures = {"A": 11.2, "A_up": 9.8, "E": 10.0, "R": 4.2, "B": 2.0, "B_mean": 2.0, "M": 8.1}
    history = _history(rng, readings)
    odd = [
        RejectedReading(
            reading=row.reading, setup="laser", position={"X": 1.0}, value=1.5, unit="um", reason="7.3 too far"
        )
        for row in history
        if row.rejected
    ]
    effect = dict.fromkeys(("before_um", "after_um", "expected_um", "U_um"), 1.0)
    usual = {
        "machine": "Five-axis machine, 600 × 500 × 500",
        "identity": {"chain": "w-C'-B'-b-Y-X-Z-t", "campaign_file": "campaign.toml", "begun": "2026-03-14"},
        "setups": [
            _setup("set-up 1", "interferometer", "x", "X", "0.3 µm"),
            _setup("set-up 2", "straightedge", "y", "X Z", "0.5 µm"),
            _setup("set-up 3", "rtest", "x y z", "B C", "0.6 µm"),
            _setup("set-up 4", "level", "about x", "X Y", "1 µrad"),
        ],
        "stopped_because": "rms target reached",
        "readings": readings,
        "U_um": 3.3,
        "k": 1.7,
        "minutes": history[-1].minutes,
        "rms_um": history[-1].rms_um,
        "unseen_rms_um": 0.82,
        "history": history,
        "rejected": odd,
        "answer": _answered(readings),
        "errors": _errors(rng),
        "constants": constants,
        "observability": [
            "The constant part of EXX, EXY and EXZ cannot be told apart; a probe on a fixed ball would separate them."
        ],
        "warnings": [
            Finding(code="prior-misfit", error="EXX", text="EXX, size: 2.4 times as large as stated or usual.")
        ],
        "tables": [
            TableFile(controller="LinuxCNC", file="x.comp", axis="X", left_out="0.4 µm between its rows", **effect),
            TableFile(controller="any", file="curves.csv", axis="all", left_out=""),
        ],
        "target_rms_um": 2.0,
        "target_worst_um": 4.0,
        "iso230": [Iso230Figures(axis="X", unit="um", figures=figures, U={"A": 1.1, "E": 0.9, "R": 0.7})],
        "agreement": AgreementFigures(
            count=60, agreeing=59, c2=1.03, p=0.4, contradict=False, text="59 of 60 readings agree with the others"
        ),
        "versions": {"axiscal": "0.1.0", "numpy": "2.2.0"},
    }
    return bare(**(usual | changes))


def with_every_text(value: Any, text: str) -> Any:
    """Return value with every piece of text in it replaced, keys of tables that are names of somebody included."""
    if isinstance(value, str):
        return text
    if hasattr(value, "model_copy"):
        return value.model_copy(update={name: with_every_text(each, text) for name, each in value})
    if isinstance(value, dict):
        names = [name if name.islower() or name[0] == "U" else f"{text}{n}" for n, name in enumerate(value)]
        return {name: with_every_text(item, text) for name, item in zip(names, value.values(), strict=True)}
    if isinstance(value, list | tuple):
        return type(value)(with_every_text(item, text) for item in value)
    return value
