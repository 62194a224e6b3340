"""Answers as documents, with figures of any size."""

from collections.abc import Sequence
from typing import Any

from axiscal.description.target import Kind, RowName, dimension
from axiscal.present.answer import Aim, AnswerLine, AnswerRow, Outcome, SignedNumber
from axiscal_core.machine import Machine

_SIGNED: dict[Kind, tuple[str, ...]] = {
    "backlash": ("X",),
    "squareness": ("XY",),
    "centre": ("X", "Y"),
    "tilt": ("A", "B"),
}


def answer(**changes: Any) -> Outcome:
    """Return the answer of 32 readings that agree, without rows, with changes."""
    usual: dict[str, Any] = {
        "verdict": "measured",
        "rows": [],
        "aims": [],
        "more": 123,
        "more_minutes": 56.2,
        "readings": 32,
        "left_out": 1,
        "compared": 32,
        "agreeing": 32,
        "minutes": 25.3,
        "clocked": False,
        "withheld": False,
        "steps": [],
    }
    return Outcome(**(usual | changes))


def answer_row(
    row: RowName, machine: Machine, measured: bool = True, controls: Sequence[str] = ("linuxcnc",)
) -> AnswerRow:
    """Return a row with large figures."""
    unit = "urad" if dimension(row, machine) == "angle" else "um"
    return AnswerRow(
        row=row.name,
        kind=row.kind,
        axes=row.axes,
        unit=unit,
        found=234.5,
        signed=[SignedNumber(direction=name, value=-234.5, U=128.9) for name in _SIGNED.get(row.kind, ())],
        largest=400.0,
        known_to=128.9,
        known_before=300.0,
        floor=2.0,
        left=dict.fromkeys(controls if unit == "um" else (), 123.4),
        limit=None,
        reached=None,
        measured=measured,
        lines=[]
        if row.kind == "volume"
        else [
            AnswerLine(setup="laser", axis="X", ends=(0.0, 100.0), at={"Y": 0.0}, places={"+": 4, "-": 0, "both": 0})
        ],
    )


def aim(name: str, now: float, limit: float, floor: float, **more: Any) -> Aim:
    """Return something that is asked for."""
    return Aim(name=name, now=now, limit=limit, floor=floor, **more)
