"""Measure side by side and write docs/evidence/peers.md: `make bench-peers`, or a part of it, which is only printed:

python -m benchmarks.peers --only trieste --case a --criterion joint
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

from benchmarks.peers.field import FIELD, Rival
from benchmarks.peers.judge import Outcomes
from benchmarks.peers.problems import CASES, CRITERIA, Posed, case_of
from benchmarks.peers.runner import ROOT, Bounds, keep, kept, run
from benchmarks.peers.table import line, page

PAGE = ROOT / "docs" / "evidence" / "peers.md"


def main() -> None:
    """Measure and write."""
    args = _arguments()
    bounds = Bounds(args.seconds, args.gigabytes * 1e9)
    outcomes = kept(args.keep) if args.keep else {}
    resumed = bool(outcomes)
    for rival, posed in _asked(args):
        at = (rival.key, posed.case.letter, posed.criterion)
        if at not in outcomes:
            outcomes[at] = run(rival, posed, bounds)
            if args.keep:
                keep(args.keep, outcomes[at])
        sys.stdout.write(f"({posed.case.letter}) {posed.criterion:6} {line(rival, posed, outcomes[at])}\n")
        sys.stdout.flush()
    if not (args.only or args.case or args.criterion):
        _write(outcomes, bounds, args.out, resumed)


def _asked(args: argparse.Namespace) -> Iterator[tuple[Rival, Posed]]:
    for criterion in CRITERIA:
        if args.criterion not in (None, criterion):
            continue
        for case in [case_of(args.case)] if args.case else CASES:
            for rival in FIELD:
                if not args.only or rival.key in args.only:
                    yield rival, Posed(case, criterion)


def _write(outcomes: Outcomes, bounds: Bounds, out: Path, resumed: bool) -> None:
    from benchmarks.peers.rivals.ours import picker

    out.write_text("\n".join(page(outcomes, picker, bounds, resumed)) + "\n", encoding="utf-8")
    sys.stdout.write(f"wrote {out}\n")


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.peers", description=__doc__)
    keys = [rival.key for rival in FIELD]
    parser.add_argument("--only", action="append", choices=keys, help="this one alone; can be given several times")
    parser.add_argument("--case", choices=[case.letter for case in CASES], help="this case alone")
    parser.add_argument("--criterion", choices=CRITERIA, help="this criterion alone")
    parser.add_argument("--seconds", type=float, default=600.0, help="limit for one library on one case")
    parser.add_argument("--gigabytes", type=float, default=8.0, help="limit for one library on one case")
    parser.add_argument("--keep", type=Path, help="a file for the outcomes; what it holds is not measured again")
    parser.add_argument("--out", type=Path, default=PAGE)
    return parser.parse_args()


if __name__ == "__main__":
    main()
