"""Write docs/evidence/planes.md: `python -m benchmarks.planes` takes five minutes; --only NAME prints one map."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from axiscal_core.threads import one_thread
from benchmarks.planes.designs import Outcome, outcome
from benchmarks.planes.maps import DATA, Plane, maps

PAGE = Path(__file__).resolve().parents[2] / "docs" / "evidence" / "planes.md"
COUNTS = (12, 16, 25)
DESIGNS = {
    "two curves, planned": (True, False),
    "both axes, even grid": (False, True),
    "both axes, planned": (True, True),
}
_HEAD = """# What errors of two axes buy

Measured maps of printer beds and of a granite plate, read in 12, 16 or 25 of their nodes; the other nodes are the
truth. `python -m benchmarks.planes` writes this page in five minutes and prints each map; the maps are not part of the
project. One description serves all maps: `EZX` and `EZY` of 50 um over 0.35 of the travel, `EZXY` half as large with a
rest of 5 um, `usual = "off"`.

- *Two curves*: the same without `EZXY`.
- *Missed*: RMS over all nodes of truth less estimate, um, geometric mean over the maps.
- *Held*: share of the unread nodes within the printed 95 %.

"""
_COLUMNS = "".join(f"{design}: missed | held | " for design in DESIGNS)


def _table(heads: str, rows: list[str]) -> str:
    return "\n".join([heads, "|---" * (heads.count("|") - 1) + "|", *rows]) + "\n"


Row = tuple[Plane, int, list[Outcome]]


@one_thread()
def main() -> int:
    """Run; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", metavar="NAME", help="maps whose name holds this; the page stays as it is")
    wanted = parser.parse_args().only
    if not DATA.exists():
        print(f"the maps are not in {DATA}", file=sys.stderr)
        return 1
    rows = list[Row]()
    for plane in maps():
        enough = 2 * max(COUNTS) < len(plane.nodes)
        for count in COUNTS if enough and (wanted is None or wanted in plane.name) else ():
            rows.append((plane, count, [outcome(plane, count, *design) for design in DESIGNS.values()]))
            print(_line(rows[-1]), flush=True)
    summary = [_summary([row for row in rows if row[1] == count], count) for count in COUNTS]
    whole = _table(f"| readings | maps | {_COLUMNS}planned/grid | planned/two curves |", summary)
    print(whole)
    if wanted is None:
        PAGE.write_text(_HEAD + whole, encoding="utf-8")
    return 0


def _summary(rows: list[Row], count: int) -> str:
    if not rows:
        return f"| {count} | 0 |"
    missed = [float(np.exp(np.mean([np.log(row[2][k].missed) for row in rows]))) for k in range(len(DESIGNS))]
    held = [float(np.mean([row[2][k].held for row in rows])) for k in range(len(DESIGNS))]
    each = " | ".join(f"{m:.1f} | {100 * h:.1f} %" for m, h in zip(missed, held, strict=True))
    curves, grid, planned = missed
    return f"| {count} | {len(rows)} | {each} | {planned / grid:.2f} | {planned / curves:.2f} |"


def _line(row: Row) -> str:
    plane, count, found = row
    each = " | ".join(f"{one.missed:.1f}, {100 * one.held:.0f}" for one in found)
    return f"| {plane.name} | {len(plane.nodes)} | {count} | {each} |"


if __name__ == "__main__":
    sys.exit(main())
