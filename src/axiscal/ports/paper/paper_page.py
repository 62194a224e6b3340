"""The paper's figures on one page that carries everything."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from axiscal.errors.model import ErrorFunction
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.belief import Belief
from axiscal.numerics import Array
from axiscal.ports.paper.stack import SHOWN_SINGLE, SHOWN_STACKED, SIMULATED, UNIT, Experiment, GreedyPlan, Simulated
from axiscal.present.drawing.svg_picture import Figure, axis_style, band, layout, line_trace, shown
from axiscal.present.sentences import page_of

_POINTS = 301
"""Points of a drawn curve."""
_MARGIN = {"l": 46, "r": 10, "t": 10, "b": 42}
"""Pixels; a matter of taste."""


def single_spline(experiment: Experiment) -> list[Figure]:
    """Return figure 4: the spline before measuring, and after three and seven readings."""
    plan, shown = experiment.single, experiment.spline
    return [_curve(plan, shown, readings, plan.stack.errors.functions[0], (-3.4, 3.4)) for readings in SHOWN_SINGLE]


def stacked(experiment: Experiment) -> list[list[Figure]]:
    """Return figure 7: a row of three splines before measuring and after some readings."""
    plan, shown = experiment.stacked, experiment.figure_machine
    return [
        [_curve(plan, shown, readings, function, (-3.6, 3.6)) for function in plan.stack.errors.functions]
        for readings in SHOWN_STACKED
    ]


def _curve(
    plan: GreedyPlan, shown: Simulated, readings: int, function: ErrorFunction, span: tuple[float, float]
) -> Figure:
    """Return one spline: truth, estimate with its ±σ band, control points, and where it was measured."""
    belief, basis, columns = shown.beliefs[readings], function.basis, function.columns
    t = np.linspace(basis.knots[0], basis.knots[-1], _POINTS)
    rows = np.zeros((len(t), belief.size))
    rows[:, columns] = basis.rows(t)
    traces = [
        *_estimate(t, belief, rows),
        line_trace((t / UNIT).tolist(), (rows @ shown.truth / UNIT).tolist(), "var(--truth)", 2.2),
        _control_points(basis.knots, belief.mean[columns]),
        _readings(plan, shown, readings, function, span[0]),
    ]
    x = axis_style(f"t{'₁₂₃'[function.axis]}" if len(plan.stack.machine.axes) > 1 else "t", dtick=2)
    y = axis_style("S(t)", range=list(span), dtick=1)
    return {"data": traces, "layout": layout(x, y, 290, margin=_MARGIN)}


def _estimate(t: Array, belief: Belief, rows: Array) -> list[Figure]:
    mean, std = belief.predict(rows)
    x, middle, half = (t / UNIT).tolist(), (mean / UNIT).tolist(), (std / UNIT).tolist()
    edges = [[m + sign * s for m, s in zip(middle, half, strict=True)] for sign in (1, -1)]
    dashed = [line_trace(x, edge, "var(--accent)", 1, "4px,3px") for edge in edges]
    return [band(x, middle, half, "var(--whole)"), *dashed, line_trace(x, middle, "var(--accent)", 1.8)]


def _markers(x: Sequence[float], y: Sequence[float]) -> Figure:
    return {"type": "scatter", "mode": "markers", "x": x, "y": y}


def _control_points(knots: Array, values: Array) -> Figure:
    marker = {"symbol": "square-open", "size": 7, "color": "var(--accent)", "line": {"width": 1.6}}
    points = _markers((knots / UNIT).tolist(), (values / UNIT).tolist())
    return {**points, "marker": marker, "cliponaxis": False}


def _readings(plan: GreedyPlan, shown: Simulated, readings: int, function: ErrorFunction, floor: float) -> Figure:
    """Return the readings at their values where one spline is all there is to see, else their places along the foot."""
    x = plan.positions[:readings, function.axis].tolist()
    marker = {"size": 7, "color": "var(--ink)", "line": {"color": "var(--card)", "width": 0.8}}
    common = {"marker": marker, "cliponaxis": False, "text": [f"reading {k + 1}" for k in range(readings)]}
    if len(plan.stack.machine.axes) > 1:
        marker |= {"symbol": "circle-open", "line": {"color": "var(--ink)", "width": 1.4}}
        return {**_markers(x, [floor + 0.22] * readings), **common}
    bars = {"array": [plan.stack.std] * readings, "thickness": 1.2, "color": "var(--ink)"}
    values = (shown.values[:readings] / UNIT).tolist()
    return {**_markers(x, values), **common, "error_y": bars}


def decrease(experiment: Experiment) -> Figure:
    """Return figure 5: the overall variance against the squared error that many simulated splines really have."""
    variances, errors = experiment.single.overall_variances, experiment.squared_errors
    steps = list(range(len(variances)))
    mean, std = errors.mean(axis=0), errors.std(axis=0, ddof=1) / np.sqrt(len(errors))
    whiskers = {"array": (BAND * std).tolist(), "color": "var(--accent)", "thickness": 1.4}
    marker = {"color": "var(--accent)", "size": 7, "symbol": "square"}
    traces = [
        line_trace([7, 7], [0.0, variances[0]], "var(--soft)", 1, "dot"),
        line_trace(steps, variances, "var(--truth)", 2.6),
        line_trace(steps, experiment.spline_errors.tolist(), "var(--soft)", 1.5, "dot"),
        {**_markers(steps, mean.tolist()), "marker": marker, "error_y": whiskers},
    ]
    y = axis_style("variance × length", rangemode="tozero")
    return {"data": traces, "layout": layout(axis_style("readings", dtick=1), y, 330, margin={**_MARGIN, "l": 54})}


def render(experiment: Experiment) -> str:
    """Return the page as self-contained HTML."""
    return page_of("axiscal.ports.paper", "reproduce.html", **_values(experiment))


def table(experiment: Experiment) -> str:
    """Return the numbers as a table for people."""
    return page_of("axiscal.ports.paper", "reproduce.jinja", **_values(experiment))


def _values(experiment: Experiment) -> dict[str, Any]:
    return {
        "draw": shown,
        "single": list(zip(SHOWN_SINGLE, single_spline(experiment), strict=True)),
        "decrease": decrease(experiment),
        "stacked": list(zip(SHOWN_STACKED, stacked(experiment), strict=True)),
        "simulated": SIMULATED,
        "variances": experiment.single.overall_variances,
        "stacked_variances": experiment.stacked.overall_variances,
        "heights": [value**0.5 for value in experiment.stacked.height_variances],
        "last": SHOWN_STACKED[-1],
        "rows": list(enumerate(experiment.single.overall_variances)),
        "positions": experiment.single.positions[:, 0].tolist(),
        "joints": experiment.stacked.positions.tolist(),
        "kept": experiment.stacked.stack.variance_left,
        "errors": experiment.squared_errors.mean(axis=0).tolist(),
    }
