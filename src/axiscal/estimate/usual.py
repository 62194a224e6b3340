"""A machine and its set-ups with what usually goes wrong, and the sizes that readings may teach."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from axiscal.estimate.model import CYCLE, DRIFT, GROWTH, LENGTH, NOISE, REST, REVERSAL, ROUGH, SURE, TOGETHER, Sure
from axiscal.estimate.sizes import Kind, Size, Sizes
from axiscal.machine.description import Machine
from axiscal.machine.entry import ErrorEntry
from axiscal.measurement.setup import Setup


def usual_machine(machine: Machine) -> Machine:
    """Return the machine with the rough part of each curve: rest as stated or usual, and rough as usual."""
    return replace(machine, errors=tuple(_with_rough(entry) for entry in machine.errors))


def _with_rough(entry: ErrorEntry) -> ErrorEntry:
    if entry.constant or entry.harmonics or entry.joints:
        return entry
    white = REST.size * entry.std if entry.rest is None else entry.rest
    return replace(entry, rest=float(np.hypot(white, ROUGH.size * entry.std)), rest_estimated=False)


def sizes_of(machine: Machine, setups: Sequence[Setup], sure: Callable[[str], Sure], usual: bool) -> Sizes:
    """Return the sizes that vary: one factor for errors that are alike.

    sure : how well size and length of each error are known, by its name
    """
    found = list[Size]()
    for kind, factor in (("std", None), ("length", LENGTH.spread), ("reversal", REVERSAL.spread)):
        for owners, known in _alike(machine, kind, sure):
            if known != "exactly":
                own = np.log(SURE[known])
                found.append(Size(kind, owners, min(own, factor or own)))
    if usual:
        found += [Size("rest", owners, ROUGH.spread) for owners in _rests(machine)]
        names = tuple(setup.name for setup in setups)
        found += [
            Size("drift", names, DRIFT.spread),
            Size("cycle", names, CYCLE.spread),
            Size("growth", names, GROWTH.spread),
        ]
        found += [Size("noise", (name,), NOISE.spread) for name in names]
        planes = tuple(entry.name for entry in machine.planes)
        found += [Size("together", planes, TOGETHER.spread)] if planes else []
    return Sizes(tuple(found))


def _alike(machine: Machine, kind: Kind, sure: Callable[[str], Sure]) -> Iterator[tuple[tuple[str, ...], Sure]]:
    """Yield the names of errors that share a size of a kind, and how well it is known."""
    groups = dict[tuple[object, ...], list[str]]()
    for entry in machine.errors:
        rotary = machine.axis(entry.axis).rotary
        if kind == "std" and entry.kind == "motion":
            groups.setdefault((rotary, entry.parts.angular, sure(entry.name)), []).append(entry.name)
        if kind == "length" and entry.kind == "motion" and entry.length is not None:
            groups.setdefault((rotary, sure(entry.name)), []).append(entry.name)
        if kind == "reversal" and entry.kind == "reversal":
            groups.setdefault((rotary, sure(entry.name)), []).append(entry.name)
    for key, names in groups.items():
        known: Sure = key[-1]  # type: ignore[assignment]
        yield tuple(names), known


def _rests(machine: Machine) -> list[tuple[str, ...]]:
    """Return the names of errors that share the size of their rough part."""
    groups = dict[bool, list[str]]()
    for entry in machine.errors:
        if entry.first_rest > 0:
            groups.setdefault(machine.axis(entry.axis).rotary, []).append(entry.name)
    return [tuple(names) for names in groups.values()]
