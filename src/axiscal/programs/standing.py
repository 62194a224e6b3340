"""What a program says of what stands where: at its head, and at the stop where something is put there."""

from __future__ import annotations

from collections.abc import Iterator

from axiscal.measurement.bodies import parts
from axiscal.measurement.setup import Setup
from axiscal.units import to_unit
from axiscal_core.machine import Machine

CLEAR = "PRESS START WHEN THE WAY TO THE START IS CLEAR"
"""What the first stop is for."""
_NAME, _BALL = 30, 12
"""Characters of the name of an artefact and of a ball, so that what is to be said of it stays on the screen."""
_FAR = 10.0
"""m, where a box has no end."""
_MOST = 12
"""Balls that are named."""


def mounting(setup: Setup) -> str:
    """Return what is to be done at the stop before the first reading."""
    if setup.artefact is not None and setup.contact == "retracted":
        return f"PUT DOWN {setup.artefact.name[:_NAME]} THEN PRESS START"
    return "MOUNT AND ZERO THE INSTRUMENT THEN PRESS START"


def standing(machine: Machine, setup: Setup) -> Iterator[str]:
    """Yield what is assumed to stand where, mm in the workpiece frame, and the size of what moves among it."""
    artefact = setup.artefact
    balls = artefact.balls if artefact is not None and artefact.diameter is not None else ()
    boxes = () if artefact is None else artefact.keep_out
    for ball in balls[:_MOST]:
        yield f"BALL {ball.name[:_BALL]} AT {_mm(ball.place)} AND ITS POST"
    if len(balls) > _MOST:
        yield f"AND {len(balls) - _MOST} MORE BALLS WITH THEIR POSTS"
    for box in boxes:
        ends = (
            f"{axis} {_mm((low,))} TO {_mm((high,))}"
            for axis, (low, high) in zip("XYZ", box, strict=True)
            if high < _FAR
        )
        yield f"KEPT OUT {' '.join(ends)}"
    if artefact is not None and artefact.balls and not balls:
        yield "NOTHING KEEPS CLEAR OF THE BALLS AS NOBODY SAID HOW LARGE THEY ARE"
    yield f"IT IS ASSUMED THAT NOTHING {'ELSE ' if balls or boxes else ''}STANDS IN THE WAY"
    if balls or boxes:
        each = zip(
            ("STYLUS", "HOLDER", "NOSE") if machine.nose.stylus > 0 else ("TOOL", "NOSE"), parts(machine), strict=False
        )
        yield from (f"{name} {_mm((2 * part.radius,))} WIDE UP TO {_mm((part.stop,))}" for name, part in each)
    if (balls or boxes) and not machine.nose.head:
        yield "THE SIZE OF THE SPINDLE NOSE IS NOT KNOWN"


def _mm(lengths: tuple[float, ...]) -> str:
    return " ".join(f"{to_unit(length, 'mm'):.1f}" for length in lengths)
