"""Error motions of a spindle or rotary axis by ISO 230-7: a sensor's readings over angle and turns.

About the centre of least squares, with m(θ) the mean over the turns at an angle and e the residual of the readings:

    total          max e − min e over all turns
    synchronous    max m − min m
    asynchronous   the largest width over the turns at one angle, max over θ of (max − min over turns)

A radial sensor sees the place of the target as a first harmonic: it is taken off. Along the axis it is an error motion,
the fundamental, and stays: `axial_` figures are of the readings less their mean alone. (Formulas after ISO 230-7:2006,
quoted from memory; the standard asks for twenty turns at least.)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from axiscal.evaluation.circles import centred, covers_a_turn
from axiscal.exceptions import EvaluationError
from axiscal.measurement.readers.around import Turns
from axiscal.numerics import Array
from axiscal.units import to_unit

_ASKED = 20
"""Turns that the standard asks for."""


@dataclass(frozen=True, slots=True)
class ErrorMotion:
    """Figures by name, m: radial_total, radial_synchronous, radial_asynchronous, axial_..., fundamental."""

    figures: Mapping[str, float]
    warnings: tuple[str, ...] = ()

    def as_json(self) -> dict[str, object]:
        """Return the document `axiscal-iso230-7/1`, figures in um."""
        figures = {name: to_unit(value, "um") for name, value in self.figures.items()}
        return {"schema": "axiscal-iso230-7/1", "unit": "um", **figures, "warnings": list(self.warnings)}


def error_motion(test: Turns) -> ErrorMotion:
    """Return the figures of readings over angles and turns; raises EvaluationError for less than two turns."""
    turns, count = test.deviations, test.deviations.shape[1]
    if count < 2 or not covers_a_turn(test.angles):
        what = "an error motion needs two turns, each read at eight angles all around"
        raise EvaluationError(what, "Read more turns at the same angles", test.file)
    around = np.repeat(test.angles, count)
    found = centred(around, turns.ravel())
    radial, axial = found.left.reshape(turns.shape), turns - turns.mean()
    figures = {**_named("radial", radial), **_named("axial", axial), "fundamental": float(np.hypot(*found.centre))}
    few = () if count >= _ASKED else (f"ISO 230-7 asks for {_ASKED} turns; there are {count}.",)
    return ErrorMotion(figures, few)


def _named(name: str, left: Array) -> dict[str, float]:
    """Return total, synchronous and asynchronous error motion.  left : (angles, turns)"""
    mean = left.mean(axis=1)
    return {
        f"{name}_total": float(np.ptp(left)),
        f"{name}_synchronous": float(np.ptp(mean)),
        f"{name}_asynchronous": float(np.ptp(left, axis=1).max()),
    }
