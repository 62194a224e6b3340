"""What a set-up must say before readings can be asked for: where its instrument, that touches or looks, can read."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from axiscal.machine import Machine
from axiscal.measurement.setup import Setup

Lack = tuple[str, str]
"""What is not said, and what to add."""

_ONE_LINE = ("interferometer", "autocollimator")
_AT_BALL = 'Write artefact = "..." and [[artefacts]] with its place'
_LINE = "along = [...] with the two ends of a line"


def lack_of(setup: Setup, machine: Machine, reached: Collection[str], chosen: bool) -> Lack | None:
    """Return what a set-up does not say of where it can be read; None where it says enough.

    reached : names of the axes whose reach is stated; chosen : the axes that move are named, not all by default
    """
    if setup.chart is not None or setup.instrument in ("tracker", "tracer"):
        return None
    if setup.instrument in ("rtest", "sphere", "ballbar"):
        return _without_place(setup)
    moving = [machine.axes[k].name for k in setup.moves]
    unreached = [name for name in moving if name not in reached]
    if setup.instrument in ("straightedge", "probe"):
        return _without_reach(setup, unreached) if unreached else None
    if len(moving) == 1 or (setup.instrument not in _ONE_LINE and (chosen or not unreached)):
        return None
    return _of_many_axes(setup, moving)


def _without_place(setup: Setup) -> Lack:
    if setup.instrument == "ballbar":
        what = f'a ball bar reads at its own length from a centre, and "{setup.name}" does not state it'
        return what, 'Write length = "150 mm", and station or artefact for the centre'
    named = "an R-test" if setup.instrument == "rtest" else "a sphere probe"
    return f'{named} reads at a ball, and the set-up "{setup.name}" names none', _AT_BALL


def _of_many_axes(setup: Setup, moving: Sequence[str]) -> Lack:
    article = "an" if setup.instrument[0] in "aei" else "a"
    what = f'{article} {setup.instrument} follows one axis or one line: in "{setup.name}" {" ".join(moving)} may move'
    return what, f'Write moves = ["{moving[0] if moving else "X"}"], or {_LINE}'


def _without_reach(setup: Setup, axes: Sequence[str]) -> Lack:
    what = f'it is not said where along {" ".join(axes)} the {setup.instrument} of "{setup.name}" touches'
    remedy = 'Name the axis in moves, and where its reference reaches: reach = { X = ["150 mm", "450 mm"] }'
    return what, f"{remedy}; or {_LINE}" + ("; or an artefact with its balls" if setup.instrument == "probe" else "")
