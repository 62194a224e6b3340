"""Straightness, sag and squareness for LinuxCNC: HAL text that moves an axis by the position of another.

`COMP_FILE` knows one axis only. Between motion and drives HAL can add any function of one position: a `lincurve` of 16
points for each pair. Their sum for an axis goes through a gain, which rises from 0 to 1 once all joints are homed and
falls when one is not. A limit of its speed follows, since the coordinate of a joint jumps at homing. HAL adds the sum
to the command of every joint of the axis and takes it off its feedback, so LinuxCNC does not see it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

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
_HEAD = """# Made by axiscal: moves {moved} by the positions of other axes (straightness, sag, squareness).
# Source this file after motion has been loaded and its functions added. Then send the drive of each joint here what
# axiscal-<axis>-motor holds instead of its motor-pos-cmd, and net its position feedback to axiscal-<axis>-encoder
# instead of joint.N.motor-pos-fb; an axis of several joints has axiscal-<axis>-joint-<N>-motor and -encoder.
# If your files load one of these components already, join the names into one loadrt.
# Best among your addf lines: fb-... after the hardware is read and before motion-command-handler, everything else after
# motion-controller and before the hardware is written; elsewhere the following error grows by the way of one period.
# The correction comes within {ramp:g} s after all joints are homed and goes when one is not; slew-<axis>.maxv is the
# fastest it may move: raise it if your axes are faster than {head:g} times their speed in machine.toml.
"""


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
    moved = {axis: [t for t in tables if t.axis == axis] for axis in dict.fromkeys(t.axis for t in tables)}
    head = _HEAD.format(moved=", ".join(moved), ramp=RAMP, head=HEADROOM).rstrip()
    lines = [head, *_loading(tables, moved, wiring)]
    for table in tables:
        lines += _curve(table, wiring.unit)
    for over in dict.fromkeys(table.over for table in tables):
        curves = " ".join(f"cross-{_name(t)}.in" for t in tables if t.over == over)
        lines.append(f"net axiscal-{over.lower()}-position joint.{wiring.joints[over][0]}.pos-cmd => {curves}")
    lines += _ramp(moved)
    for axis, own in moved.items():
        lines += _correction(axis, own, wiring)
        for joint, label in wiring.labels(axis).items():
            lines += _joint(joint, label, f"axiscal-{axis.lower()}-correction")
    return "\n".join(lines) + "\n"


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
    return f"{table.axis.lower()}-{table.over.lower()}"


def _loading(
    tables: Sequence[CompensationTable], moved: Mapping[str, Sequence[CompensationTable]], wiring: Wiring
) -> list[str]:
    """Return the lines that load the components, one for each kind: a module can be loaded once only."""
    low = [axis.lower() for axis in moved]
    ends = [f"{end}-{label}" for axis in moved for label in wiring.labels(axis).values() for end in ("cmd", "fb")]
    sums = [f"sum-{axis.lower()}-{i}" for axis, own in moved.items() for i in range(1, len(own))]
    sizes = ",".join(str(len(table.positions)) for table in tables)
    names = {
        "lincurve": [f"cross-{_name(t)}" for t in tables],
        "sum2": [*sums, *ends],
        "mux2": ["axiscal-homed"],
        "limit2": ["axiscal-ramp", *(f"slew-{axis}" for axis in low)],
        "mult2": [f"scaled-{axis}" for axis in low],
    }
    lincurve, *others = (f"loadrt {kind} names={','.join(own)}" for kind, own in names.items())
    return [f"{lincurve} personality={sizes}", *others]


def _curve(table: CompensationTable, unit: str) -> list[str]:
    """Return the lines that fill a lincurve: minus the deviation, both directions alike."""
    name = f"cross-{_name(table)}"
    added = -np.asarray(to_unit((table.forward + table.reverse) / 2, "deg" if table.rotary else unit))
    rows = enumerate(zip(to_unit(table.positions, unit), np.round(added, 7) + 0.0, strict=True))
    lines = [f"addf {name} servo-thread"]
    for i, (x, y) in rows:
        lines += [f"setp {name}.x-val-{i:02d} {x:.6f}", f"setp {name}.y-val-{i:02d} {y:.7f}"]
    return lines


def _ramp(moved: Iterable[str]) -> list[str]:
    """Return the lines of the gain: 1 when all joints are homed, else 0, and on its way between for a while."""
    return [
        "addf axiscal-homed servo-thread",
        "addf axiscal-ramp servo-thread",
        "setp axiscal-homed.in1 1",
        f"setp axiscal-ramp.maxv {1 / RAMP:g}",
        "net axiscal-all-homed motion.is-all-homed => axiscal-homed.sel",
        "net axiscal-wanted axiscal-homed.out => axiscal-ramp.in",
        f"net axiscal-gain axiscal-ramp.out => {' '.join(f'scaled-{axis.lower()}.in1' for axis in moved)}",
    ]


def _correction(axis: str, own: Sequence[CompensationTable], wiring: Wiring) -> list[str]:
    """Return the lines that sum the curves of an axis, scale the sum and limit its speed."""
    low = axis.lower()
    last, lines = f"cross-{_name(own[0])}.out", list[str]()
    for i, table in enumerate(own[1:], 1):
        stage = f"sum-{low}-{i}"
        lines += [
            f"addf {stage} servo-thread",
            f"net axiscal-{low}-part-{i} {last} => {stage}.in0",
            f"net axiscal-{_name(table)} cross-{_name(table)}.out => {stage}.in1",
        ]
        last = f"{stage}.out"
    return [
        *lines,
        f"addf scaled-{low} servo-thread",
        f"addf slew-{low} servo-thread",
        f"setp slew-{low}.maxv {to_unit(fastest(own, wiring.speeds), wiring.unit):.6g}",
        f"net axiscal-{low}-all {last} => scaled-{low}.in0",
        f"net axiscal-{low}-scaled scaled-{low}.out => slew-{low}.in",
    ]


def fastest(own: Sequence[CompensationTable], speeds: Mapping[str, float]) -> float:
    """Return how fast the correction of an axis may move, m/s."""
    asked = (float(np.max(np.abs(np.diff(t.forward) / np.diff(t.positions)))) * speeds[t.over] for t in own)
    return max(LEAST_SPEED, HEADROOM * sum(asked))


def _joint(joint: int, label: str, correction: str) -> list[str]:
    """Return the lines that add the correction to the command of a joint, and take it off its feedback."""
    axis = correction.split("-")[1]
    return [
        f"addf cmd-{label} servo-thread",
        f"addf fb-{label} servo-thread",
        f"setp fb-{label}.gain1 -1",
        f"net {correction} slew-{axis}.out => cmd-{label}.in1 fb-{label}.in1",
        f"net axiscal-{label}-start joint.{joint}.motor-pos-cmd => cmd-{label}.in0",
        f"net axiscal-{label}-motor cmd-{label}.out",
        f"net axiscal-{label}-encoder fb-{label}.in0",
        f"net axiscal-{label}-seen fb-{label}.out",
        f"net axiscal-{label}-seen => joint.{joint}.motor-pos-fb",
    ]
