"""Every error of the machine as `result.json` has it: curves with their bands and readings, and constants."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from axiscal.errors.iso230 import words
from axiscal.estimation.estimation import Estimation, paths
from axiscal.language.spoken import WORDS, said
from axiscal.measurement.reading import Reading, units_of
from axiscal.measurement.reading_rows import seen
from axiscal.numerics import Array
from axiscal.present.result import ConstantFigures, CurveFigures, ReadPoints
from axiscal.units import said_quantity, to_unit
from axiscal_core.axes import Axis
from axiscal_core.normal import Normal
from axiscal_core.terms import Term

_POSITIONS = 101
"""Points of a drawn curve."""
_BEARS_ON = 0.1
"""Share of a reading's sight of an error, from which the reading is drawn at its curve."""
_SEEN = 0.5
_UNKNOWNS = WORDS["unknowns"]


def errors(estimation: Estimation, readings: Sequence[Reading]) -> dict[str, CurveFigures]:
    """Return every error that is a function of position, by name, reversals last."""
    numbers = seen(estimation.printed.observation, readings)
    firsts = np.searchsorted(numbers.reading, np.arange(len(readings)))  # the first number of each
    rows = numbers.rows[firsts]
    left = numbers.values[firsts] - rows @ estimation.printed.belief.mean
    drawn = [function for function in estimation.case.errors.curves if function.spline.size > 1]
    drawn.sort(key=lambda function: function.name.endswith("_reversal"))
    found = dict[str, CurveFigures]()
    for each in drawn:
        axis, unseen = estimation.case.errors.axes[each.axis], estimation.case.yardstick.unseen[each.columns]
        points = [*_points(estimation, each, readings, rows, left)]
        now, before = estimation.printed.belief, estimation.without_readings
        found[each.name] = curve_figures(each, axis, now, before, unseen, points)
    return found


def value_unit(function: Term) -> str:
    """Return the unit in which values of an error are shown."""
    return "urad" if function.angular else "um"


def curve_figures(
    function: Term, axis: Axis, now: Normal, before: Normal, unseen: Array, points: Sequence[tuple[float, float]] = ()
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
        read=ReadPoints(position=[at for at, _ in points], value=[value for _, value in points]),
    )


def constants(estimation: Estimation) -> dict[str, ConstantFigures]:
    """Return location errors, constant reversals, and the unknowns of the set-ups, by name."""
    case, own = estimation.case, dict[str, ConstantFigures]()
    for function in (each for each in case.errors.curves if each.spline.size == 1):
        column = function.columns.start
        found = _found(estimation, words(function.name), column, value_unit(function))
        hidden = float(np.linalg.norm(case.yardstick.unseen[column]))
        seen_of_it = hidden**2 < _SEEN * float(function.covariance[0, 0])
        own[function.name] = found.model_copy(update={"seen": seen_of_it})
    for index, setup in enumerate(case.description.setups):
        columns = estimation.printed.observation.unknowns_of(index)
        for column, unknown in zip(columns, setup.unknowns, strict=True):
            found = _found(estimation, _unknown_words(unknown.name), column, case.unit_of(setup, unknown))
            own[f"{setup.name}: {unknown.name}"] = found
    for setup in case.description.setups:  # how far zeros that may wander came from the first reading to the last
        ways = zip(setup.names, units_of(setup), strict=True)
        for (way, unit), path in zip(ways, paths(estimation, setup), strict=False):
            spoken = said("how far its zero came in {time}", time=said_quantity(path.times[-1] - path.times[0], "min"))
            sizes = (float(each[-1]) for each in (path.mean, path.std, path.prior))
            own[f"{setup.name}: drift" + (f"_{way}" if way else "")] = constant_figures(spoken, unit, *sizes)
    return own


def _found(known: Estimation, spoken: str, column: int, unit: str) -> ConstantFigures:
    """Return one number of the belief.  spoken : what it is"""
    stds = (float(np.linalg.norm(each.factor[column])) for each in (known.printed.belief, known.without_readings))
    return constant_figures(spoken, unit, float(known.printed.belief.mean[column]), *stds)


def constant_figures(spoken: str, unit: str, mean: float, std: float, before: float) -> ConstantFigures:
    """Return a number with its standard deviation, now and before.  unit : "" where nobody knows its own"""
    shown, spread, first = (to_unit(float(each), unit) if unit else float(each) for each in (mean, std, before))
    return ConstantFigures(words=spoken, mean=shown, std=spread, unit=unit, prior_std=first)


def _unknown_words(name: str) -> str:
    """Return what an unknown of a set-up is, such as "station_x", or "low_x" of its ball "low"."""
    stem, _, way = name.rpartition("_") if name[-2:] in ("_x", "_y", "_z") else (name, "", "")
    if stem not in _UNKNOWNS:
        known = said("place of the ball {ball}, {way}", ball=stem, way=way)
        return known if way else said("{unknown} of the set-up", unknown=name)
    unknown = said(_UNKNOWNS[stem])
    whole = said("{unknown} of the set-up", unknown=unknown)
    return said("{unknown} of the set-up, {way}", unknown=unknown, way=way) if way else whole


def _shares(rows: Array, function: Term) -> Array:
    """Return the variance that the prior of one error gives to each reading, (m,).  rows : (m, size)"""
    own = rows[:, function.columns]
    shares: Array = np.sum((own @ function.covariance) * own, axis=1)
    return shares


def _points(
    known: Estimation, function: Term, readings: Sequence[Reading], rows: Array, left: Array
) -> Iterator[tuple[float, float]]:
    """Yield place and value of each reading that is believed: less what the rest of the model says, per lever."""
    setups = known.case.description.setups
    moves = {setup.name: setup.moves if setup.base is None else () for setup in setups}  # a slope is no height
    whole = sum(_shares(rows, each) for each in known.case.errors.curves)
    unit, axis = value_unit(function), known.case.errors.axes[function.axis]
    for index in np.flatnonzero(_shares(rows, function) > _BEARS_ON * whole).tolist():
        reading = readings[index]
        if function.axis not in moves[reading.setup] or index in known.left_out:
            continue
        basis = function.spline.rows(np.array([reading.pose[function.axis]]))[0]
        lever = float(rows[index, function.columns] @ basis / (basis @ basis))
        value = float(basis @ known.printed.belief.mean[function.columns]) + float(left[index]) / lever
        yield to_unit(reading.pose[function.axis], axis.unit), to_unit(value, unit)
