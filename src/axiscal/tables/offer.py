"""From files that were written to files that are offered: read back, applied in a simulated control, compared."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from axiscal.document import shown
from axiscal.document.ports import of_class, rendered
from axiscal.estimation.machine_estimate import Estimate, LeftUnknown
from axiscal.exceptions import TableError
from axiscal.language.spoken import joined, later, put, said
from axiscal.machine.questions import uncounted
from axiscal.numerics import Array, even_subset
from axiscal.tables.exporter import Written, paragraphs
from axiscal.tables.sampling import axis_tables, cross_tables
from axiscal.tables.surface import Control, Effect, effect_of_control, left_by, planes_left, rms, tour
from axiscal.tables.table import CompensationTable
from axiscal.units import digits, format_quantity, to_unit

POSES = 1000
"""Poses at which a file is tried: a file that adds the wrong thing does so at almost every pose."""
_DEFECT = "do not load it: this is a defect of what writes or reads it, please report it"
_BEYOND = later("read more of the travel: beyond what was read they stay as they are at its end")
_PART = 0.05
"""Of the largest deviation: a table that moves an axis by less is none of those that more readings are for."""
_WORTH = 1e-9
"""m: a correction below a nanometre is none."""


@dataclass(frozen=True, eq=False, slots=True)
class Export:
    """Files that may be loaded.

    effect : of the estimated deviation over the volume; readme : the text that goes beside them
    known : what the estimate may be wrong by over the volume, one shift of everything taken off, or the motion of an
    aligned part
    idle : the axes that the files never move; by_row : whether they take a row of the answer away
    """

    controller: str
    files: Mapping[str, str]
    tables: tuple[CompensationTable, ...]
    control: Control
    effect: Effect
    known: LeftUnknown
    readme: str
    idle: tuple[str, ...]
    by_row: bool

    @property
    def expected(self) -> float:
        """RMS of the TCP deviation that is to be expected with the files, m: what they leave, and what is not known."""
        return float(np.hypot(self.effect.after, self.known.rms))

    @property
    def certain(self) -> float:
        """95 % of the deviations with the files are within it, m."""
        return self.known.beside(self.effect.after)

    @property
    def worth(self) -> bool:
        """Whether they leave less error than there is: of the tool point, or of a row that readings tell."""
        before, after = self.effect
        return after < before or (self.by_row and after == before)


def tried_out(controller: str, estimate: Estimate, draft: Written) -> Export:
    """Return the files with what they do; raises TableError when they would not do what they are meant to."""
    of_class("Written.notes", draft.notes, tuple)
    for name, lost in draft.steps.items():
        of_class(f"Written.steps[{name!r}]", lost, float, int)
    if name := next((name for name in draft.files if Path(name).name != name), ""):
        raise TableError("{name} is no file beside README.txt", "Give files names without folders", name=shown(name))
    if not draft.files:
        raise TableError("there is no deviation that these files could hold", _nothing_held(estimate))
    estimate = draft.about or estimate
    machine, (poses, approaches) = estimate.machine, spread_poses(estimate)
    apart = np.max(np.abs(draft.control(poses, approaches) - draft.wanted(poses, approaches)), axis=0)
    slack, far = _WORTH, 2 * float(sum(max(abs(b) for b in bounds) for bounds in estimate.box))
    for axis, worst in zip(machine.axes, apart, strict=True):
        step = draft.steps.get(axis.name, 0.0)
        slack += step * (far + machine.tool_length if axis.rotary else 1.0)  # times its lever on the TCP
        if not worst <= step + 1e-12:
            shown_worst = format_quantity(float(worst), "arcsec" if axis.rotary else "um", 3)
            what = "read back, the files move {axis} by {shown} more or less than they should"
            raise TableError(what, _DEFECT, axis=axis.name, shown=shown_worst)
    tried = machine, estimate.deviation, draft.control
    effect = effect_of_control(*tried, poses, estimate.box, counted=estimate.counted)
    meant = rms(left_by(machine, estimate.deviation, draft.wanted, poses, approaches), estimate.counted)
    if effect.after > min(meant, effect.before) + slack:
        before, after = (format_quantity(value, "um", 3) for value in effect)
        what = "these files would take the error from {before} to {after}"
        raise TableError(what, _DEFECT if effect.after > meant + slack else _BEYOND, before=before, after=after)
    if estimate.sample is not None:
        effect = effect_of_control(*tried, places(estimate)[0], estimate.box, estimate.alignment, estimate.counted)
    together = planes_left(estimate, draft.control, poses, approaches)
    silent = joined([title(table) for table in _untold(estimate)]) if draft.tables else ""
    silent = silent and f"what a table would take less than 10 % away from ({silent})"
    left_out = "; ".join(part.removesuffix(".") for part in (draft.left_out, together, silent) if part)
    readme = rendered(
        "axiscal.tables",
        "readme.jinja",
        title=title,
        quantity=format_quantity,
        controller=controller,
        draft=replace(draft, left_out=left_out),
        left=effect_sentence("They", effect, estimate.unknown),
        first=(*draft.first, *foreword(estimate, draft.control)),
    )
    moved = np.any(draft.control(poses, approaches), axis=0)
    idle = tuple(axis.name for axis, moves in zip(machine.axes, moved, strict=True) if not moves)
    by_row = any((table.axis, table.over) in estimate.told for table in draft.tables)
    done = draft.files, draft.tables, draft.control, effect, estimate.unknown, readme, idle
    return Export(controller, *done, by_row)


def _untold(estimate: Estimate) -> tuple[CompensationTable, ...]:
    """Return the tables that there are not, since they would take away less than a tenth."""
    return (*axis_tables(estimate, told=False), *cross_tables(estimate, told=False))


def _nothing_held(estimate: Estimate) -> str:
    """Return what to do when a controller can hold nothing of what is known."""
    found = estimate.deviation(*spread_poses(estimate))
    if float(np.max(np.abs(found), initial=0.0)) <= _WORTH:
        return said("take readings first")
    silent = [table for table in _untold(estimate) if np.ptp(table.forward) > _PART * np.max(np.ptp(found, axis=0))]
    if silent:
        what = "take more readings: tables of {tables} would take away less than 10 %"
        return said(what, tables=joined([title(table) for table in silent]))
    return said(
        "what the readings show is along no axis that such files move; the bed of a printer goes as a height map to "
        "klipper, marlin or reprapfirmware"
    )


def places(estimate: Estimate, count: int = POSES) -> tuple[Array, Array]:
    """Return so many poses (m, q) spread evenly over the part, or over the volume, and approaches."""
    if estimate.sample is None:
        return spread_poses(estimate, count)
    return tour(estimate.sample[even_subset(estimate.sample, count)], estimate.box)


def effect_sentence(files: str, effect: Effect, known: LeftUnknown) -> str:
    """Say what files leave of the deviation, with what is not known of it, in the digits of the rows of the answer."""
    certain = known.beside(effect.after)
    if max(*effect, certain) <= _WORTH:
        return said("{files} turn axes about the tool point, which stays where it is over the volume.", files=files)
    sizes = [(np.hypot(each, known.rms), math.inf) for each in effect]
    sizes += [(each, known.limit) for each in (known.expanded, certain)]
    of_rows = (digits(*to_unit(np.array(each), "um").tolist()) for each in sizes)
    before, after, U, within = (put("{size} um", size=size) for size in of_rows)
    return said(
        "{files} take the TCP deviation over the volume, with what is not known of it, from {before} RMS to {after}. "
        "U of the estimate is {U}; with what the files leave, 95 % of the deviations lie within {within}.",
        files=files,
        before=before,
        after=after,
        U=U,
        within=within,
    )


def spread_poses(estimate: Estimate, count: int = POSES) -> tuple[Array, Array]:
    """Return poses (m, q), multiples of irrational steps over the volume, and approaches at which files are tried."""
    low, high = np.array(estimate.box).T
    primes = np.sqrt([2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37])[: len(low)]
    spread: Array = low + (high - low) * np.mod(np.outer(np.arange(1, count + 1), primes), 1.0)
    return tour(spread, estimate.box)


def title(table: CompensationTable) -> str:
    """Return the name of a table: its axis, or what it moves over another axis."""
    if table.over == table.axis:
        return table.axis
    return said("{axis} over {over}", axis=table.axis, over=table.over)


def foreword(estimate: Estimate, control: Control) -> tuple[str, ...]:
    """Return the first lines of README.txt: what loading the files moves, and what was taken for granted.

    control : what the files do. Without rotary axes they add nothing at machine zero, every axis at 0 or at the end of
    its travel nearest to it. Rotary axes have a place: files then hold the constant that puts the tool right to them.
    """
    machine = estimate.machine
    poses = np.stack([np.array(machine.zero), np.mean(np.array(estimate.box), axis=1)])
    sent = [machine.frames(poses + control(poses, np.full(poses.shape, side))).tcp for side in (1.0, -1.0)]
    moved = to_unit((sent[0] + sent[1]) / 2 - machine.frames(poses).tcp, "um").tolist()
    told = list[str]()
    for pose, shift in zip(poses, moved, strict=True):
        at = " ".join(
            f"{a.name} {format_quantity(float(v) + 0.0, a.unit)}" for a, v in zip(machine.axes, pose, strict=True)
        )
        by = ", ".join(f"{name} {round(value, 1) + 0.0:+.1f}" for name, value in zip("xyz", shift, strict=True))
        told.append(f"{at} by {by} um")
    values = {"machine": machine, "unsaid": joined(uncounted(machine)), "at_zero": told[0], "in_the_middle": told[1]}
    return paragraphs("axiscal.tables", "foreword.jinja", **values)
