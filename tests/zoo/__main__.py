"""`python -m tests.zoo`: a row for each animal, and what falls short; `--only NAME` those whose name holds this."""

from __future__ import annotations

import argparse
import sys
import time

from tests.zoo.animals import Judged
from tests.zoo.every import EVERY
from tests.zoo.running import judged
from tests.zoo.showing import HEAD, row
from tests.zoo.verdict import faults


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
