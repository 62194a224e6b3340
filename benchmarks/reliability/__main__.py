"""`make reliability`: every trial, and one table; `--long` as docs/evidence/reliability.md has the longer runs."""

from __future__ import annotations

import argparse
import math
import os
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import partial
from typing import Any

from benchmarks.reliability import (
    bad_files,
    bounds,
    changed,
    command_faults,
    damages,
    forged,
    power_loss,
    record_faults,
    same_bytes,
    set_faults,
    stuck_instruments,
    writers,
)
from benchmarks.reliability.kept import Kept
from benchmarks.reliability.trial import DISK, Trial


def trials(long: bool, pythons: Sequence[str]) -> Sequence[Callable[[], Trial]]:
    """Return what is tried, in the order of the table."""
    return (
        record_faults.begun,
        record_faults.written,
        record_faults.read,
        lambda: set_faults.alone(True),
        lambda: set_faults.alone(False),
        set_faults.with_others,
        lambda: command_faults.all_tried(1 if long else 20),
        lambda: writers.killed(5000 if long else 300),
        lambda: power_loss.lost(20_000 if long else 2000),
        changed.bits,
        changed.ends,
        changed.clock,
        lambda: writers.at_once(8, 10_000 if long else 250),
        lambda: writers.on_a_share(5000 if long else 500),
        lambda: changed.many(100_000),
        changed.large,
        bad_files.read_all,
        lambda: same_bytes.compared(long, pythons),
        lambda: damages.every(420 if long else 100),
        lambda: forged.tried(10_000),
        lambda: stuck_instruments.named(125),
        bounds.token,
        lambda: bounds.unused(12),
        bounds.sizes,
        lambda: bounds.seconds(200),
    )


def main(words: Sequence[str]) -> int:
    """Print the table as it grows; return 1 if anything was lost."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--long",
        action="store_true",
        help="for a release: hours; rows that are done are kept",
    )
    parser.add_argument("--again", action="store_true", help="also what was tried on these sources before")
    parser.add_argument("--minutes", type=float, default=math.inf, help="no new row is begun after so many")
    parser.add_argument("--row", type=int, action="append", help="only this row of the table, from 1")
    parser.add_argument("--python", action="append", default=[], help="an interpreter with what the package needs")
    args = parser.parse_args(words)
    print("|row|what was tried|how many|lost or wrong||\n|---|---|---|---|---|", flush=True)
    begin, lost, kept = time.monotonic(), 0, Kept("reliability-long" if args.long else "reliability")
    for number, tried in enumerate(trials(args.long, args.python)):
        if args.row and number + 1 not in args.row:
            continue
        if time.monotonic() - begin > 60 * args.minutes:
            print("The same command goes on here.", flush=True)
            break
        find = partial(_dated, tried)
        found = (
            find()
            if args.again or not args.long
            else kept.get(f"{number} {args.python}{os.environ.get(DISK, '')}", find)
        )
        trial = Trial(**found)
        lost += trial.lost
        print(f"|{number + 1}|{trial.what}|{trial.tried:,}|{trial.lost:,}|{trial.detail}|", flush=True)
    print(f"\n{time.monotonic() - begin:.0f} s", flush=True)
    return 1 if lost else 0


def _dated(tried: Callable[[], Trial]) -> dict[str, Any]:
    """Return a trial as JSON can hold it."""
    return asdict(tried())


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
