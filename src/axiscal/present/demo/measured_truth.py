"""The hidden truth of the demo: measured shapes on the axes of a machine, scaled to what its description expects."""

from __future__ import annotations

from importlib import resources

import numpy as np

from axiscal.errors.model import ErrorFunction, ErrorModel
from axiscal.measurement.readers.truth_curves import TruthCurve
from axiscal.numerics import Array


def measured_shapes() -> tuple[Array, ...]:
    """Return the measured shapes of SOURCES.md: values at even places over a travel, RMS 1, no constant, no slope."""
    text = resources.files("axiscal.present.demo").joinpath("shapes.csv").read_text(encoding="utf-8")
    return tuple(np.array([float(v) for v in line.split(",")[1].split()]) for line in text.splitlines()[1:])


def measured_truth(model: ErrorModel, seed: int) -> dict[str, TruthCurve]:
    """Return a curve for every error of the model: a measured shape for a motion, a drawn value for a constant.

    seed : of the constants, and of which shape goes where
    """
    rng = np.random.default_rng(seed)
    shapes = measured_shapes()
    order = rng.permutation(len(shapes))
    curves, used = {}, 0
    for function in model.functions:
        if function.basis.size == 1:
            value = np.sqrt(function.covariance[0, 0]) * rng.standard_normal()
            curves[function.name] = TruthCurve(np.zeros(1), np.array([value]))
            continue
        lap, place = divmod(used, len(shapes))
        shape = shapes[order[place]][:: -1 if lap else 1]
        curves[function.name] = _on_axis(model, function, shape)
        used += 1
    return curves


def _on_axis(model: ErrorModel, function: ErrorFunction, shape: Array) -> TruthCurve:
    axis = model.machine.axes[function.axis]
    even = np.linspace(0.0, 1.0, len(shape))
    values = shape - (shape[0] + (shape[-1] - shape[0]) * even) if axis.cyclic else shape
    values = values / np.sqrt(np.mean(values**2)) * _expected_bend(function)
    return TruthCurve(np.linspace(*axis.travel, len(shape)), values)


def _expected_bend(function: ErrorFunction) -> float:
    """Return the RMS that the prior expects of a curve beyond its constant and slope, which the shapes do not have."""
    straight = np.vander(np.linspace(-1.0, 1.0, function.basis.size), 2)
    bend = np.eye(function.basis.size) - straight @ np.linalg.pinv(straight)
    return float(np.sqrt(np.trace(bend @ function.covariance @ bend) / function.basis.size))
