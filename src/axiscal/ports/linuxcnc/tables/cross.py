"""Straightness, sag and squareness for LinuxCNC: HAL text that moves an axis by the position of another.

`COMP_FILE` knows one axis only. Between motion and drives HAL can add any function of one position: a `lincurve` of 16
points for each pair. Their sum for an axis goes through a gain, which rises from 0 to 1 once all joints are homed and
falls when one is not. A limit of its speed follows, since the coordinate of a joint jumps at homing. HAL adds the sum
to the command of every joint of the axis and takes it off its feedback, so LinuxCNC does not see it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from axiscal.document.ports import rendered
from axiscal.exceptions import TableError
from axiscal.tables.table import CompensationTable
from axiscal.units import to_unit

POINTS = 16
"""By LinuxCNC's manual: points of a `lincurve`."""
RAMP = 1.0
"""Seconds from nothing to the whole correction."""
LEAST_SPEED = 2e-4
"""m/s; the correction of an axis may always move as fast."""
HEADROOM = 4.0
"""The correction may move as many times faster than the axes that are looked up ask for at their stated speed."""


@dataclass(frozen=True, slots=True)
class Wiring:
    """What the text must know of the machine.

    joints : numbers of the joints of each axis; speeds : of each axis, m/s; unit : of the configuration, mm or in
    """

    joints: Mapping[str, Sequence[int]]
    speeds: Mapping[str, float]
    unit: str = "mm"

    def labels(self, axis: str) -> dict[int, str]:
        """Return what the signals of each joint of an axis are called: x, or y-joint-1 where there are several."""
        numbers, low = self.joints[axis], axis.lower()
        return {n: low if len(numbers) == 1 else f"{low}-joint-{n}" for n in numbers}


def write(tables: Sequence[CompensationTable], wiring: Wiring) -> str:
    """Return the HAL text; tables : over other axes, 16 points at most.  Raises TableError."""
    for table in tables:
        _refuse_what_it_cannot_hold(table, wiring)
    axes, overs = (dict.fromkeys(getattr(table, key) for table in tables) for key in ("axis", "over"))
    moved = [_moved(axis, [table for table in tables if table.axis == axis], wiring) for axis in axes]
    joints = {over: [_name(table) for table in tables if table.over == over] for over in overs}
    return rendered(
        "axiscal.ports.linuxcnc",
        "cross.hal.jinja",
        curves=[{"name": _name(table), "points": _points(table, wiring.unit)} for table in tables],
        positions=[(over.lower(), wiring.joints[over][0], names) for over, names in joints.items()],
        moved=moved,
        labels=[label for axis in moved for _, label in axis["joints"]],
        ramp=f"{RAMP:g}",
        slope=f"{1 / RAMP:g}",
        headroom=f"{HEADROOM:g}",
    )


def _moved(axis: str, own: Sequence[CompensationTable], wiring: Wiring) -> dict[str, Any]:
    """Return an axis that is moved: its first curve, those that are added to it, its joints."""
    first, *parts = map(_name, own)
    speed, joints = f"{to_unit(fastest(own, wiring.speeds), wiring.unit):.6g}", [*wiring.labels(axis).items()]
    return {"axis": axis, "low": axis.lower(), "first": first, "parts": parts, "fastest": speed, "joints": joints}


def _refuse_what_it_cannot_hold(table: CompensationTable, wiring: Wiring) -> None:
    if (count := len(table.positions)) > POINTS:
        what = "the table of {axis} over {over} has {count} points, a lincurve holds {most}"
        raise TableError(what, _FITS, axis=table.axis, over=table.over, count=count, most=POINTS)
    for axis in (table.axis, table.over):
        if axis not in wiring.joints or len(axis) != 1:
            remedy = "Give its number; known are {known}"
            raise TableError("{axis} has no joint in LinuxCNC", remedy, axis=axis, known=", ".join(wiring.joints))


_FITS = "{most} points fit: set them further apart"


def _name(table: CompensationTable) -> str:
    return f"cross-{table.axis.lower()}-{table.over.lower()}"


def _points(table: CompensationTable, unit: str) -> list[tuple[float, float]]:
    """Return the points of a lincurve: minus the deviation, both directions alike."""
    added = -np.asarray(to_unit((table.forward + table.reverse) / 2, table.value_unit(unit)))
    return list(zip(to_unit(table.positions, unit), np.round(added, 7) + 0.0, strict=True))


def fastest(own: Sequence[CompensationTable], speeds: Mapping[str, float]) -> float:
    """Return how fast the correction of an axis may move, m/s."""
    asked = (float(np.max(np.abs(np.diff(t.forward) / np.diff(t.positions)))) * speeds[t.over] for t in own)
    return max(LEAST_SPEED, HEADROOM * sum(asked))
