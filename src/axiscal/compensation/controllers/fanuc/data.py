"""The entries of the points: what is added over the section that ends at each, and what a control makes of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from axiscal.compensation.controllers.fanuc.pitch import APART, PitchParameters
from axiscal.compensation.controllers.fanuc.records import EXPECTED, Records, replace_values
from axiscal.compensation.lookup import Lookup
from axiscal.compensation.table import CompensationTable
from axiscal.exceptions import TableError
from axiscal.numerics import Array

LARGEST = 7
"""By FANUC's manual: an entry is a digit with its sign, -7 to +7."""
FIRST_DATA = 10000
"""By FANUC's manual: the number of the first point's entry."""


@dataclass(frozen=True, eq=False, slots=True)
class Increments:
    """Entries of one axis, whole numbers from its first point on.

    up : (n,) for travel upwards, or for both ways; down : (n,), None without a second set
    apart : parameter 3627, what is added at the reference point when it is approached the other way, detection units
    """

    up: Array
    down: Array | None = None
    apart: int = 0


def increments(table: CompensationTable, plan: PitchParameters, sign: int = 1) -> Increments:
    """Return the entries: the sums, not the increments, are rounded, so that nothing adds up.

    sign : -1 for a control that takes them away.  Raises TableError where one is larger than the format holds.
    """
    if plan.negative is None:
        return Increments(sign * _entries(table.axis, (table.forward + table.reverse) / 2, plan))
    apart = round(float(_added(table, plan, not plan.downwards)[plan.origin]) / plan.detection)
    sides = [_entries(table.axis, values, plan) for values in (table.forward, table.reverse)]
    return Increments(sign * sides[0], sign * sides[1], sign * apart)


def _added(table: CompensationTable, plan: PitchParameters, downwards: bool) -> Array:
    """Return what is to be added at the ends of the sections, nothing at the reference point as it is returned to."""
    home = table.reverse if plan.downwards else table.forward
    added: Array = home[plan.origin] - (table.reverse if downwards else table.forward)
    return added


def _entries(axis: str, deviation: Array, plan: PitchParameters) -> Array:
    sums = np.round((deviation[plan.origin] - deviation) / plan.step).astype(int)
    entries: Array = np.diff(sums)
    entries = np.concatenate([entries[-1:], entries]) if plan.turn else entries
    worst = int(np.max(np.abs(entries)))
    if worst > LARGEST:
        needed = int(np.ceil(worst * plan.magnification / LARGEST))
        what = f"{axis} needs an increment of {worst}, an entry holds {LARGEST}"
        raise TableError(what, f"magnification 3623 = {needed} would fit, or a shorter interval 3624")
    return entries


def fill(
    text: str,
    plans: Mapping[str, PitchParameters],
    found: Mapping[str, Increments],
    numbers: Mapping[str, int],
    file: str,
) -> str:
    """Return the text with the pitch data of the axes replaced; raises TableError for points that it has no row for.

    numbers : of the controlled axes by name
    """
    wanted: dict[tuple[int, int], int] = {}
    for name, made in found.items():
        sides = [made.up] if made.down is None else [made.up, made.down]
        for points, entries in zip(plans[name].numbers, sides, strict=True):
            wanted |= {(FIRST_DATA + n, 0): int(v) for n, v in zip(points, entries, strict=True)}
        if made.down is not None:
            wanted[APART, numbers[name]] = made.apart
    return replace_values(text, wanted, file)


def read(
    records: Records, plans: Mapping[str, PitchParameters], numbers: Mapping[str, int], sign: int = 1
) -> list[Lookup]:
    """Return what the control adds: entries add up from the reference point, times the magnification.

    sign : -1 for a control that takes them away
    """
    lookups = []
    for axis, plan in plans.items():
        ups, *downs = (_sums(records, points, plan) for points in plan.numbers)
        if not downs:
            lookups.append(Lookup(axis, axis, plan.positions, sign * ups))
            continue
        apart = float(records[APART][numbers[axis]]) * plan.detection
        ups, down = (ups + apart, downs[0]) if plan.downwards else (ups, downs[0] + apart)
        lookups.append(Lookup(axis, axis, plan.positions, sign * ups, 1))
        lookups.append(Lookup(axis, axis, plan.positions, sign * down, -1))
    return lookups


def _sums(records: Records, points: range, plan: PitchParameters) -> Array:
    rows = [FIRST_DATA + n for n in (points[1:] if plan.turn else points)]
    if missing := next((row for row in rows if 0 not in records.get(row, {})), None):
        raise TableError(f"there is no row N{missing}", EXPECTED)
    steps = np.array([float(records[row][0]) for row in rows])
    sums = np.concatenate([np.zeros(1), np.cumsum(steps)])
    added: Array = (sums - sums[plan.origin]) * plan.step
    return added
