"""What `plan` says keeps its budgets in both languages."""

from __future__ import annotations

import re

import pytest

from axiscal.description.target import RowName, dimension, rows_of
from axiscal.language.spoken import LANGUAGES, speaking
from axiscal.machine import load_machine
from axiscal.planning.helping import Helping
from axiscal.present.answer import NextStep, PlannedRow, PlannedSetup, PlanVerdict, ReachAnswer
from axiscal.present.answer_words import WIDTH
from axiscal.present.plan_answer import PlanAnswer
from axiscal.present.plan_words import LINES, plan_screen
from axiscal_core.machine import Machine
from tests.generators.answers import aim

WORDS = 60
"""Beside the rows."""
NUMBERS = 3
"""In a row."""
HELP = Helping(("laser along X", "ball bar in the plane XY"), 123, 156.3, reached=True)


def planned_row(row: RowName, machine: Machine) -> PlannedRow:
    """Return a row with large figures."""
    unit = "urad" if dimension(row, machine) == "angle" else "um"
    return PlannedRow(
        row=row.name,
        kind=row.kind,
        axes=row.axes,
        unit=unit,
        known_to=128.9,
        known_before=300.0,
        floor=2.0,
        limit=100.0,
        reached=False,
        measured=row.kind != "yaw",
        lines=[],
    )


def plan(verdict: PlanVerdict, rows: list[PlannedRow], setups: int) -> PlanAnswer:
    """Return a plan with as much to say as there may be."""
    names = [f"straightedge along axis {number}" for number in range(setups)]
    missed = [aim("rms", 9.0, 5.0, 8.123, reachable=False), aim("squareness XY", 30.0, 10.0, 19.4, reachable=False)]
    return PlanAnswer(
        verdict=verdict,
        rows=rows,
        aims=[] if verdict == "planned" else missed,
        reach=ReachAnswer(missed=missed, helps=HELP) if verdict == "unreachable" else None,
        setups=[
            PlannedSetup(setup=each, instrument="straightedge", moves=["X"], readings=12, minutes=1.0) for each in names
        ],
        steps=[NextStep(code="target"), NextStep(code="start")],
        points=[],
        units={"X": "mm"},
        readings=123,
        allowed=150,
        minutes=1234.5,
        budget_minutes=1240.0,
        rms_um=1.0,
        bound_rms_um=None,
    )


@pytest.mark.parametrize("language", sorted(LANGUAGES))
@pytest.mark.parametrize("verdict", ["planned", "reached", "short", "unreachable"])
@pytest.mark.parametrize("name", ["three-axis-mill", "dmu60"])
@pytest.mark.parametrize("setups", [1, 3, 12])
def test_the_screen_keeps_its_budgets(language: str, verdict: PlanVerdict, name: str, setups: int) -> None:
    built = load_machine(name)
    rows = [planned_row(row, built) for row in rows_of(built)]
    with speaking(language):
        text = plan_screen(plan(verdict, rows, setups), "mill/campaign.toml", ["where.svg", "programs (12 files)"])
    _within_budgets(text)
    assert "axiscal step start mill/campaign.toml" in text.splitlines()[-1]
    assert ("laser along X" in text) == (verdict == "unreachable")


def _within_budgets(text: str) -> None:
    lines = text.splitlines()
    assert len(lines) <= LINES, text
    assert max(map(len, lines)) <= WIDTH, text
    rows = _rows(text)
    beside = [line for line in lines if line not in rows]
    names = re.compile(r'"[^"]*"|„[^“]*“')
    said = [word for word in names.sub("", " ".join(beside)).split() if re.search(r"[^\W\d_]{2}", word)]
    assert len(said) <= WORDS, text
    for row in rows:
        assert len(re.findall(r"[0-9]+(?:[.,][0-9]+)?", row)) <= NUMBERS, row


def _rows(text: str) -> list[str]:
    return [line for line in text.splitlines() if line.startswith("  ") and "±" in line]
