"""What a set-up must say before readings can be asked for: where its instrument, that touches or looks, can read."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.machine import Machine
from axiscal.measurement.setup import Setup

Lack = tuple[str, str]
"""What is not said, and what to add."""

_LOOKS_ALONG = ("interferometer", "indicator", "level", "autocollimator")
_AT_BALL = 'Write artefact = "..." and [[artefacts]] with its place'


def lack_of(setup: Setup, machine: Machine, reached: Sequence[str]) -> Lack | None:
    """Return what a set-up does not say of where it can be read; None where it says enough.

    reached : names of the axes whose reach is stated
    """
    if setup.chart is not None or setup.instrument in ("tracker", "tracer"):
        return None
    if setup.instrument in ("rtest", "sphere"):
        named = "an R-test" if setup.instrument == "rtest" else "a sphere probe"
        return f'{named} reads at a ball, and the set-up "{setup.name}" names none', _AT_BALL
    if setup.instrument == "ballbar":
        what = f'a ball bar reads at its own length from a centre, and "{setup.name}" does not state it'
        return what, 'Write length = "150 mm", and station or artefact for the centre'
    moving = [machine.axes[k].name for k in setup.moves]
    if setup.instrument in _LOOKS_ALONG:
        return _of_one_line(setup, moving)
    unreached = [name for name in moving if name not in reached]
    if setup.instrument == "straightedge" and unreached:
        return _without_reach(setup, unreached, 'Write reach = { X = ["150 mm", "450 mm"] }')
    if setup.instrument == "probe" and (unreached or len(moving) != 1):
        remedy = 'Write artefact = "..." for balls, along = [...] for a line, or moves = ["X"] with its reach'
        return _without_reach(setup, unreached or moving, remedy)
    return None


def _of_one_line(setup: Setup, moving: Sequence[str]) -> Lack | None:
    if len(moving) == 1:
        return None
    article = "an" if setup.instrument[0] in "aei" else "a"
    what = (
        f'{article} {setup.instrument} follows one axis or one line, and in "{setup.name}" {" ".join(moving)} may move'
    )
    return what, f'Write moves = ["{moving[0] if moving else "X"}"], or along = [...] with the two ends of a line'


def _without_reach(setup: Setup, axes: Sequence[str], remedy: str) -> Lack:
    what = f'it is not said where along {" ".join(axes)} the {setup.instrument} of "{setup.name}" touches'
    return what, remedy
