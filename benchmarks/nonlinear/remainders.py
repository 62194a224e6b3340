"""What first order leaves out of the built-in five-axis machine: over the volume, for machines that are ever worse."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import deviation_of
from axiscal.machine import Machine, load_machine
from axiscal.machine.entry import ErrorEntry
from axiscal.machine.kinematics import actual_deviation
from axiscal.numerics import Array

_DRAWS, _POSES = 300, 30
_OFFSETS, _TILTS = ("X0B", "Z0B", "X0C", "Y0C"), ("A0B", "C0B", "A0C", "B0C")
DEGREE = float(np.radians(1.0))


@dataclass(frozen=True)
class Kind:
    """A machine: factor on all stated stds, other stds by name, m or rad; wrong : by how much the tool is longer, m."""

    words: str
    expected: tuple[float, float]
    factor: float = 1.0
    stds: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    wrong: float = 0.0


def _all(names: tuple[str, ...], std: float) -> dict[str, float]:
    return dict.fromkeys(names, std)


KINDS = (
    Kind("as described", (0.0024, 0.009)),
    Kind("three times as bad", (0.022, 0.13), 3.0),
    Kind("ten times as bad", (0.28, 1.6), 10.0),
    Kind("rotary offsets 0.3 mm", (0.033, 0.10), stds=_all(_OFFSETS, 0.3e-3)),
    Kind("rotary offsets 3 mm", (0.31, 1.5), stds=_all(_OFFSETS, 3e-3)),
    Kind("rotary tilts 0.3 mrad", (0.073, 0.36), stds=_all(_TILTS, 0.3e-3)),
    Kind("rotary tilts 1 mrad", (0.81, 3.4), stds=_all(_TILTS, 1e-3)),
    Kind("tilts 1 mrad, offsets 1 mm", (2.7, 7.8), stds={**_all(_TILTS, 1e-3), **_all(_OFFSETS, 1e-3)}),
    Kind("zero of B 0.1 deg", (0.90, 4.6), stds={"B0B": 0.1 * DEGREE}),
    Kind("zeros of B and C 0.1 deg", (2.1, 13.0), stds={"B0B": 0.1 * DEGREE, "C0C": 0.1 * DEGREE}),
    Kind("zeros of B and C 0.5 deg", (64.0, 418.0), stds={"B0B": 0.5 * DEGREE, "C0C": 0.5 * DEGREE}),
    Kind("squareness 0.5 mrad", (0.12, 0.65), stds=_all(("C0Y", "B0Z", "A0Z"), 0.5e-3)),
    Kind("tool 1 mm longer than stated", (0.059, 0.16), wrong=1e-3),
    Kind("tool 10 mm longer than stated", (0.70, 1.8), wrong=10e-3),
)


def machine_of(kind: Kind) -> Machine:
    """Return the five-axis machine with the stds of a kind."""
    machine = load_machine("dmu60")
    errors = [replace(e, std=kind.stds.get(e.name, kind.factor * e.std)) for e in machine.errors]
    named = {e.name for e in errors}
    errors += [ErrorEntry(name, std=std) for name, std in kind.stds.items() if name not in named]
    return replace(machine, errors=tuple(errors))


def remainders(kind: Kind, seed: int = 1) -> tuple[float, float]:
    """Return RMS and largest of what first order leaves out, m."""
    machine = machine_of(kind)
    model, rng = ErrorModel(machine), np.random.default_rng(seed)
    low, high = np.array([axis.travel for axis in machine.axes]).T
    deviation = _with_tool(model, kind.wrong)
    root, sizes = model.prior_root(), list[Array]()
    for _ in range(_DRAWS):
        at, poses = root @ rng.standard_normal(model.size), rng.uniform(low, high, (_POSES, len(low)))
        sides = rng.choice([-1.0, 1.0], poses.shape)
        sizes.append(np.linalg.norm(deviation(at, poses, sides) - model.rows(poses, sides) @ at, axis=1))
    every = np.concatenate(sizes)
    return float(np.sqrt(np.mean(every**2))), float(every.max())


def _with_tool(model: ErrorModel, wrong: float) -> Callable[[Array, Array, Array], Array]:
    """Return the deviation less what the longer tool does at the nominal machine."""
    if not wrong:
        return lambda at, poses, sides: deviation_of(model, at, poses, sides).displacement
    longer = replace(model.machine, tool=model.machine.tool + wrong)

    def deviation(at: Array, poses: Array, sides: Array) -> Array:
        return actual_deviation(longer, poses, model.small_motions(at, poses, sides)).displacement

    return deviation
