"""How many calls the main paths take: not how long, which depends on the machine, but how much they ask for."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType

import pytest

import axiscal
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits
from tests.generators.designs import levered, splines
from tests.planning.test_three_values import mixed


def _calls(work: Callable[[], object]) -> int:
    """Return how often a piece of work enters functions of axiscal, and how often these call what is compiled."""
    count, folder = 0, axiscal.__path__[0]

    def counted(frame: FrameType, event: str, _: object) -> None:
        nonlocal count
        count += event in ("call", "c_call") and frame.f_code.co_filename.startswith(folder)

    before = sys.getprofile()
    sys.setprofile(counted)
    try:
        work()
    finally:
        sys.setprofile(before)
    return count


PATHS: dict[str, tuple[Callable[[], object], int]] = {
    "a plan of one axis": (lambda: make_plan(splines(1, 7, 0.1, 500), Limits(readings=12)), 94_000),
    "a plan with levers": (lambda: make_plan(levered(200), Limits(readings=6), patience=0.0), 39_000),
    "a plan of two kinds of instruments, with its bound": (
        lambda: make_plan(mixed(150), Limits(readings=6), patience=0.0),
        59_000,
    ),
}
"""What is done, and how many calls it took when this was written, with a few more."""


@pytest.mark.long
@pytest.mark.parametrize("name", PATHS)
def test_the_main_paths_ask_for_no_more_than_they_did(name: str) -> None:
    work, most = PATHS[name]
    work()  # what is found once and remembered does not count
    assert _calls(work) <= most
