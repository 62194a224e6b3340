"""Write docs/trust.md: `python -m benchmarks.trust` takes half an hour, with --machines 40 --learnt 10 a minute.

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
from benchmarks.trust.attack_table import FIRST, attack_rows, attacked, beginning_with, goal_lines
from benchmarks.trust.causes import cause_rows
from benchmarks.trust.curves import CASES, DATA, iso_test
from benchmarks.trust.displays import display_rows
from benchmarks.trust.iso_tests import iso_rows
from benchmarks.trust.kept import Keeping
from benchmarks.trust.measured import ENOUGH, Outcome, iso_outcome, outcomes
from benchmarks.trust.sources import version
from benchmarks.trust.virtual import READINGS, Coverage, Moved, covered, gross

PAGE = Path(__file__).resolve().parents[2] / "docs" / "trust.md"
_ATTACKED = 24
_ONLY = "one bad reading; three bad readings; bump of 30 mm; a fifth as smooth; nothing"
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
Drawn from a prior, read with noise through their full non-linear kinematics, estimated. "Prior ×3" means that every
stated standard deviation was three times the true one. Where the prior is wrong, `scales = "estimate"` was on; *said*
is the share of machines (of the first forty) whose report says that the prior or the curve does not fit. With the right
prior that is a false alarm.

| machine | readings | prior | machines | curves | tool point | said |
|---|---|---|---|---|---|---|
"""

_MEASURED = """
## Measured curves
A few readings of a curve or map that was measured densely; the rest of it is the truth. The priors are round figures,
not fitted, but chosen by somebody who knew the files; `scales = "estimate"` is on, and the bands average over all
scales that the readings leave possible. On maps what two axes do together is no sum of their curves: what is learnt
beyond the stated noise counts in the band there, a rule that was settled with these maps in view. *Missed* is the RMS
of truth minus estimate, *band* the RMS of the printed standard deviation, both as the verdict leaves them; *said* the
warnings in the report. Random points: the mean of three draws, with all verdicts that they had. Of the plug plate no
hole is read twice there: by how much holes scatter is taken for noise where that much noise is stated, and the promise,
which is without noise, then rests on that statement: it is `unchecked` where it is small beside that noise.

| curve | readings | points | in the band | missed | band | verdict | said |
|---|---|---|---|---|---|---|---|
"""

_ISO = """
## ISO 230-2 tests
Real tests of five runs each way, std 30 µm, smooth over two spacings, noise 2 µm stated. *Left*: the largest mean
reading of a target that the table made of them does not take away. *Limit*: two standard errors of such a mean.
*Promised*: RMS over the axis, what lies between the targets included. *Draws*: how many good draws of the scales the
band averages over. (`make trust PART=iso`)

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

_CAUSES = """
## What contradicts the model
One axis of 1 m, curve 10 µm smooth over 200 mm, noise 0.5 µm, {readings} readings out and back at random places, one a
minute, {machines} machines. *Said*: the readings contradict the model by odds of twenty to one, looked at after every
reading; with nothing wrong that happens in at most one of twenty. *Right*: of these, the likeliest cause is the one
that was put in. A bad reading and a detail that one reading alone meets are the same to these readings, until there
is another one at that place. (`make trust PART=causes`)

| put in | said | right |
|---|---|---|
"""

_ATTACKS = """
## Attacks
{machines} machines in each cell, of seeds {first} and following. The first twelve were looked at while this was made:
what gaps may hide, how the five axes state their tool, and that a reading is left out only where it is itself the bad
one, by nine to one, were settled with them; the others nobody had seen
before. An axis of 1 m (curve 10 µm over 200 mm, noise 0.5 µm, the laser's zero unknown), 24 readings, one a minute,
out and back; two axes of 400 mm under a probe, 24 readings; five axes under an R-test at three spheres, 24 readings.
*Planned*: where a plan asks for readings; *even* and *random* places as well. *Learnt*: `scales = "estimate"`. In
each cell: the ratio of true to promised RMS (geometric mean), the share of the volume that is no farther off than the
U that is promised, the share of machines under the verdict `holds`, and the share of **silent** ones with its 95 %
limits (Clopper and Pearson): truth above 1.5 times the promise under the verdict `holds`. *Beyond*: where that is
another share, that of silent machines that are also farther off than the promise itself leaves to one machine in
fifty. "Refused": the file is, every time. What turns the sign of all readings no reading can show; `axiscal verify`
must. Axis lines are stated to 15 µm and the tool to 5 µm, but where it is too long: there it is not measured, and known
to 100 µm as the program takes it. Where rotary axes carry the workpiece a longer tool looks like an axis line that lies
elsewhere, and no reading of the spheres can tell the two apart: the promise then holds both, and most of it is that one
unknown, which is above 1.5 times the promise in 13 % of machines where everything is right, and above U in 5 %: it
rests on what is stated alone, and is `unchecked`. With the tool stated to 5 µm so much still is of tool and axis lines
together, and of right machines more than one in fifty is 1.5 times as far off for it: `unchecked` as well where scales
are stated (known to 2 µm the tool leaves little enough). Whoever states the tool to 5 µm while it is 50 µm longer is
told no more than that. Where scales are learnt they make room for what is wrong. So a departure with the scales as
stated is compared with them too, and a reversal that varies is mostly found; where a larger rest explains two dozen
readings as well, some such machines stay silent. Even and random places leave gaps in which a step or a bump could
hide, and a verdict is `unchecked` for it on right machines too: a plan leaves none.
(`make trust PART=attacks MACHINES={machines}`; it goes on where it was stopped, and `MINUTES=30` stops it.)

| put in | planned, stated | planned, learnt | even, stated | even, learnt | random, stated | random, learnt |
|---|---|---|---|---|---|---|
"""

_AGAIN = """
## Attacks, some of them once more
The same cells for some attacks, {machines} machines each, with the seeds of the table above and other sources: what a
change does is seen so, before the whole table is made anew. (`make trust PART=again MACHINES={machines} ONLY="{only}"`)

| put in | planned, stated | planned, learnt | even, stated | even, learnt | random, stated | random, learnt |
|---|---|---|---|---|---|---|
"""

_GROSS = """
## One bad reading
Thirty readings of a one-axis machine (noise 1 µm, curve 10 µm), one of them wrong. How far the curves move, in units
of the σ printed beside them: largest over the curve, the median and the worst of {trials} machines. Every noise is
Student-t of four degrees of freedom, and a reading that the others contradict by four σ is not used and is named in
the report; an error too small to be told from the curve itself cannot be found by any method. *From the right
estimate*: beside what the right reading would have given, so that what is left of a large error is the information
that the reading would have brought. *From the others*: beside the estimate of the other 29, which is what the error
itself does.

| error | found | from the right one: median | worst | at most σ/2 | from the others: worst | at most σ/2 | believed |
|---|---|---|---|---|---|---|---|
"""


def _virtual_row(found: Coverage) -> str:
    wrong = {1.0: "right", 3.0: "× 3"}.get(found.wrong, "÷ 3")
    share = f"{found.curves:.1%} ± {found.error:.1%}"
    count = READINGS[found.machine]
    return (
        f"| {found.machine} | {count} | {wrong} | {found.machines} | {share} | {found.tcp:.1%} | {found.misfit:.0%} |"
    )


def _measured_row(name: str, readings: int, outcome: Outcome, unit: str) -> str:
    sizes = f"{outcome.rms:.3g} {unit} | {outcome.std:.3g} {unit}"
    said = ", ".join(flag for flag in outcome.flags if flag != "unobservable") or "–"
    words = ", ".join(outcome.words)
    return f"| {name} | {readings} | {outcome.design} | {outcome.share:.1%} | {sizes} | {words} | {said} |"


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
    for name, count in (("one-axis", args.machines), ("three-axis-mill", max(20, args.machines // 10))):
        yield _virtual_row(covered(name, 1.0, count, keeping))
    for name, count in (("one-axis", args.learnt), ("three-axis-mill", max(5, args.learnt // 10))):
        yield from (_virtual_row(covered(name, wrong, count, keeping)) for wrong in (1 / 3, 3.0))


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
    held, good = sum(each.share >= ENOUGH for each in every), sum(each.good for each in every)
    wide = float(np.exp(np.mean([np.log(each.std / each.rms) for each in every])))
    yield f"\nOf {len(every)} rows {held} have 90 % of the truth in the band, and {good} have it or say `holds` of no"
    yield f"estimate. Band over missed, the geometric mean over all rows: {wide:.2f}."


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


def _causes(args: argparse.Namespace) -> Iterator[str]:
    yield _CAUSES.format(machines=args.trials, readings=_ATTACKED).strip("\n")
    yield from cause_rows(args.trials, _ATTACKED, _keeping(args, "causes", "causes.py"))


def _attacks(args: argparse.Namespace) -> Iterator[str]:
    kept, machines = attacked(args.attacked, args.processes, 60 * args.minutes)
    if not machines:
        return
    yield _ATTACKS.format(machines=machines, first=FIRST).strip("\n")
    yield from attack_rows(kept, machines)
    yield from goal_lines(kept, machines)


def _again(args: argparse.Namespace) -> Iterator[str]:
    which = beginning_with(args.only.split("; "))
    kept, machines = attacked(args.attacked, args.processes, 60 * args.minutes, which)
    if not machines:
        return
    yield _AGAIN.format(machines=machines, only=args.only).strip("\n")
    yield from attack_rows(kept, machines, which)


PARTS: dict[str, Callable[[argparse.Namespace], Iterator[str]]] = {
    "virtual": _virtual,
    "measured": _measured,
    "iso": _iso,
    "gross": _gross,
    "display": _displays,
    "causes": _causes,
    "attacks": _attacks,
    "again": _again,
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


def without(page: str, heading: str) -> str:
    """Return a page without the section of a heading."""
    before, _, after = page.partition(heading + "\n")
    _, following, rest = after.partition("\n## ")
    return f"{before}## {rest}" if following else before.rstrip() + "\n"


@one_thread()
def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.trust", description=__doc__)
    parser.add_argument("--machines", type=int, default=2000, help="virtual machines with the right prior")
    parser.add_argument("--learnt", type=int, default=200, help="virtual machines with wrong priors")
    parser.add_argument("--trials", type=int, default=100, help="machines with something wrong, of each kind")
    parser.add_argument("--attacked", type=int, default=100, help="machines in each cell of the attack table")
    parser.add_argument("--only", default=_ONLY, help="of the attacks made again, how they begin, parted by '; '")
    parser.add_argument("--processes", type=int, default=processors_here(), help="that try virtual machines at once")
    parser.add_argument("--minutes", type=float, default=math.inf, help="after which no more machines are attacked")
    parser.add_argument("--part", choices=list(PARTS), help="only this section, the others stay as they are")
    parser.add_argument("--out", type=Path, default=PAGE)
    args = parser.parse_args()
    page = args.out.read_text(encoding="utf-8") if args.part else _HEAD
    for name in [args.part] if args.part else [each for each in PARTS if each != "again"]:
        section = _told(PARTS[name](args))
        page = renewed(page, section + stamp(version(), datetime.now(UTC).date())) if section.strip() else page
        page = without(page, _AGAIN.splitlines()[1]) if name == "attacks" else page
        args.out.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
