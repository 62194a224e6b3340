"""A machine with what usually goes wrong, the sizes that readings may teach, and a machine with the sizes as learnt."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from axiscal.estimate.model import CYCLE, DRIFT, GROWTH, LENGTH, NOISE, REST, REVERSAL, ROUGH, SURE, TOGETHER
from axiscal.estimate.sizes import Kind, Size, Sizes
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.machine.entry import ErrorEntry, Sure
from axiscal.machine.plane_entry import PlaneEntry
from axiscal.measurement.setup import Setup

_LENGTH = 0.25
"""Of the travel: the length of an error of which none is stated."""


def usual_machine(machine: Machine) -> Machine:
    """Return the machine with the usual length of each curve, and with its rough part."""
    errors = tuple(_as_usual(entry, machine.axis(entry.axis)) for entry in machine.errors)
    return replace(machine, errors=errors, planes=tuple(_rough_plane(entry) for entry in machine.planes))


def _as_usual(entry: ErrorEntry, axis: Axis) -> ErrorEntry:
    if entry.constant or entry.harmonics or entry.joints:
        return entry
    white = REST.size * entry.std if entry.rest is None else entry.rest
    rest = float(np.hypot(white, ROUGH.size * entry.std))
    return replace(entry, length=entry.length or _LENGTH * axis.length, rest=rest, rest_estimated=False)


def _rough_plane(entry: PlaneEntry) -> PlaneEntry:
    white = REST.size * entry.std if entry.rest is None else entry.rest
    return replace(entry, rest=float(np.hypot(white, ROUGH.size * entry.std)), rest_estimated=False)


class Learnable(NamedTuple):
    """Which sizes may be learnt.

    sure : how well stated sizes are known where an error does not say; usual : with what usually goes wrong
    inherited : the errors' prior is an earlier campaign's, whose sizes stay
    """

    sure: Sure
    usual: bool
    inherited: bool


def sizes_of(machine: Machine, setups: Sequence[Setup], may: Learnable) -> Sizes:
    """Return the sizes that vary: one factor for errors that are alike."""
    found = [] if may.inherited else [*_of_errors(machine, may.sure)]
    found += [Size("rest", owners, ROUGH.spread) for owners in _rests(machine, may.usual)]
    names = tuple(setup.name for setup in setups)
    if may.usual:
        passing: tuple[tuple[Kind, float], ...] = (
            ("drift", DRIFT.spread), ("cycle", CYCLE.spread), ("growth", GROWTH.spread)
        )  # fmt: skip
        found += [Size(kind, names, spread) for kind, spread in passing]
    if may.usual or may.sure != "exactly":
        found += [Size("noise", (name,), NOISE.spread) for name in names]
    return Sizes(tuple(found))


def _of_errors(machine: Machine, sure: Sure) -> Iterator[Size]:
    """Yield the factors on sizes and lengths of errors."""
    for kind, most in (("std", SURE["roughly"]), ("length", LENGTH.factor), ("reversal", REVERSAL.factor)):
        groups = dict[tuple[object, ...], list[str]]()
        for entry in machine.errors:
            known = entry.sure or sure
            if known != "exactly" and (key := _alike(entry, kind, machine)) is not None:
                groups.setdefault((known, *key), []).append(entry.name)
        for (known, *_), names in groups.items():
            yield Size(kind, tuple(names), float(np.log(min(SURE[known], most))))  # type: ignore[arg-type,index]
    if machine.planes and sure != "exactly":
        yield Size("together", tuple(entry.name for entry in machine.planes), TOGETHER.spread)


def _alike(entry: ErrorEntry, kind: str, machine: Machine) -> tuple[bool, ...] | None:
    """Return what errors have in common that share a size of a kind; None where an error has no such size."""
    rotary = machine.axis(entry.axis).rotary
    if entry.kind != ("reversal" if kind == "reversal" else "motion"):
        return None
    if kind == "length":
        return (rotary,) if entry.length is not None else None
    return (rotary, entry.parts.angular)


def _rests(machine: Machine, usual: bool) -> list[tuple[str, ...]]:
    """Return the names of errors that share the size of their rough part: all with usual causes, else those to learn."""
    groups = dict[bool, list[str]]()
    for entry in machine.errors:
        if entry.first_rest > 0 and (usual or entry.rest_estimated):
            groups.setdefault(machine.axis(entry.axis).rotary, []).append(entry.name)
    planes = [entry.name for entry in machine.planes if entry.first_rest > 0 and (usual or entry.rest_estimated)]
    return [tuple(names) for names in (*groups.values(), planes) if names]


def rescaled_machine(machine: Machine, sizes: Mapping[tuple[Kind, str], float]) -> Machine:
    """Return the machine with its priors at other sizes.  sizes : factors by kind and owner"""
    errors = tuple(_rescaled(entry, machine.axis(entry.axis), sizes) for entry in machine.errors)
    planes = tuple(
        replace(
            entry,
            std=entry.std * sizes.get(("together", entry.name), 1.0),
            rest=entry.first_rest * sizes.get(("rest", entry.name), 1.0),
        )
        for entry in machine.planes
    )
    return replace(machine, errors=errors, planes=planes)


def _rescaled(entry: ErrorEntry, axis: Axis, sizes: Mapping[tuple[Kind, str], float]) -> ErrorEntry:
    kind: Kind = "reversal" if entry.kind == "reversal" else "std"
    length = None if entry.length is None else entry.length * sizes.get(("length", entry.name), 1.0)
    # The knots stay where they were: a spline does not move because its prior was learnt.
    knots = None if entry.constant else entry.knot_count(axis)
    return replace(
        entry,
        std=entry.std * sizes.get((kind, entry.name), 1.0),
        length=length,
        rest=entry.first_rest * sizes.get(("rest", entry.name), 1.0),
        knots=knots,
        spacing=None,
    )


def rescaled_setups(setups: Sequence[Setup], sizes: Mapping[tuple[Kind, str], float]) -> tuple[Setup, ...]:
    """Return the set-ups with their noise at other sizes."""
    return tuple(replace(setup, noise=setup.noise * sizes.get(("noise", setup.name), 1.0)) for setup in setups)
