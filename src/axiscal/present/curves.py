"""Every error of the machine as `result.json` has it: curves with their bands and readings, and constants."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.iso230 import words
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import seen
from axiscal.numerics import Array
from axiscal.present.result import ConstantFigures, CurveFigures, ReadPoints
from axiscal.units import to_unit
from axiscal_core.axes import Axis
from axiscal_core.normal import Normal
from axiscal_core.terms import Term

_POSITIONS = 101
"""Points of a drawn curve."""
_BEARS_ON = 0.1
"""Share of a reading's sight of an error, from which the reading is drawn at its curve."""
_SEEN = 0.5


def errors(estimation: Estimation, readings: Sequence[Reading]) -> dict[str, CurveFigures]:
    """Return every error that is a function of position, by name, reversals last."""
    numbers, values = seen(estimation.printed.observation, readings)
    firsts = np.searchsorted(numbers.place, np.arange(len(readings)))  # the first number of each
    rows = numbers.rows[firsts]
    left = values[firsts] - rows @ estimation.printed.belief.mean
    drawn = [function for function in estimation.case.errors.curves if function.spline.size > 1]
    drawn.sort(key=lambda function: function.name.endswith("_reversal"))
    shares = {each.name: _shares(rows, each) for each in estimation.case.errors.curves}
    whole, found = sum(shares.values()), dict[str, CurveFigures]()
    for each in drawn:
        axis, unseen = estimation.case.errors.axes[each.axis], estimation.case.yardstick.unseen[each.columns]
        now, before = estimation.printed.belief, estimation.without_readings
        bears = shares[each.name] > _BEARS_ON * whole
        points = _points(estimation, each, readings, rows[bears], left[bears], bears)
        found[each.name] = curve_figures(each, axis, now, before, unseen, points)
    return found


def value_unit(function: Term) -> str:
    """Return the unit in which values of an error are shown."""
    return "urad" if function.angular else "um"


def curve_figures(
    function: Term, axis: Axis, now: Normal, before: Normal, unseen: Array, points: ReadPoints | None = None
) -> CurveFigures:
    """Return an error over its axis.

    unseen : (k, r) factor of what no allowed reading can see of its coefficients; points : place and value of readings
    """
    positions = np.linspace(*axis.travel, _POSITIONS)
    rows, columns, rest = function.spline.rows(positions), function.columns, function.rest**2
    unit, position_unit = value_unit(function), axis.unit
    told, stated, hidden = (
        np.sum((rows @ each) ** 2, axis=1) for each in (now.factor[columns], before.factor[columns], unseen)
    )
    return CurveFigures(
        axis=axis.name,
        words=words(function.name),
        position=to_unit(positions, position_unit).tolist(),
        mean=to_unit(rows @ now.mean[columns], unit).tolist(),
        std=to_unit(np.sqrt(told + rest), unit).tolist(),
        position_unit=position_unit,
        value_unit=unit,
        std_seen=to_unit(np.sqrt(np.maximum(told - hidden, 0.0) + rest), unit).tolist(),
        prior_std=to_unit(np.sqrt(stated + rest), unit).tolist(),
        from_readings=float(np.clip(1.0 - np.sum(told + rest) / np.sum(stated + rest), 0.0, 1.0)),
        read=points or ReadPoints(position=[], value=[]),
    )


def constants(estimation: Estimation) -> dict[str, ConstantFigures]:
    """Return location errors and constant reversals, by name."""
    case, belief, own = estimation.case, estimation.printed.belief, dict[str, ConstantFigures]()
    for function in (each for each in case.errors.curves if each.spline.size == 1):
        column, spoken = function.columns.start, words(function.name)
        stds = (float(np.linalg.norm(each.factor[column])) for each in (belief, estimation.without_readings))
        hidden = float(np.linalg.norm(case.yardstick.unseen[column]))
        seen_of_it = hidden**2 < _SEEN * float(function.covariance[0, 0])
        own[function.name] = constant_figures(spoken, value_unit(function), belief.mean[column], *stds, seen=seen_of_it)
    return own


def constant_figures(
    spoken: str, unit: str, mean: float, std: float, before: float, *, seen: bool = True
) -> ConstantFigures:
    """Return a number with its standard deviation, now and before.  unit : "" where nobody knows its own"""
    shown, spread, first = (to_unit(float(each), unit) if unit else float(each) for each in (mean, std, before))
    return ConstantFigures(words=spoken, mean=shown, std=spread, unit=unit, prior_std=first, seen=seen)


def _shares(rows: Array, function: Term) -> Array:
    """Return the variance that the prior of one error gives to each reading, (m,).  rows : (m, size)"""
    own = rows[:, function.columns]
    shares: Array = np.sum((own @ function.covariance) * own, axis=1)
    return shares


def _points(
    known: Estimation, function: Term, readings: Sequence[Reading], rows: Array, left: Array, bears: NDArray[np.bool_]
) -> ReadPoints:
    """Return place and value of each reading that is believed: less what the rest of the model says, per lever.

    bears : (readings,) which of them show enough of the error; rows, left : of these
    """
    setups, axis = known.case.description.setups, known.case.errors.axes[function.axis]
    moves = {setup.name: setup.moves if setup.base is None else () for setup in setups}  # a slope is no height
    some = [(i, readings[i]) for i in np.flatnonzero(bears).tolist()]
    own = np.array([function.axis in moves[each.setup] and i not in known.left_out for i, each in some], dtype=bool)
    at = np.array([reading.pose[function.axis] for _, reading in some])[own]
    basis = function.spline.rows(at)
    levers = np.sum(rows[own][:, function.columns] * basis, axis=1) / np.sum(basis**2, axis=1)
    values = basis @ known.printed.belief.mean[function.columns] + left[own] / levers
    return ReadPoints(position=to_unit(at, axis.unit).tolist(), value=to_unit(values, value_unit(function)).tolist())
