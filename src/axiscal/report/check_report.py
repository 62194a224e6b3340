"""A check of a compensated machine for people: what to expect where, and what the readings said."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.acceptance.check import Check
from axiscal.acceptance.datums import GUARD
from axiscal.acceptance.judgement import Judgement
from axiscal.acceptance.table_checks import WORKS
from axiscal.measurement.place import Places
from axiscal.measurement.place_texts import approach_text, place_text, shown_pose
from axiscal.numerics import Array
from axiscal.units import format_quantity, to_unit

_ROUNDING = 1e-6
"""A figure below a picometre, in um."""
_NEAR = 0.3
"""Of the change that tables should make: this near to all, none or the opposite, it is called that."""


def plan_rows(check: Check, places: Places) -> list[dict[str, object]]:
    """Return each place with what it is expected to show; three figures where a reading has three values."""
    setups, axes = check.description.setups, check.description.machine.axes
    before, after = ([_figures(values) for values in each] for each in check.predicted(places))
    columns = (places.setups.tolist(), places.poses.tolist(), places.approaches.tolist())
    return [
        {
            "setup": setups[s].name,
            "place": place_text(axes, tuple(pose), setups[s].moves),
            "position": shown_pose(axes, pose),
            "approach": approach_text(axes, approach),
            "found_um": before[i],
            "left_um": after[i],
        }
        for i, (s, pose, approach) in enumerate(zip(*columns, strict=True))
    ]


def plan_lines(rows: Sequence[dict[str, object]]) -> list[str]:
    """Return the rows of a plan in words."""
    return [
        f"{row['setup']}: {row['place']}  from {row['approach'] or 'any side'}  "
        f"predicted: as found {_micrometres(row['found_um'])}, as left {_micrometres(row['left_um'])}"
        for row in rows
    ]


def _figures(values: Array) -> float | list[float]:
    plain = [float(value) for value in _plain(to_unit(values, "um"))]
    return plain[0] if len(plain) == 1 else plain


def _micrometres(figures: object) -> str:
    if isinstance(figures, list):
        return "(" + ", ".join(f"{figure:z.1f}" for figure in figures) + ") um"
    return f"{figures:z.1f} um"


def judgement_document(judgement: Judgement) -> dict[str, object]:
    """Return what was judged as a document."""
    figures = (judgement.found, judgement.left, judgement.std)
    found, left, std = (_plain(to_unit(values, "um")).tolist() for values in figures)
    return {
        "schema": "axiscal-verify/1",
        "verdict": judgement.verdict,
        "tolerance_um": to_unit(judgement.tolerance, "um"),
        "guard_band_um": GUARD * max(std),
        "readings": [
            {"found_um": f, "left_um": after, "std_um": s} for f, after, s in zip(found, left, std, strict=True)
        ],
        "agreement_p": judgement.agrees,
        "estimate_believed": judgement.believed,
        "change_p": judgement.changed,
        "change_share": judgement.share,
        "tables_loaded": judgement.loaded,
        "against_own_line": list(judgement.lines),
        "against_own_tool": list(judgement.tools),
        "set_up_still": list(judgement.still),
        "tables": [
            {"table": s.name, "share": _or_none(s.value), "share_std": _or_none(s.std), "checked": s.checked}
            for s in judgement.shares
        ],
        "not_checked": list(judgement.unchecked),
        "axes_not_checked": list(judgement.idle),
        "set_up_off": [{"setup": datum.setup, "unknown": datum.unknown} for datum in judgement.strained],
    }


def _or_none(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _plain(micrometres: Array) -> Array:
    """Return figures with mere rounding as 0 (and never as −0)."""
    return np.where(np.abs(micrometres) < _ROUNDING, 0.0, micrometres)


def judgement_text(judgement: Judgement) -> str:
    """Return what was judged in words."""

    def figures(values: Array) -> str:
        sizes = np.abs(_plain(to_unit(values, "um")))
        return f"largest {float(sizes.max()):.3g} um, RMS {float(np.sqrt(np.mean(sizes**2))):.3g} um"

    tolerance = format_quantity(judgement.tolerance, "um", 3)
    guard = format_quantity(GUARD * float(judgement.std.max()), "um", 3)
    notes = "\n".join([_agreement(judgement), *_warnings(judgement)])
    return (
        f"As found: {figures(judgement.found)}\nAs left:  {figures(judgement.left)}\n{notes}\n"
        f"{judgement.verdict.upper()} at {tolerance}, guard band {guard}{_holds_for(judgement)}: {_why(judgement)}."
    )


def _holds_for(judgement: Judgement) -> str:
    """Return which tables the verdict is about; axes and tables that were not checked are named beside it."""
    others = [f"axis {name} (not moved through its volume and read along)" for name in judgement.idle]
    silent = [share for share in judgement.shares if not share.checked]
    others += [f"table {share.name} (corrects {share.size} at most)" for share in silent]
    if not others:
        return ""
    checked = ", ".join(share.name for share in judgement.shares if share.checked)
    return f", for {checked or 'what was read'} only - NOT CHECKED: {', '.join(others)}"


def _why(judgement: Judgement) -> str:
    if judgement.faulty:
        return f"not as exported: {', '.join(share.name for share in judgement.faulty)}"
    if judgement.verdict == "undecided" and (judgement.strained or judgement.still or not judgement.loaded):
        return "the readings contradict what is said of the tables or the set-ups: see the warning, and read again"
    return {
        "pass": "every deviation lies inside, with its uncertainty",
        "fail": "a deviation lies outside, with all of its uncertainty",
        "undecided": "a deviation lies so near to the tolerance that the readings cannot decide: read again, or better",
    }[judgement.verdict]


def _agreement(judgement: Judgement) -> str:
    if judgement.believed:
        return "The as-left readings agree with the estimate."
    return (
        "WARNING: the readings do not agree with the estimate and its uncertainty "
        f"(p = {judgement.agrees:.2g}): the machine has changed, or the tables are not what was loaded."
    )


def _warnings(judgement: Judgement) -> list[str]:
    lines = [
        f'"{name}" is judged against its own line: its slope is not known to the tolerance.' for name in judgement.lines
    ]
    lines += [
        f'"{name}" is judged with its tool where the readings put it: nobody knows to the tolerance where it sits, and '
        "what looks like a tool that sits elsewhere is not judged."
        for name in judgement.tools
    ]
    lines += [
        f"WARNING: of the table {share.name} the readings show {share.value:.2f} ({share.std:.2f}) times what it takes "
        f"away: {'it was loaded with the wrong sign' if share.value < -WORKS else 'it was not loaded'}."
        for share in judgement.faulty
    ]
    if not judgement.loaded:
        share = "" if judgement.share is None else f", they changed by {judgement.share:.2f} times that"
        lines.append(
            "WARNING: as found minus as left is not what the tables take away "
            f"(p = {judgement.changed:.2g}{share}): {_cause(judgement.share)}."
        )
    lines += [
        f'WARNING: the {datum.unknown} of "{datum.setup}" would have to be far larger than its std says: '
        "the set-up moved, or the machine has an error that looks like it."
        for datum in judgement.strained
    ]
    lines += [
        f'WARNING: all as-left readings of "{name}" are one and the same number: the instrument does not move, or its '
        "resolution is coarser than its noise."
        for name in judgement.still
    ]
    return lines


def _cause(share: float | None) -> str:
    """Return what most probably happened when readings changed by so many times what the tables take away."""
    if share is None:
        return "the tables hold nothing here, and yet the readings changed"
    if abs(share + 1) < _NEAR:
        return "the tables were loaded with the wrong sign"
    if abs(share) < _NEAR:
        return "the tables were not loaded, or it is another machine"
    if abs(share - 1) < _NEAR:
        return "the machine or a set-up moved between the two, or single values are wrong"
    return "the tables were not loaded, loaded with the wrong sign or unit, or it is another machine"
