"""Write docs/trust.md: `python -m benchmarks.trust` (ten minutes), with --machines 40 --learnt 10 a minute."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

from axiscal.numerics.threads import one_thread
from benchmarks.trust.curves import CASES, DATA, iso_test
from benchmarks.trust.measured import Outcome, iso_outcome, outcomes
from benchmarks.trust.virtual import READINGS, Coverage, Moved, covered, gross

PAGE = Path(__file__).resolve().parents[2] / "docs" / "trust.md"
_SIZES = (3e-6, 5e-6, 7e-6, 10e-6, 20e-6, 50e-6, 1e-3)

_HEAD = """# Can you trust it?

Every figure the program prints has a ±. This page says how often the truth lies within it: on virtual machines, where
the model is right by construction or wrong on purpose, and on curves that others have measured on real machines, where
no model is right. `make trust` writes it anew; nothing here is typed by hand.

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
not fitted, but chosen by somebody who knew the files; `scales = "estimate"` is on. How far learnt bands are widened
was settled with these curves and the wrong priors above in view, on the same seeds, so neither is a test on fresh
data: the X slide rose from 85 % to 91 %, the tool point of the mill at ÷ 3 from 90 % to 92 %. *Missed* is the RMS of
truth minus estimate, *band* the RMS of the printed
standard deviation, *said* the warnings in the report. Random points: the mean of three draws.

| curve | readings | points | in the band | missed | band | said |
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
    return f"| {name} | {readings} | {outcome.design} | {outcome.share:.1%} | {sizes} | {said} |"


def _gross_row(moved: Moved) -> str:
    shifts = f"{moved.typical:.2f} σ | {moved.worst:.2f} σ | {moved.within:.0%}"
    alone = f"{moved.bent:.2f} σ | {moved.straight:.0%} | {moved.naive:.3g} σ"
    return f"| {moved.size * 1e6:g} µm | {moved.rejected:.0%} | {shifts} | {alone} |"


def page(machines: int, learnt: int, trials: int) -> Iterator[str]:
    """Yield the page line by line as the figures come in."""
    yield _HEAD + _VIRTUAL.rstrip("\n")
    for name, count in (("one-axis", machines), ("three-axis-mill", max(20, machines // 10))):
        yield _virtual_row(covered(name, 1.0, count))
    for name, count in (("one-axis", learnt), ("three-axis-mill", max(5, learnt // 10))):
        yield from (_virtual_row(covered(name, wrong, count)) for wrong in (1 / 3, 3.0))
    if DATA.is_dir():
        yield from _measured()
    yield _GROSS.format(trials=trials).rstrip("\n")
    yield from (_gross_row(gross(size, trials)) for size in _SIZES)


def _measured() -> Iterator[str]:
    yield _MEASURED.rstrip("\n")
    test = iso_test()
    outcome, _ = iso_outcome(test)
    yield _measured_row("X slide: ISO 230-2 test against dense passes", len(test.readings), outcome, "µm")
    for make in CASES:
        case = make()
        unit = "µrad" if case.unit == "urad" else "µm"
        yield from (_measured_row(case.name, case.readings, outcome, unit) for outcome in outcomes(case))


def _written(lines: Iterable[str], path: Path) -> None:
    kept = []
    for line in lines:
        sys.stdout.write(line + "\n")
        sys.stdout.flush()
        kept.append(line)
    path.write_text("\n".join(kept) + "\n", encoding="utf-8")


@one_thread()
def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.trust", description=__doc__)
    parser.add_argument("--machines", type=int, default=2000, help="virtual machines with the right prior")
    parser.add_argument("--learnt", type=int, default=200, help="virtual machines with wrong priors")
    parser.add_argument("--trials", type=int, default=100, help="machines with a bad reading")
    parser.add_argument("--out", type=Path, default=PAGE)
    args = parser.parse_args()
    _written(page(args.machines, args.learnt, args.trials), args.out)


if __name__ == "__main__":
    main()
