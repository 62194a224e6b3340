"""Write docs/trust.md: `python -m benchmarks.trust` takes hours, with --machines 40 --learnt 10 --attacked 1 minutes.

--part iso renews one section. Virtual machines that were tried with these sources are not tried again.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterable, Iterator
from datetime import UTC, date, datetime
from pathlib import Path

import numpy as np

from axiscal.numerics.threads import one_thread
from axiscal.study.work import processors_here
from benchmarks.trust.attack_table import EVERY, FAR, FIRST, attack_rows, attacked, beginning_with, goal_lines
from benchmarks.trust.curves import CASES, DATA, iso_test
from benchmarks.trust.displays import display_rows
from benchmarks.trust.iso_tests import iso_rows
from benchmarks.trust.kept import Keeping
from benchmarks.trust.measured import ENOUGH, Outcome, iso_outcome, outcomes
from benchmarks.trust.sources import version
from benchmarks.trust.virtual import READINGS, Coverage, Moved, covered, gross

PAGE = Path(__file__).resolve().parents[2] / "docs" / "trust.md"
_SIZES = (3e-6, 5e-6, 7e-6, 10e-6, 20e-6, 50e-6, 1e-3)

_HEAD = """# Can you trust it?

Every figure the program prints has a ±. This page says how often the truth lies within it: on virtual machines, where
the model is right by construction or wrong on purpose, and on curves that others have measured on real machines, where
no model is right. `make trust` writes it anew; nothing here is typed by hand. A section says at its end which sources
of the package its figures were measured with; one that does not is of an earlier state.

A band is 1.96 standard deviations either way, so 95 % of the truth should lie in it. *Curves* counts every error curve
of the machine at 101 positions, *tool point* the TCP deviation along x, y, z at 80 poses all over the volume.
"""

_VIRTUAL = """
## Virtual machines
Drawn from a prior, read with noise through their full non-linear kinematics, estimated. *Bare*: `usual = "off"`,
`sure = "exactly"`, the model that the machines are drawn from. *Usual*: what campaigns count unless they say otherwise.
"Prior × 3" means that every stated standard deviation was three times the true one. *Said*: the share of machines (of
the first forty) whose report says that a size is not as stated.

| machine | readings | model | prior | machines | curves | tool point | said |
|---|---|---|---|---|---|---|---|
"""

_MEASURED = """
## Measured curves
A few readings of a curve or map that was measured densely; the rest of it is the truth. The priors are round figures,
not fitted, but chosen by somebody who knew the files. *Missed* is the RMS of truth minus estimate, *band* the RMS of
the printed standard deviation, *withheld* whether U is withheld because the readings contradict each other, *said* the
warnings in the report. Random points: the mean of three draws, with all their warnings. Of the plug plate no hole is
read twice there.

| curve | readings | points | in the band | missed | band | withheld | said |
|---|---|---|---|---|---|---|---|
"""

_ISO = """
## ISO 230-2 tests
Real tests of five runs each way, std 30 µm, smooth over two spacings, noise 2 µm stated. *Learnt*: nothing (`usual =
"off"`, `sure = "exactly"`), the rest besides, or all sizes (the default). *Left*: the largest mean reading of a target
that the table made of them does not take away. *Limit*: two standard errors of such a mean. *Promised*: RMS over the
axis, what lies between the targets included. *Draws*: effective number of draws of the sizes that the band averages
over. (`make trust PART=iso`)

| test | learnt | left | limit | promised | draws |
|---|---|---|---|---|---|
"""

_DISPLAYS = """
## A display that moves in steps
Share of a curve that the 95 % band holds: two readings at each of 13 places, the curve ten times the noise. Steps in
units of the noise; the rounding ignored, counted as a variance of q²/12, or each reading taken for the interval it
fell in (which is what estimates do from three on). (`make trust PART=display`)

| step | ignored | σ² + q²/12 | interval |
|---|---|---|---|
"""

_ATTACKS = """
## Attacks
{machines} machines in each cell, of seeds {first} and following. An axis of 1 m (curve 10 µm over 200 mm, noise 0.5 µm,
the laser's zero unknown), 24 readings, one a minute, out and back; two axes of 400 mm under a probe, 24 readings; five
axes under an R-test at three spheres, 24 readings. The machine is as stated, but for what is put in. *Planned*: where a
plan asks for readings; *even* and *random* places as well, out and back. Each cell has four figures. Three are of the
machines whose U is printed: the share of the volume that is no farther off than U (95 % are promised), the ratio of
true to promised RMS (geometric mean), and the share of machines whose ratio is above {far}. The last is the share of
machines whose U is withheld: the readings contradict each other, or the file is refused. Nothing shows a turned sign of
all readings but `axiscal verify`. "Lengths": all readings are longer alike, and type B counts
([promise.md](promise.md#what-no-reading-shows)); in the other rows instruments and temperatures are perfect.
(`make trust PART=attacks MACHINES={machines}`; it goes on where it was stopped, and `MINUTES=30` stops it.
`ONLY="step; bump"` shows such rows and leaves the page as it is.)

| inside, ratio, above {far}, withheld | planned | even | random |
|---|---|---|---|
"""

_GROSS = """
## One bad reading
Thirty readings of a one-axis machine (noise 1 µm, curve 10 µm), one of them wrong. How far the curves move, in units
of the σ printed beside them: largest over the curve, the median and the worst of {trials} machines. *Found*: the
reading is taken out. *From the right estimate*: beside what the right reading would have given, so that what is left of
a large error is the information that the reading would have brought. *From the others*: beside the estimate of the
other 29, which is what the error itself does. *Accepted*: the worst where all readings are recorded with `--accept`.

| error | found | from the right one: median | worst | at most σ/2 | from the others: worst | at most σ/2 | accepted |
|---|---|---|---|---|---|---|---|
"""


def _virtual_row(found: Coverage) -> str:
    wrong = {1.0: "right", 3.0: "× 3"}.get(found.wrong, "÷ 3")
    share = f"{found.curves:.1%} ± {found.error:.1%}"
    count = READINGS[found.machine]
    model = "bare" if found.scales == "stated" else "usual"
    held = f"{share} | {found.tcp:.1%} | {found.misfit:.0%}"
    return f"| {found.machine} | {count} | {model} | {wrong} | {found.machines} | {held} |"


def _measured_row(name: str, readings: int, outcome: Outcome, unit: str) -> str:
    sizes = f"{outcome.rms:.3g} {unit} | {outcome.std:.3g} {unit}"
    said = ", ".join(flag for flag in outcome.flags if flag != "unobservable") or "–"
    withheld = f"{outcome.withheld:.0%}" if outcome.withheld else "–"
    return f"| {name} | {readings} | {outcome.design} | {outcome.share:.1%} | {sizes} | {withheld} | {said} |"


def _gross_row(moved: Moved) -> str:
    shifts = f"{moved.typical:.2f} σ | {moved.worst:.2f} σ | {moved.within:.0%}"
    alone = f"{moved.bent:.2f} σ | {moved.straight:.0%} | {moved.naive:.3g} σ"
    return f"| {moved.size * 1e6:g} µm | {moved.rejected:.0%} | {shifts} | {alone} |"


def _keeping(args: argparse.Namespace, part: str, *files: str) -> Keeping:
    """Return what keeps the machines of a section by the sources and the files that say what a machine is."""
    return Keeping(part, [Path(__file__).with_name(name) for name in files], args.processes)


def _virtual(args: argparse.Namespace) -> Iterator[str]:
    yield _VIRTUAL.strip("\n")
    keeping = _keeping(args, "virtual", "virtual.py")
    every = (("one-axis", args.machines, args.learnt), ("three-axis-mill", *_of_mills(args)))
    for name, right, wrong in every:
        yield _virtual_row(covered(name, 1.0, "stated", right, keeping))
        yield from (_virtual_row(covered(name, size, "estimate", wrong, keeping)) for size in (1.0, 1 / 3, 3.0))


def _of_mills(args: argparse.Namespace) -> tuple[int, int]:
    """Return how many mills are tried, with the right prior and with others: they take longer."""
    return max(20, args.machines // 10), max(5, args.learnt // 10)


def _measured(_: argparse.Namespace) -> Iterator[str]:
    if not DATA.is_dir():
        return
    yield _MEASURED.strip("\n")
    test = iso_test()
    outcome, _count = iso_outcome(test)
    yield _measured_row("X slide: ISO 230-2 test against dense passes", len(test.readings), outcome, "µm")
    every = [outcome]
    for make in CASES:
        case = make()
        unit = "µrad" if case.unit == "urad" else "µm"
        mine = outcomes(case)
        every += mine
        yield from (_measured_row(case.name, case.readings, outcome, unit) for outcome in mine)
    held = sum(each.share >= ENOUGH for each in every)
    wide = float(np.exp(np.mean([np.log(each.std / each.rms) for each in every])))
    yield f"\nOf {len(every)} rows {held} have 90 % of the truth in the band."
    yield f"Band over missed, the geometric mean over all rows: {wide:.2f}."


def _gross(args: argparse.Namespace) -> Iterator[str]:
    yield _GROSS.format(trials=args.trials).strip("\n")
    keeping = _keeping(args, "gross", "virtual.py")
    yield from (_gross_row(gross(size, args.trials, keeping)) for size in _SIZES)


def _iso(_: argparse.Namespace) -> Iterator[str]:
    yield _ISO.strip("\n")
    yield from iso_rows()


def _displays(args: argparse.Namespace) -> Iterator[str]:
    yield _DISPLAYS.strip("\n")
    yield from display_rows(args.trials)


def _attacks(args: argparse.Namespace) -> Iterator[str]:
    which = beginning_with(args.only.split("; ")) if args.only else EVERY
    kept, machines = attacked(args.attacked, args.processes, 60 * args.minutes, which)
    if not machines:
        return
    yield _ATTACKS.format(machines=machines, first=FIRST, far=FAR).strip("\n")
    yield from attack_rows(kept, machines, which)
    if which == EVERY:
        yield from goal_lines(kept, machines)


PARTS: dict[str, Callable[[argparse.Namespace], Iterator[str]]] = {
    "virtual": _virtual,
    "measured": _measured,
    "iso": _iso,
    "gross": _gross,
    "display": _displays,
    "attacks": _attacks,
}


def _told(lines: Iterable[str]) -> str:
    """Return lines as text, shown as they come."""
    kept = []
    for line in lines:
        sys.stdout.write(line + "\n")
        sys.stdout.flush()
        kept.append(line)
    return "\n".join(kept) + "\n"


def stamp(sources: str, day: date) -> str:
    """Return the line that says what a section was measured with.  sources : their name"""
    return f"\nMeasured on {day} with the sources `{sources}`.\n"


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
    parser.add_argument("--machines", type=int, default=2000, help="virtual machines with the right prior")
    parser.add_argument("--learnt", type=int, default=200, help="virtual machines with wrong priors")
    parser.add_argument("--trials", type=int, default=100, help="machines with something wrong, of each kind")
    parser.add_argument("--attacked", type=int, default=20, help="machines in each cell of the attack table")
    parser.add_argument("--only", help="attacks that begin so, parted by '; ': shown, not written to the page")
    parser.add_argument("--processes", type=int, default=processors_here(), help="that try virtual machines at once")
    parser.add_argument("--minutes", type=float, default=math.inf, help="after which no more machines are attacked")
    parser.add_argument("--part", choices=list(PARTS), help="only this section, the others stay as they are")
    parser.add_argument("--out", type=Path, default=PAGE)
    args = parser.parse_args()
    page = args.out.read_text(encoding="utf-8") if args.part else _HEAD
    for name in [args.part] if args.part else PARTS:
        section = _told(PARTS[name](args))
        if section.strip() and not args.only:
            page = renewed(page, section + stamp(version(), datetime.now(UTC).date()))
            args.out.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
