"""Run the certified campaign: `python -m tests.certify`, or one part of it: `--part one-joint --cases 10000`."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from itertools import product

import numpy as np

from axiscal_core.threads import one_thread
from tests.certify import (
    gcode,
    least_squares,
    machines,
    models,
    one_joint_cases,
    rows,
    simulator,
)
from tests.certify.kept import Kept

LIMIT = 1e-9
LATTICE = 1_000_000


Finding = tuple[str, bool]
"""One line of what was found, and whether it is within its limit."""


def one_joint(cases: int, first: int) -> Iterator[Finding]:
    """Yield how far the exact step falls short of the gain that ball arithmetic certifies, on random joints."""
    worst, misstated = (-1.0, -1), (-1.0, -1)
    for seed in range(first, first + cases):
        verdict = one_joint_cases.judged(one_joint_cases.random_problem(np.random.default_rng(seed)))
        worst, misstated = max(worst, (verdict.deficit, seed)), max(misstated, (verdict.misstated, seed))
    for what, (value, seed) in (("gain deficit", worst), ("error of the stated gain", misstated)):
        yield f"worst relative {what} {value:.2e} (seed {seed}), limit {LIMIT:g}", value <= LIMIT


def several_joints(cases: int, first: int) -> Iterator[Finding]:
    """Yield by how much the best of a million lattice poses beats the reading chosen, on random machines."""
    seeds = range(first, first + cases)
    short = [(machines.shortfall(machines.random_case(np.random.default_rng(s)), LATTICE), s) for s in seeds]
    missed = [seed for value, seed in short if value > LIMIT]
    worst = max(short)
    text = f"worst relative gain missed {worst[0]:.2e} (seed {worst[1]}), limit {LIMIT:g}, lattice of {LATTICE:,} poses"
    yield text, worst[0] <= LIMIT
    yield f"missed in {len(missed)} cases" + (f": seeds {missed[:10]}" if missed else ""), not missed


def random_models(cases: int, first: int) -> Iterator[Finding]:
    """Yield the error of means and standard deviations of random models, against ball arithmetic."""
    worst = max((models.error(models.random_model(np.random.default_rng(s))), s) for s in range(first, first + cases))
    text = f"worst relative error {worst[0]:.1e} (seed {worst[1]}), limit {models.LIMIT:g}"
    yield text, worst[0] <= models.LIMIT


def reference_regressions(cases: int, _first: int) -> Iterator[Finding]:
    """Yield the correct digits of NIST's regressions through a flat prior."""
    for name, asked in list(least_squares.DIGITS.items())[:cases]:
        found, deviations = least_squares.digits(name)
        more = f", of their standard deviations {deviations:.1f}" if np.isfinite(deviations) else ""
        text = f"{name}: correct digits of the coefficients {found:.1f}{more}, asked {asked:g}"
        yield text, min(found, deviations) >= asked


def rows_of_machines(machines: int, first: int) -> Iterator[Finding]:
    """Yield how often U of each kind of row holds the truth, on machines of the stated sizes and of others."""
    low, high = rows.CLAIMED - rows.SLACK, rows.CLAIMED + rows.SLACK
    for name, times in product(rows.CAMPAIGNS, rows.TIMES):
        found = [each for seed in range(first, first + machines) for each in rows.held(name, seed, times)]
        for kind in dict.fromkeys(each.kind for each in found):
            shares = [each.share for each in found if each.kind == kind]
            share, error = float(np.mean(shares)), float(np.std(shares)) / len(shares) ** 0.5
            text = f"{name}, {times:g} times the stated sizes, {kind}: {share:.1%} ± {error:.1%} of {len(shares)} rows"
            yield f"{text}; limits {low:.0%}, {high:.0%}", low <= share <= high


PARTS: dict[str, tuple[Callable[[int, int], Iterator[Finding]], int, str]] = {
    "one-joint": (one_joint, 10_000, "random joints"),
    "machines": (several_joints, 500, "random machines of two and three joints"),
    "models": (random_models, 500, "random models of up to 120 unknowns, up to 12 decades"),
    "regressions": (reference_regressions, len(least_squares.DIGITS), "certified regressions of NIST"),
    "gcode": (
        lambda plans, first: gcode.interpreter_verdicts(plans, first, Kept("gcode")),
        2_000,
        "random plans as programs for LinuxCNC's interpreter",
    ),
    "simulator": (
        lambda programs, first: simulator.verdicts(programs, first, Kept("simulator")),
        200,
        "programs of random machines on a running LinuxCNC",
    ),
    "dialects": (
        lambda plans, first: gcode.reader_verdicts(plans, first, Kept("dialects")),
        2_000,
        "random plans in every dialect, through the tests' own readers",
    ),
    "rows": (rows_of_machines, 200, "virtual machines of two how-tos: whether U of each row holds the truth"),
}


@one_thread()
def main() -> int:
    """Run the parts; status 1 if any finding is beyond its limit."""
    parser = argparse.ArgumentParser(prog="python -m tests.certify", description=main.__doc__)
    parser.add_argument("--part", choices=PARTS, help="only this part")
    parser.add_argument("--cases", type=int, help="how many, instead of the usual number of each part")
    parser.add_argument("--first", type=int, default=0, help="seed of the first case; case k has seed first + k")
    args = parser.parse_args()
    findings = [f for part in ([args.part] if args.part else PARTS) for f in _run(part, args.cases, args.first)]
    failed = sum(not good for _, good in findings)
    _print(f"{len(findings)} findings, {failed or 'none'} beyond the limit")
    return int(failed > 0)


def _run(part: str, cases: int | None, first: int) -> Iterator[Finding]:
    run, usual, what = PARTS[part]
    count, begin = cases or usual, time.monotonic()
    _print(f"{part}: {count:,} {what}")
    for text, good in run(count, first):
        _print(f"  {'holds ' if good else 'FAILS '} {text}")
        yield text, good
    _print(f"  {time.monotonic() - begin:.0f} s")


def _print(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
