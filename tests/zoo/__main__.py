"""`python -m tests.zoo`: a row for each animal, and what falls short; `--only NAME` those whose name holds this."""

from __future__ import annotations

import argparse
import sys
import time

from tests.zoo.animals import Judged
from tests.zoo.every import EVERY
from tests.zoo.running import judged
from tests.zoo.verdict import faults

HEAD = f"{'animal':50s} {'seed':>4s} {'kept':>7s} {'inside':>7s} {'U um':>9s} {'true 95 %':>9s}  holds\n"


def row(found: Judged) -> str:
    """Return what became of one animal in a line."""
    kept = "–" if found.kept is None else f"{found.kept.share:.1%}"
    how = found.interval
    figures = f"{'–':>7s} {'–':>9s} {'–':>9s}" if how is None else f"{how.inside:7.1%} {how.half:9.3g} {how.far:9.3g}"
    ends = "named" if found.named else "yes" if found.holds else "NO, withheld" if how is None else "NO"
    return f"{found.animal.name:50s} {found.seed:4d} {kept:>7s} {figures}  {ends}"


def main() -> int:
    """Return the exit status: 1 where something falls short."""
    parser = argparse.ArgumentParser(prog="python -m tests.zoo", description=__doc__)
    parser.add_argument("--only", action="append", metavar="NAME", help="whose name holds this; repeatable")
    parser.add_argument("--seeds", type=int, default=1, help="machines of each")
    parser.add_argument("--said", action="store_true", help="show what the program says of each")
    chosen = parser.parse_args()
    begun, every = time.monotonic(), list[Judged]()
    sys.stdout.write(HEAD)
    for animal in EVERY:
        if chosen.only and not any(word in animal.name for word in chosen.only):
            continue
        for seed in range(chosen.seeds):
            found = judged(animal, seed)
            every.append(found)
            sys.stdout.write(row(found) + "\n" + (f"{found.said}\n" if chosen.said else ""))
            sys.stdout.flush()
    short = faults(every)
    sys.stdout.write("".join(f"{line}\n" for line in short) + f"{time.monotonic() - begun:.0f} s\n")
    return 1 if short else 0


if __name__ == "__main__":
    sys.exit(main())
