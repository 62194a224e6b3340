"""Write docs/evidence/trust.md: `python -m benchmarks.trust` takes hours.

It takes minutes with --machines 40 --learnt 10 --attacked 1.
--part iso renews one section. Virtual machines that were tried with these sources are not tried again.
"""

from __future__ import annotations

import argparse
import math
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from datetime import UTC, date, datetime
from pathlib import Path

import numpy as np

from axiscal_core.threads import one_thread
from benchmarks.trust.attack_table import (
    FAR,
    FIRST,
    KNOWN,
    attack_rows,
    attacked,
    beginning_with,
    goal_lines,
)
from benchmarks.trust.beds import available, bed_rows, beds
from benchmarks.trust.curves import CASES, DATA, Measured, iso_test
from benchmarks.trust.iso_tests import iso_rows
from benchmarks.trust.kept import Keeping
from benchmarks.trust.measured import ENOUGH, Outcomes, iso_outcome, outcomes
from benchmarks.trust.sources import version
from benchmarks.trust.tables import table_rows
from benchmarks.trust.virtual import READINGS, Coverage, Moved, covered, gross
from benchmarks.trust.zoo import ZOO_HEAD, zoo_rows

PAGE = Path(__file__).resolve().parents[2] / "docs" / "evidence" / "trust.md"
ZOO = Path(__file__).resolve().parents[1] / "zoo"
_SIZES = (3e-6, 10e-6, 50e-6, 1e-3)

_HEAD = """# Can you trust it?

How often the truth lies within the printed ± (95 % are promised). `make trust` writes the page.
"""

_VIRTUAL = """
## Virtual machines
The prior draws the machines. *Prior × 3*: stated sizes are three times the true ones. *Curves*: each error curve at 101
positions. *Tool point*: its deviation at 80 poses. *Said*: the report says that a size is not as stated.

| machine | readings | prior | machines | curves | tool point | said |
|---|---|---|---|---|---|---|
"""

_MEASURED = """
## Measured curves
Dense measurements of real machines are the truth; a few of their readings are given. *Missed*: RMS of truth minus
estimate. *Spline*: the same of scipy's spline through the even readings. *Band*: printed standard deviation over
what is missed, planned. (`make trust PART=measured`)

| machine | curves | readings | in the band: planned | even | random | missed: planned | even | random | spline | band |
|---|---|---|---|---|---|---|---|---|---|---|
"""

_ISO = """
## ISO 230-2 tests
Real tests of five runs each way; stated: std 30 µm, smooth over two spacings, noise 2 µm (`make trust PART=iso`).

- *Left*: largest mean reading that the table leaves. *Limit*: two standard errors of such a mean.
- *Promised*: RMS over the axis, also between the targets. *Draws*: effective number of draws of the sizes.

| test | left | limit | promised | draws |
|---|---|---|---|---|
"""

_ATTACKS = """
## Attacks
{machines} machines in each cell, of seeds {first} and following; 24 readings of each. One axis of 1 m unless the row
says two or five. The machine is as stated but for the attack. Cells: share of the volume within U; true over promised
RMS; share of machines with a ratio above {far}; share whose U is withheld. In the rows "lengths"
[type B](../promise.md#what-no-reading-shows) counts.
(`make trust PART=attacks MACHINES={machines}`)

| inside, ratio, above {far}, withheld | planned | even | random |
|---|---|---|---|
"""

_BEDS = """
## Beds of printers
Maps of {machines} printers of five types, the plane taken off, read without noise. *Missed*: RMS, geometric mean,
µm. *Spline*: scipy's thin plate through the even grid. *Worst*: of a type. (`make trust PART=beds`)

| points | inside U: planned | even | missed: planned | even | spline | planned over even | worst |
|---|---|---|---|---|---|---|---|
"""

_GROSS = """
## One bad reading
One of thirty readings is wrong (one axis, noise 1 µm, curve 10 µm). How far the curve moves at most from the estimate
with the right reading, in printed σ: median and worst of {trials} machines. *Found*: the reading is taken out.
*Accepted*: worst with `--accept` where U is printed, and how often it is withheld.

| error | found | from the right one: median | worst | at most σ/2 | accepted |
|---|---|---|---|---|---|
"""


_TABLES = """
## Tables on measured curves
{machines} mills whose error motions are measured curves of other machines, finer than the knots, or drawn; 60 readings.
*U*: as README.txt beside the tables promises, the median. *Inside*: share of the volume. *Kept*: machines of which 95 %
of the volume is inside. *Over U*: what 95 % keep. (`make trust PART=tables MACHINES={machines}`)

| tables | curves | U | inside | kept | over U: median | worst |
|---|---|---|---|---|---|---|
"""


def _virtual_row(found: Coverage) -> str:
    wrong = {1.0: "right", 3.0: "× 3"}.get(found.wrong, "÷ 3")
    share = f"{found.curves:.1%} ± {found.error:.1%}"
    count = READINGS[found.machine]
    held = f"{share} | {found.tcp:.1%} | {found.misfit:.0%}"
    return f"| {found.machine} | {count} | {wrong} | {found.machines} | {held} |"


def _measured_row(cases: Sequence[Measured], found: Sequence[Outcomes]) -> str:
    """Return the line of a machine.  cases : its curves; found : what readings make of each"""
    unit = "µrad" if cases[0].unit == "urad" else "µm"
    kinds = [[getattr(each, places) for each in found] for places in ("planned", "even", "random")]
    shares = [f"{np.mean([each.share for each in kind]):.0%}" for kind in kinds]
    missed = [_together([each.rms for each in kind]) for kind in kinds]
    sizes = [f"{size:.3g}" for size in (*missed, _together([each.spline for each in found]))]
    band = f"{_together([each.std / each.rms for each in kinds[0]]):.2f}"
    counts = sorted({case.readings for case in cases})
    name = f"{cases[0].owner}, {unit}"
    return f"| {' | '.join([name, str(len(cases)), ', '.join(map(str, counts)), *shares, *sizes, band])} |"


def _together(sizes: Sequence[float]) -> float:
    return float(np.exp(np.mean(np.log(sizes))))


def _gross_row(moved: Moved) -> str:
    shifts = f"{moved.typical:.2f} σ | {moved.worst:.2f} σ | {moved.within:.0%}"
    return f"| {moved.size * 1e6:g} µm | {moved.rejected:.0%} | {shifts} | {moved.naive:.3g} σ, {moved.withheld:.0%} |"


def _keeping(args: argparse.Namespace, part: str, *files: str) -> Keeping:
    """Return what keeps the machines of a section by the sources and the files that say what a machine is."""
    return Keeping(part, [Path(__file__).with_name(name) for name in files], args.processes)


def _virtual(args: argparse.Namespace) -> Iterator[str]:
    yield _VIRTUAL.strip("\n")
    keeping = _keeping(args, "virtual", "virtual.py")
    every = (("one-axis", args.machines, args.learnt), ("three-axis-mill", *_of_mills(args)))
    for name, right, wrong in every:
        yield _virtual_row(covered(name, 1.0, "estimate", right, keeping))
        yield from (_virtual_row(covered(name, size, "estimate", wrong, keeping)) for size in (1 / 3, 3.0))


def _of_mills(args: argparse.Namespace) -> tuple[int, int]:
    """Return how many mills are tried, with the right prior and with others: they take longer."""
    return max(20, args.machines // 10), max(5, args.learnt // 10)


def _measured(_: argparse.Namespace) -> Iterator[str]:
    if not DATA.is_dir():
        return
    yield _MEASURED.strip("\n")
    cases = [make() for make in CASES]
    found = [outcomes(case) for case in cases]
    for owner in dict.fromkeys(case.owner for case in cases):
        mine = [number for number, case in enumerate(cases) if case.owner == owner]
        yield _measured_row([cases[k] for k in mine], [found[k] for k in mine])
    every = [outcome for each in found for outcome in (each.planned, each.even, each.random)]
    held = sum(each.share >= ENOUGH for each in every)
    by_spline = _together([each.planned.rms / each.spline for each in found])
    yield f"\nOf {len(every)} curves at three kinds of places {held} have 90 % of the truth in the band."
    yield f"What is missed as planned over the spline's, the geometric mean: {by_spline:.2f}."
    test = iso_test()
    iso = iso_outcome(test)
    yield f"An ISO 230-2 test of {len(test.readings)} readings holds {iso.share:.0%} of two dense passes in its band."


def _gross(args: argparse.Namespace) -> Iterator[str]:
    yield _GROSS.format(trials=args.trials).strip("\n")
    keeping = _keeping(args, "gross", "virtual.py")
    yield from (_gross_row(gross(size, args.trials, keeping)) for size in _SIZES)


def _iso(_: argparse.Namespace) -> Iterator[str]:
    yield _ISO.strip("\n")
    yield from iso_rows()


def _attacks(args: argparse.Namespace) -> Iterator[str]:
    which = beginning_with(args.only.split("; ")) if args.only else KNOWN
    kept, machines = attacked(args.attacked, args.processes, 60 * args.minutes, which)
    if not machines:
        return
    yield _ATTACKS.format(machines=machines, first=FIRST, far=FAR).strip("\n")
    yield from attack_rows(kept, machines, which)
    if which == KNOWN:
        yield from goal_lines(kept, machines)


def _beds(_: argparse.Namespace) -> Iterator[str]:
    if not available():
        return
    every = list(beds())
    yield _BEDS.format(machines=len(every)).strip("\n")
    yield from bed_rows(every)


def _tables(args: argparse.Namespace) -> Iterator[str]:
    if not DATA.is_dir():
        return
    yield _TABLES.format(machines=args.attacked).strip("\n")
    yield from table_rows(args.attacked, _keeping(args, "tables", "tables.py", "virtual.py", "curves.py"))


def _zoo(args: argparse.Namespace) -> Iterator[str]:
    yield ZOO_HEAD.format(machines=args.attacked).strip("\n")
    yield from zoo_rows(args.attacked, _of_zoo(args, "zoo"))


def _of_zoo(args: argparse.Namespace, part: str) -> Keeping:
    """Return what keeps the animals of a section by the sources and the files of the zoo."""
    return Keeping(part, sorted(ZOO.glob("*.py")), args.processes)


PARTS: dict[str, Callable[[argparse.Namespace], Iterator[str]]] = {
    "virtual": _virtual,
    "measured": _measured,
    "beds": _beds,
    "iso": _iso,
    "gross": _gross,
    "attacks": _attacks,
    "tables": _tables,
    "zoo": _zoo,
}


def _told(lines: Iterable[str]) -> str:
    """Return lines as text, shown as they come."""
    kept = []
    for line in lines:
        sys.stdout.write(line + "\n")
        sys.stdout.flush()
        kept.append(line)
    return "\n".join(kept) + "\n"


def tight(text: str) -> str:
    """Return lines with the rows of tables without room beside their bars, which count as words."""
    rows = (line.replace(" | ", "|").replace("| ", "|").replace(" |", "|") for line in text.split("\n"))
    return "\n".join(row if row.startswith("|") else line for row, line in zip(rows, text.split("\n"), strict=True))


def stamp(sources: str, day: date) -> str:
    """Return the line that says what a section was measured with.  sources : their name"""
    return f"\n{day}, sources `{sources}`.\n"


def renewed(page: str, section: str) -> str:
    """Return a page with the section of the same heading replaced, or put at its end."""
    heading = section.splitlines()[0]
    before, found, after = page.partition(heading + "\n")
    if not found:
        return f"{page.rstrip()}\n\n{section}"
    _, following, rest = after.partition("\n## ")
    return f"{before}{section}" + (f"\n## {rest}" if following else "")


@one_thread()
def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.trust", description=__doc__)
    parser.add_argument("--machines", type=int, default=200, help="virtual machines with the right prior")
    parser.add_argument("--learnt", type=int, default=40, help="virtual machines with wrong priors")
    parser.add_argument("--trials", type=int, default=100, help="machines with something wrong, of each kind")
    parser.add_argument("--attacked", type=int, default=20, help="machines in each cell of the attack table")
    parser.add_argument("--only", help="attacks that begin so, parted by '; ': shown, not written to the page")
    parser.add_argument("--processes", type=int, default=os.cpu_count(), help="that try virtual machines at once")
    parser.add_argument("--minutes", type=float, default=math.inf, help="after which no more machines are attacked")
    parser.add_argument("--part", choices=list(PARTS), help="only this section, the others stay as they are")
    parser.add_argument("--out", type=Path, default=PAGE)
    args = parser.parse_args()
    page = args.out.read_text(encoding="utf-8") if args.part else _HEAD
    for name in [args.part] if args.part else PARTS:
        section = _told(map(tight, PARTS[name](args)))
        if section.strip() and not args.only:
            page = renewed(page, section + stamp(version(), datetime.now(UTC).date()))
            args.out.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
