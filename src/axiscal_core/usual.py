"""What usually goes wrong, and the sizes that readings may teach.

One table, `causes.toml`, has a row for each cause. A new one takes a row there, a kind in `theta`, its columns in
`causes`, and its words on screens.

Given the logarithms θ of the sizes all causes are Gaussian, y ~ N(0, K(θ)) with K(θ) = Σ_c s_c(θ)² B_c. A size is the
default, or what somebody stated, times exp θ: see `theta`.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from importlib import resources
from typing import TypeVar

import numpy as np

from axiscal_core.axes import Axis
from axiscal_core.errors import Error
from axiscal_core.machine import Machine
from axiscal_core.theta import SURE, Kind, Size, Sizes, Sure


@dataclass(frozen=True, slots=True)
class Cause:
    """One row of the table.

    name : as reports call it
    kernel : correlation, in words
    size : default standard deviation, in `unit`
    unit : what the default is a multiple of
    factor : one standard deviation of the logarithm of the size is log(factor); 1 for a size that is exact
    source : where the default comes from
    """

    name: str
    kernel: str
    size: float
    unit: str
    factor: float
    source: str

    @property
    def spread(self) -> float:
        """Scale of the logarithm of the size."""
        return math.log(self.factor)


_ROWS = tomllib.loads(resources.files(__package__).joinpath("causes.toml").read_text(encoding="utf-8"))
_CAUSES = {name: Cause(**row) for name, row in _ROWS.items()}
LENGTH, SCALE, ROUGH, REST = map(_CAUSES.__getitem__, ("length", "scale", "rough", "rest"))
REVERSAL, WAY, PITCH, TOGETHER = map(_CAUSES.__getitem__, ("reversal", "way", "pitch", "together"))
DRIFT, CYCLE, GROWTH, NOISE = map(_CAUSES.__getitem__, ("drift", "cycle", "growth", "noise"))
OFFSET, ANGLE, ANGLE_OF_PRINTER = map(_CAUSES.__getitem__, ("offset", "angle", "angle_of_printer"))
Built = TypeVar("Built", bound=Machine)
LENGTH_OF_TRAVEL = 0.25
"""Of the travel: the length of an error of which none is stated."""


def as_usual(machine: Built) -> Built:
    """Return a machine with what curves usually have and nobody stated: lengths, rests, scales, waves."""
    errors = [_usual_error(error, machine.axis(error.axis)) for error in machine.stated]
    stated, own = {error.name for error in errors}, [each for each in machine.errors if not isinstance(each, Error)]
    screws = [e for e in errors if e.period is not None and e.kind == "motion" and not e.repeats]
    waves = [Error(f"{e.name}_pitch", PITCH.size * e.std, period=e.period) for e in screws]
    return replace(machine, errors=(*errors, *(each for each in waves if each.name not in stated), *own))


def _usual_error(error: Error, axis: Axis) -> Error:
    white = REST.size * error.std if error.rest is None else error.rest
    rest = float(np.hypot(white, ROUGH.size * error.std))
    if error.sides:
        return replace(error, rest=rest, learnt_rest=False)
    if error.count < 2 or error.repeats or error.joints:
        return error
    positioning = not axis.rotary and error.name == axis.positioning_error
    scale = SCALE.size if error.scale is None and positioning else error.scale
    length = LENGTH_OF_TRAVEL * axis.length if error.length is None else error.length
    return replace(error, rest=rest, learnt_rest=False, scale=scale, length=length)


def sizes_of(
    machine: Machine, names: Sequence[str], sure: Sure, *, usual: bool, inherited: bool = False,
    wandering: Sequence[str] = (),
) -> Sizes:  # fmt: skip
    """Return the sizes that vary: one factor for errors that are alike.

    names : of the set-ups; wandering : of those whose zero is stated to drift
    sure : how well stated sizes are known where an error does not say; usual : with what usually goes wrong
    inherited : the errors' prior is an earlier campaign's, whose sizes stay
    """
    found = [] if inherited else [*_of_errors(machine, sure)]
    found += [Size("rest", owners, ROUGH.spread) for owners in _rests(machine, usual)]
    if usual:
        passing: tuple[tuple[Kind, float], ...] = (
            ("drift", DRIFT.spread), ("cycle", CYCLE.spread), ("growth", GROWTH.spread)
        )  # fmt: skip
        found += [Size(kind, tuple(names), spread) for kind, spread in passing]
        turning = [e.name for e in machine.stated if e.kind == "reversal" and not machine.axis(e.axis).rotary]
        found += [Size("way", tuple(turning), WAY.spread)] if turning else []
    elif sure != "exactly" and wandering:
        found.append(Size("drift", tuple(wandering), DRIFT.spread))
    if usual or sure != "exactly":
        found += [Size("noise", (name,), NOISE.spread) for name in names]
    return Sizes(tuple(found))


def _of_errors(machine: Machine, sure: Sure) -> Iterator[Size]:
    """Yield the factors on sizes and lengths of errors."""
    kinds: tuple[tuple[Kind, float], ...] = (
        ("std", SURE["roughly"]), ("length", LENGTH.factor), ("scale", SCALE.factor), ("reversal", REVERSAL.factor)
    )  # fmt: skip
    for kind, most in kinds:
        groups = dict[tuple[float, tuple[bool, ...]], list[str]]()
        for entry in (each for each in machine.stated if not each.sides):
            key, factor = _alike(entry, kind, machine), min(SURE[entry.sure or sure], most)
            if key is not None and factor > 1:
                groups.setdefault((factor, key), []).append(entry.name)
        for (factor, _), names in groups.items():
            yield Size(kind, tuple(names), float(np.log(factor)))
    planes = [error for error in machine.stated if error.sides]
    if planes and sure != "exactly":
        yield Size("together", tuple(entry.name for entry in planes), TOGETHER.spread)
        if stated := tuple(entry.name for entry in planes if not entry.usual and entry.std):
            yield Size("length", stated, LENGTH.spread)


def _alike(entry: Error, kind: Kind, machine: Machine) -> tuple[bool, ...] | None:
    """Return what errors have in common that share a size of a kind; None where an error has no such size."""
    rotary = machine.axis(entry.axis).rotary
    if entry.kind != ("reversal" if kind == "reversal" else "motion"):
        return None
    if kind == "scale":
        return (rotary,) if entry.scale else None
    if kind == "length":
        return (rotary,) if entry.length is not None else None
    return (rotary, entry.angular, entry.repeats)


def _rests(machine: Machine, usual: bool) -> list[tuple[str, ...]]:
    """Return the names of errors that share the size of their rough part: all with usual causes, else some."""
    groups = dict[object, list[str]]()
    for entry in machine.stated:
        if entry.first_rest > 0 and (usual or entry.learnt_rest):
            alike = "together" if entry.sides else machine.axis(entry.axis).rotary
            groups.setdefault(alike, []).append(entry.name)
    return [tuple(names) for names in groups.values()]
