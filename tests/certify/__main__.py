"""Run the certified campaign: `python -m tests.certify --cases 10000`."""

from __future__ import annotations

import argparse
import sys
import time

import numpy as np

from tests.certify.one_joint_cases import judged, random_problem

LIMIT = 1e-9


def main() -> int:
    """Judge that many random joints; status 1 if one falls short of the certified best gain by more than 1e-9."""
    parser = argparse.ArgumentParser(prog="python -m tests.certify", description=main.__doc__)
    parser.add_argument("--cases", type=int, default=10000)
    parser.add_argument("--first", type=int, default=0, help="seed of the first case; case k has seed first + k")
    args = parser.parse_args()
    begin, worst, misstated = time.monotonic(), (-1.0, -1), (-1.0, -1)
    for seed in range(args.first, args.first + args.cases):
        verdict = judged(random_problem(np.random.default_rng(seed)))
        worst, misstated = max(worst, (verdict.deficit, seed)), max(misstated, (verdict.misstated, seed))
    lines = (
        f"one joint: {args.cases} cases in {time.monotonic() - begin:.0f} s",
        f"  worst relative gain deficit {worst[0]:.2e} (seed {worst[1]}), limit {LIMIT:g}",
        f"  worst relative error of the stated gain {misstated[0]:.2e} (seed {misstated[1]}), limit {LIMIT:g}",
    )
    sys.stdout.write("\n".join(lines) + "\n")
    return int(max(worst[0], misstated[0]) > LIMIT)


if __name__ == "__main__":
    sys.exit(main())
