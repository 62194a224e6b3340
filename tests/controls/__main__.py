"""`python -m tests.controls [--only NAME]`: every control that is here, a row each."""

import argparse
import sys
import time

from tests.controls.fetched import MissingError
from tests.controls.zoo import CONTROLS

HEAD = f"{'control':<20} {'version':<10} {'what was run':<50} {'off, %':>8} {'found -> left, um':>20}\n"


def main() -> int:
    """Return the exit status: 1 where a control does not do what its export says, or leaves more than 1 %."""
    parser = argparse.ArgumentParser(prog="python -m tests.controls", description=__doc__)
    parser.add_argument("--only", action="append", choices=list(CONTROLS), help="this control; repeatable")
    worst, begun = 0.0, time.monotonic()
    sys.stdout.write(HEAD)
    for name in parser.parse_args().only or CONTROLS:
        try:
            row = CONTROLS[name]()
        except MissingError as why:
            sys.stdout.write(f"{name:<20} left out: {why}\n")
            continue
        worst = max(worst, row.off, row.missed)
        change = f"{row.found:.0f} -> {row.left:.2g}"
        sys.stdout.write(f"{row.control:<20} {row.version:<10} {row.ran:<50} {row.off:>8.2g} {change:>20}\n")
        sys.stdout.flush()
    sys.stdout.write(f"{time.monotonic() - begun:.0f} s\n")
    return int(worst > 1)


if __name__ == "__main__":
    sys.exit(main())
