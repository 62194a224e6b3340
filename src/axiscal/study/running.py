"""Running a study: what is not there yet is worked on, and kept as it comes."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import closing
from itertools import chain
from typing import NamedTuple

from axiscal.study.results import Results
from axiscal.study.work import Engine, Solve, WorkItem

Watch = Callable[[int, int], None]
"""How many are done, of how many that were missing."""


class Ran(NamedTuple):
    """there : cases that were there before; computed : now; failed : of all"""

    there: int
    computed: int
    failed: int


def run_missing(
    results: Results,
    items: Iterable[WorkItem],
    count: int,
    solve: Solve,
    engine: Engine,
    watch: Watch = lambda done, of: None,
) -> Ran:
    """Work on all items that have no result yet, and keep what comes of them; each is on the disk at once.

    count : of all items.  Raises StudyError, SchedulerError, KeyboardInterrupt; what was kept is kept.
    """
    there = results.keys()
    missing, done = count - len(there), 0
    left = (item for item in items if item.key not in there)
    first = next(left, None)
    if first is not None:  # an engine takes seconds to begin
        watch(0, missing)
        with closing(engine(solve, chain([first], left))) as coming:
            for found in coming:
                results.keep(found)
                done += 1
                watch(done, missing)
    failed = sum(found.result is None for found in results.all().values())
    return Ran(len(there), done, failed)
