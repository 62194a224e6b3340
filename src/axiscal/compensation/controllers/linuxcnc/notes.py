"""What LinuxCNC does with a table that a person who loads it has to know; all of it was seen on the controller."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from axiscal.compensation.table import CompensationTable
from axiscal.units import to_unit


def notes(
    table: CompensationTable, unit: str, joints: Sequence[int], acceleration: float | None, servo_period: float
) -> tuple[str, ...]:
    """Return the sentences for whoever loads the file; arguments as in `offer`."""
    sections = " and ".join(f"[JOINT_{joint}]" for joint in joints) or "[JOINT_n], n the joint of this axis"
    each = f" The {len(joints)} joints of {table.axis} have the same table." if len(joints) > 1 else ""
    first, last = (f"{to_unit(float(table.positions[i]), unit):.6g}" for i in (0, -1))
    return (
        f"In the INI file, section {sections}: COMP_FILE = {table.axis}.comp and COMP_FILE_TYPE = 0; restart LinuxCNC."
        f"{each}",
        "BACKLASH of the joint is ignored from then on; the two columns of the table hold the reversal.",
        _reversal_note(table, acceleration, servo_period),
        f"Outside {first} to {last} {unit} the correction of the nearest end stays.{_turns_note(table)}",
        "After a start or homing there is no correction until the joint has moved: move it once before measuring.",
        "Give the drive 1.5 times MAX_VELOCITY and MAX_ACCELERATION: the correction comes on top of the motion.",
        "Positions shown by LinuxCNC do not contain the correction; it can be seen in joint.N.backlash-filt.",
    )


def _turns_note(table: CompensationTable) -> str:
    if not table.rotary:
        return ""
    count = float(np.ptp(table.positions)) / math.tau
    if count < 1 - 1e-9:
        return " A rotary table does not repeat after a turn: keep the axis within it."
    held = "one turn" if count < 1.5 else f"{count:.0f} turns"
    return (
        f" LinuxCNC does not repeat a table: this one holds {held}. The joint counts on after 360 deg, with "
        "WRAPPED_ROTARY = 1 as well: unwind the axis, or home it, before it leaves them."
    )


def dead_band(acceleration: float, servo_period: float) -> tuple[float, float]:
    """Return between which steps (m or rad) LinuxCNC at rest does not carry out a reversal: low < step <= high.

    acceleration : MAX_ACCELERATION of the joint, m/s² or rad/s²; servo_period : s
    """
    unit_step = acceleration * servo_period**2
    return 0.25 * unit_step, 0.5 * unit_step


def _reversal_note(table: CompensationTable, acceleration: float | None, servo_period: float) -> str:
    smallest, largest = table.reversal
    if largest == 0:
        return "The table knows no reversal: both directions are the same."
    if acceleration is None:
        return (
            "A reversal step between 0.25 and 0.5 of MAX_ACCELERATION times SERVO_PERIOD squared is never carried out."
        )
    low, high = dead_band(acceleration, servo_period)
    if largest <= low or smallest > high:
        return f"The reversal step, {_span(table, smallest, largest)}, is carried out at this acceleration."
    band = f"between {table.shown(low)} and {table.shown(high)}"
    step = _span(table, smallest, largest)
    return f"WARNING: the reversal step is {step}, and at this MAX_ACCELERATION LinuxCNC never carries out one {band}."


def _span(table: CompensationTable, smallest: float, largest: float) -> str:
    ends = dict.fromkeys(table.shown(step) for step in (smallest, largest))
    return " to ".join(ends)
