"""The report page: safe whatever the names are, self-contained, the same bytes again, and drawn by a real browser."""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
from dataclasses import fields, is_dataclass, replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axiscal.error_model.iso230 import words
from axiscal.exceptions import SummaryError
from axiscal.report.page import render
from axiscal.report.summary import (
    Constant,
    Curve,
    CurvePoint,
    Finding,
    HistoryRow,
    Iso230,
    Rejection,
    ResidualCheck,
    SetupUse,
    Summary,
    TableOffer,
    TruthCheck,
)

TRAVEL = {"C": (0.0, 360.0), "B": (-30.0, 110.0), "Y": (0.0, 500.0), "X": (0.0, 600.0), "Z": (0.0, 500.0)}
HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\"'`&{{ 7*7 }}\u2028javascript:alert(3)"


def _smooth_kernel(a: np.ndarray, b: np.ndarray, length: float) -> np.ndarray:
    distance = np.abs(a[:, None] - b[None, :]) * np.sqrt(5) / length
    kernel: np.ndarray = (1 + distance + distance**2 / 3) * np.exp(-distance)
    return kernel


def _curve(name: str, axis: str, readings: int, rng: np.random.Generator) -> Curve:
    """Condition a smooth random curve on a few noisy readings of it."""
    low, high = TRAVEL[axis]
    unit, scale = ("urad", 20.0) if name[1] in "ABC" else ("um", 8.0)
    where, length = np.linspace(low, high, 61), (high - low) / 4
    prior = scale**2 * _smooth_kernel(where, where, length)
    truth = np.linalg.cholesky(prior + 1e-9 * scale**2 * np.eye(61)) @ rng.standard_normal(61)
    chosen = np.sort(rng.choice(61, readings, replace=False))
    noise = 0.06 * scale
    seen = truth[chosen] + noise * rng.standard_normal(readings)
    gain = prior[:, chosen] @ np.linalg.inv(prior[np.ix_(chosen, chosen)] + noise**2 * np.eye(readings))
    spread = np.sqrt(np.clip(np.diag(prior - gain @ prior[chosen]), 0, None) + (0.02 * scale) ** 2)
    return Curve(
        name=name,
        axis=axis,
        caption=words(name),
        position=where.tolist(),
        mean=(gain @ seen).tolist(),
        std=np.hypot(spread, 0.1 * scale).tolist(),
        std_seen=spread.tolist(),
        prior_std=[scale] * 61,
        position_unit="deg" if axis in "BC" else "mm",
        value_unit=unit,
        truth=(where.tolist(), truth.tolist()),
        points=[
            CurvePoint(where[i], v, noise, "laser along X", 3 + n)
            for n, (i, v) in enumerate(zip(chosen, seen, strict=True))
        ],
    )


def _history(rng: np.random.Generator, readings: int) -> list[HistoryRow]:
    rows = [HistoryRow(0, None, None, None, None, None, 14.2, 31.0, 0.0, traditional_rms_um=14.2)]
    for n in range(1, readings + 1):
        position = {axis: round(float(rng.uniform(*span)), 1) for axis, span in TRAVEL.items()}
        rms = 1.75 + 12.45 * float(np.exp(-n / 14))
        z = 7.3 if n == 31 else float(rng.standard_normal())
        rows.append(
            HistoryRow(
                reading=n,
                setup=f"set-up {n * 4 // (readings + 1) + 1}",
                position=position,
                value_um=float(rng.normal(0, 6)),
                innovation=2 * z,
                innovation_std=2.0,
                rms_um=rms,
                worst_um=1.9 * rms,
                minutes=0.7 * n + 12 * (1 + n * 4 // (readings + 1)),
                rejected=n == 31,
                traditional_rms_um=2.6 + 11.6 * float(np.exp(-n / 24)),
                tcp_mm=(position["X"], position["Y"], position["Z"]),
                approach="X+",
            )
        )
    return rows


def five_axis_summary(readings: int = 60) -> Summary:
    """Return a summary such as a five-axis campaign with a known truth produces."""
    rng = np.random.default_rng(7)
    names = [(f"E{d}{a}", a) for a in TRAVEL for d in "XYZABC"]
    curves = [_curve(name, axis, int(rng.integers(0, 12)), rng) for name, axis in names]
    places = {"A0B": "urad", "C0B": "urad", "A0C": "urad", "B0C": "urad", "C0Y": "urad", "B0Z": "urad", "A0Z": "urad"}
    places |= {"X0C": "um", "Y0C": "um", "X0B": "um", "Z0B": "um", "EXX_reversal": "um", "EYY_reversal": "um"}
    constants = [
        Constant(
            n,
            words(n),
            float(rng.normal(0, 12)),
            float(rng.uniform(0.5, 4)),
            20.0,
            u,
            n != "C0B",
            float(rng.normal(0, 12)),
        )
        for n, u in places.items()
    ]
    target = np.linspace(0, 600, 13)
    up = 4 * np.sin(target / 100)
    block = Iso230(
        "X", "mm", "um", target.tolist(), up.tolist(), [0.4] * 13, (up - 2).tolist(), [0.5] * 13,
        {"A": 11.2, "A_up": 9.8, "A_down": 10.1, "E": 10.0, "E_up": 8.1, "E_down": 8.1, "R": 4.2, "R_up": 1.6, "R_down": 2.0, "B": 2.0, "B_mean": 2.0, "M": 8.1},
        {"A": 1.1, "E": 0.9, "R": 0.7, "B": 0.4, "M": 0.6},
    )  # fmt: skip
    history = _history(rng, readings)
    return Summary(
        title="Calibration before the aerospace order",
        machine="Five-axis machine, 600 × 500 × 500",
        chain="w-C'-B'-b-Y-X-Z-t",
        campaign_file="campaign.toml",
        date="2026-03-14 09:26",
        setups=[
            SetupUse("set-up 1", "interferometer", "x", ("X",), "0.3 µm", 15),
            SetupUse("set-up 2", "straightedge", "y", ("X", "Z"), "0.5 µm", 15),
            SetupUse("set-up 3", "rtest", "x y z", ("B", "C"), "0.6 µm", 15),
            SetupUse("set-up 4", "level", "about x", ("X", "Y"), "1 µrad", 15),
        ],
        stopped_because="rms target reached",
        readings=readings,
        minutes=history[-1].minutes,
        rms_um=history[-1].rms_um,
        worst_um=history[-1].worst_um,
        unseen_rms_um=0.82,
        history=history,
        curves=curves,
        constants=constants,
        observability=[
            "The constant part of EXX, EXY and EXZ cannot be told apart; a probe on a fixed ball would separate them."
        ],
        rejected=[
            Rejection(31, "set-up 3", {"B": 20.0, "C": 180.0}, 14.6, "7.3 standard deviations from what was expected.")
        ],
        warnings=[
            Finding("lack-of-fit", "EXX", "The X curve has detail finer than 25 mm that this model does not follow.")
        ],
        tables=[
            TableOffer("x.comp", "LinuxCNC", "X", "0.4 µm between its rows"),
            TableOffer("curves.csv", "any", "all"),
        ],
        target_rms_um=2.0,
        target_worst_um=4.0,
        truth=TruthCheck(1.93, 1.71, 22.4),
        iso230=[block],
        reading_residual=ResidualCheck(57.3, 60, 0.58),
        versions={"axiscal": "0.1.0", "numpy": "2.2.0"},
        files=["readings.csv"],
    )
