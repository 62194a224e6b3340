"""A summary such as a five-axis campaign has, a bare one, and one whose every text is an attack."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

from axiscal.answers.answer import NextStep, ResultAnswer
from axiscal.description.target import rows_of
from axiscal.errors.iso230 import words
from axiscal.estimation.promise.agreement import Agreement
from axiscal.machine import load_machine
from axiscal.present.result_document import EFFECT
from axiscal.present.summary import (
    Finding,
    Summary,
    TableOffer,
    Written,
)
from tests.generators.answers import aim, answer, answer_row

TRAVEL = {"C": (0.0, 360.0), "B": (-30.0, 110.0), "Y": (0.0, 500.0), "X": (0.0, 600.0), "Z": (0.0, 500.0)}
HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\"'`&{{ 7*7 }}\u2028javascript:alert(3)"
CONTRADICT = "The readings contradict each other (p = 1e-09)"
AT_ODDS: dict[str, Any] = {"agreement": Agreement(24, 11, 80.0, 1e-9), "agreement_words": CONTRADICT}


def _expanded(size: float, k: float) -> Written:
    """Return expanded uncertainties and what they hold for as result.json has them."""
    sizes = {"U_um": size, "U_worst_um": 2 * size, "U_level": 0.95, "k": k}
    return {
        **sizes,
        "U_axis_um": {"x": 11.0, "y": 12.0, "z": 13.0},
        "U_holds_for": "for a tool of 120 mm",
        "U_along": "xyz",
    }


def bare(**changes: Any) -> Summary:
    first = written_row(0)
    figures = (
        0,
        0.0,
        14.2,
        31.0,
        0.0,
        [first],
        _expanded(23.4, 1.65),
        answer(verdict="nothing", readings=0, compared=0, minutes=0.0),
    )
    empty = Summary("m", "", "c.toml", "2026-03-14", [], "nothing measured", *figures)
    return replace(empty, **changes)


def written_error(mean: list[float], std: float, axis: str = "X", unit: str = "um") -> Written:
    """Return an error over its axis as result.json has it."""
    size = len(mean)
    places = {"axis": axis, "words": words(f"EX{axis}"), "position": [float(n) for n in range(size)], "mean": mean}
    bands = {name: [std] * size for name in ("std", "std_seen", "prior_std")}
    units = {"position_unit": "deg" if axis in "BC" else "mm", "value_unit": unit}
    return {**places, **bands, **units, "from_readings": 0.0, "read": {"position": [0.0], "value": [0.0]}}


def _errors(rng: np.random.Generator) -> dict[str, Written]:
    """Return thirty smooth curves."""
    found = {}
    for axis in TRAVEL:
        for way in "XYZABC":
            wave = 8 * np.sin(np.linspace(0, rng.uniform(3, 12), 61) + rng.uniform(0, 6))
            found[f"E{way}{axis}"] = written_error(wave.tolist(), 1.5, axis, "urad" if way in "ABC" else "um")
    return found


def written_constant(name: str, mean: float, std: float, unit: str) -> Written:
    """Return a constant as result.json has it."""
    return {"words": words(name), "mean": mean, "std": std, "prior_std": 20.0, "unit": unit, "seen": True}


def _setup(name: str, instrument: str, along: str, moves: str, noise: str) -> Written:
    mounted = {"name": name, "instrument": instrument, "along": along, "moves": moves.split()}
    return {**mounted, "noise": noise, "readings": 15}


def written_row(number: int, **changes: Any) -> Written:
    """Return a row of the history: a reading in X, and as number 0 the prior."""
    known = {"rms_um": 14.2, "worst_um": 31.0, "minutes": 0.7 * number, "rejected": False, "approach": "", "by": ""}
    blank = dict.fromkeys(("setup", "position", "value", "unit", "innovation", "surprise", "std", "time"))
    row = {"reading": number, **blank, **known, "others": (), "units": (), "columns": (), "check": False}
    read: Written = {"setup": "laser", "unit": "um", "units": ("um",), "columns": ("value_um",), "approach": "X+"}
    read |= {"position": {"X": 120.0}, "value": 1.5, "innovation": 0.1, "surprise": 0.2}
    return row | (read if number else {}) | changes


def _history(rng: np.random.Generator, readings: int) -> list[Written]:
    rows = [written_row(0)]
    for n in range(1, readings + 1):
        position = {axis: round(float(rng.uniform(*span)), 1) for axis, span in TRAVEL.items()}
        row = written_row(n, setup=f"set-up {n * 4 // (readings + 1) + 1}", position=position)
        odd = {"rejected": True, "reason": "7.3 standard deviations from what was expected.", "surprise": 7.3}
        rows.append(row | {"value": float(rng.normal(0, 6)), "rms_um": 1.75} | (odd if n == 31 else {}))
    return rows


def _answered(readings: int) -> ResultAnswer:
    built = load_machine("dmu60")
    rows = [answer_row(row, built, row.kind != "backlash") for row in rows_of(built)]
    steps = [NextStep(code="load", control="linuxcnc"), NextStep(code="verify")]
    return answer(verdict="reached", readings=readings, rows=rows, aims=[aim("rms", 1.93, 2.0, 1.0)], steps=steps)


def five_axis_summary(readings: int = 60) -> Summary:
    """Return a summary such as a five-axis campaign with a known truth produces."""
    rng = np.random.default_rng(7)
    places = dict.fromkeys(("A0B", "C0B", "A0C", "B0C", "C0Y", "B0Z", "A0Z"), "urad")
    places |= dict.fromkeys(("X0C", "Y0C", "X0B", "Z0B", "EXX_reversal", "EYY_reversal"), "um")
    constants = {name: written_constant(name, float(rng.normal(0, 12)), 2.0, unit) for name, unit in places.items()}
    block = {
        "axis": "X",
        "unit": "um",
        "figures": {"A": 11.2, "A_up": 9.8, "E": 10.0, "R": 4.2, "B": 2.0, "B_mean": 2.0, "M": 8.1},
        "U": {"A": 1.1, "E": 0.9, "R": 0.7, "B": 0.4, "M": 0.6},
        "left_out": [],
    }
    history = _history(rng, readings)
    return Summary(
        machine="Five-axis machine, 600 × 500 × 500",
        chain="w-C'-B'-b-Y-X-Z-t",
        campaign_file="campaign.toml",
        date="2026-03-14",
        setups=[
            _setup("set-up 1", "interferometer", "x", "X", "0.3 µm"),
            _setup("set-up 2", "straightedge", "y", "X Z", "0.5 µm"),
            _setup("set-up 3", "rtest", "x y z", "B C", "0.6 µm"),
            _setup("set-up 4", "level", "about x", "X Y", "1 µrad"),
        ],
        stopped_because="rms target reached",
        readings=readings,
        expanded=_expanded(3.3, 1.7),
        minutes=history[-1]["minutes"],
        rms_um=history[-1]["rms_um"],
        worst_um=history[-1]["worst_um"],
        unseen_rms_um=0.82,
        history=history,
        answer=_answered(readings),
        errors=_errors(rng),
        constants=constants,
        observability=[
            "The constant part of EXX, EXY and EXZ cannot be told apart; a probe on a fixed ball would separate them."
        ],
        warnings=[Finding("prior-misfit", "EXX", "EXX, size: 2.4 times as large as stated or usual.")],
        tables=[
            TableOffer("LinuxCNC", {"x.comp": "X"}, "0.4 µm between its rows", dict.fromkeys(EFFECT, 1.0)),
            TableOffer("any", {"curves.csv": "all"}),
        ],
        target_rms_um=2.0,
        target_worst_um=4.0,
        iso230=[block],
        agreement=Agreement(60, 59, 1.03, 0.4),
        agreement_words="59 of 60 readings agree with the others",
        versions={"axiscal": "0.1.0", "numpy": "2.2.0"},
    )


def with_every_text(value: Any, text: str) -> Any:
    """Return value with every piece of text in it replaced, keys of mappings included."""
    if isinstance(value, str):
        return text
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{f.name: with_every_text(getattr(value, f.name), text) for f in fields(value)})
    if isinstance(value, dict):
        names = [
            name if name.islower() or name[0] == "U" else f"{text}{n}" for n, name in enumerate(value)
        ]  # others are fields
        return {name: with_every_text(item, text) for name, item in zip(names, value.values(), strict=True)}
    if isinstance(value, list | tuple):
        return type(value)(with_every_text(item, text) for item in value)
    return value
