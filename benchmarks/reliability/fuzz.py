"""`make fuzz`: every reader, on files that hypothesis changes at random: an error of ours, or the file is still good.

What fails is shrunk to its smallest and printed.
"""

from __future__ import annotations

import argparse
import contextlib
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from axiscal.exceptions import AxiscalError
from benchmarks.reliability.bad_files import KINDS, Kind, place
from benchmarks.reliability.trial import scratch

_WORDS = st.sampled_from(
    [b"nan", b"1e400", b"-", b'"', b"'", b"[", b"]", b"{", b"=", b",", b"\n", b"\r", b"\0", b"\xff", b"9" * 400, b"um"]
)
_CHANGE = st.tuples(st.floats(0, 1), st.floats(0, 0.1), st.binary(max_size=12) | _WORDS)
CHANGES = st.lists(_CHANGE, max_size=6)
"""Where in a file, how much of it goes, and what comes in its place."""

MOST = 2.0
"""Seconds of a processor that a file may take; the clock would count what other programs take."""

Changes = Sequence[tuple[float, float, bytes]]


def changed(good: bytes, changes: Changes) -> bytes:
    """Return a file after changes."""
    for where, share, new in changes:
        begin = int(where * len(good))
        good = good[:begin] + new + good[begin + int(share * len(good)) :]
    return good


def fuzzed(kind: Kind, examples: int) -> None:
    """Read so many changed files of a kind; raises what a reader raises that is no error of ours."""
    with scratch() as top:
        path = place(kind, top)

        @settings(
            max_examples=examples,
            deadline=None,
            database=None,
            suppress_health_check=list(HealthCheck),
            phases=[Phase.generate, Phase.shrink],
        )
        @given(CHANGES)
        def read(changes: Changes) -> None:
            _read(kind, path, changed(kind.good, changes))

        read()


def _read(kind: Kind, path: Path, content: bytes) -> None:
    path.write_bytes(content)
    begin = time.process_time()
    with contextlib.suppress(AxiscalError):
        kind.read(path)
    if (spent := time.process_time() - begin) > MOST:
        raise AssertionError(f"a file of {len(content)} bytes took {spent:.1f} s of a processor")


def main(words: Sequence[str]) -> int:
    """Fuzz every reader and print how often."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--examples", type=int, default=5000, help="files of each kind")
    parser.add_argument("--seconds", type=float, default=0.0, help="of each kind; as many more files as they take")
    parser.add_argument("--kind", choices=[str(kind) for kind in KINDS], help="only files of this kind")
    args = parser.parse_args(words)
    for kind in KINDS:
        if args.kind not in (None, str(kind)):
            continue
        begin, read = time.monotonic(), 0
        while read == 0 or time.monotonic() < begin + args.seconds:
            fuzzed(kind, args.examples)
            read += args.examples
        sys.stdout.write(f"{kind}: {read:,} files, no failure, {time.monotonic() - begin:.0f} s\n")
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
