"""`python -m tests.zoo`: a row for each animal; `--only NAME` those whose name begins so, `--seeds 5` of each."""

from __future__ import annotations

import argparse
import sys
import time

from tests.zoo.every import EVERY
from tests.zoo.running import judged
from tests.zoo.showing import HEAD, row


def main() -> int:
    """Return how many animals the program fails."""
    parser = argparse.ArgumentParser(prog="python -m tests.zoo", description=__doc__)
    parser.add_argument("--only", action="append", metavar="NAME", help="whose name holds this; repeatable")
    parser.add_argument("--seeds", type=int, default=1, help="machines of each")
    parser.add_argument("--said", action="store_true", help="show what the program says of each")
    chosen = parser.parse_args()
    begun, failed = time.monotonic(), 0
    sys.stdout.write(HEAD)
    for animal in EVERY:
        if chosen.only and not any(word in animal.name for word in chosen.only):
            continue
        for seed in range(chosen.seeds):
            found = judged(animal, seed)
            failed += not found.holds
            sys.stdout.write(row(found) + "\n" + (f"{found.said}\n" if chosen.said else ""))
            sys.stdout.flush()
    sys.stdout.write(f"{failed} fail, {time.monotonic() - begun:.0f} s\n")
    return min(failed, 1)


if __name__ == "__main__":
    sys.exit(main())
