"""The paper's figures, and those of joints that are not what it assumes, on one page that carries everything."""

from __future__ import annotations

import numpy as np

from axiscal.numerics import Array
from axiscal.ports.paper import drawings as figures
from axiscal.ports.paper.beyond import MACHINES, Compared
from axiscal.ports.paper.experiment import SHOWN_SINGLE, SHOWN_STACKED, SIMULATED, Experiment
from axiscal.present.drawing.shown import shown
from axiscal.present.drawing.svg_picture import Figure
from axiscal.present.figures import axis_style, layout
from axiscal.present.standalone import page_of


def render(experiment: Experiment, beyond: tuple[Compared, ...] = ()) -> str:
    """Return the page as self-contained HTML.  beyond : joints that are not what the paper assumes"""
    values = {
        "draw": shown,
        "single": list(zip(SHOWN_SINGLE, figures.single_spline(experiment), strict=True)),
        "decrease": [figures.decrease(experiment, logarithmic=logarithmic) for logarithmic in (False, True)],
        "stacked": list(zip(SHOWN_STACKED, figures.stacked(experiment), strict=True)),
        "both": figures.both_criteria(experiment),
        "confounded": figures.confounded(experiment, SHOWN_STACKED[-1]),
        "simulated": SIMULATED,
        "machines": MACHINES,
        "beyond": [(each.scenario, decrease(each), curve(each)) for each in beyond],
        "variances": experiment.single.overall_variances,
        "stacked_variances": experiment.stacked.overall_variances,
        "heights": [value**0.5 for value in experiment.stacked.height_variances],
        "left": experiment.stacked.stack.variance_left,
        "joint_left": (experiment.stacked.stack.variance_left / experiment.stacked.stack.length) ** 0.5,
        "excess": experiment.lattice_excess,
        "lattices": experiment.lattice_sizes,
        "last": SHOWN_STACKED[-1],
        "rows": list(enumerate(experiment.single.overall_variances)),
        "positions": experiment.single.positions[:, 0].tolist(),
        "errors": experiment.squared_errors.mean(axis=0).tolist(),
    }
    return page_of("axiscal.ports.paper", "reproduce.html", **values)


_MICRO = 1e6
"""um in a metre."""
_MARGIN = {"l": 54, "r": 10, "t": 10, "b": 42}
"""Pixels; a matter of taste."""


def decrease(found: Compared) -> Figure:
    """Return what both methods miss against the number of readings, um, logarithmic."""
    count = list(found.scenario.readings)
    traces = [
        _line(count, np.median(missed, axis=0) * _MICRO, colour, "lines+markers")
        for missed, colour in ((found.linear, "var(--soft)"), (found.whole, "var(--accent)"))
    ]
    y = axis_style("missed, um", type="log")
    return {"data": traces, "layout": layout(axis_style("readings"), y, 300, margin=_MARGIN)}


def curve(found: Compared) -> Figure:
    """Return the height of one machine along one axis: the truth and both estimates, um."""
    sets = (
        (found.by_linear, "var(--soft)"),
        (found.real, "var(--truth)"),
        (found.by_whole, "var(--accent)"),
    )
    traces = [_line(found.along.tolist(), values * _MICRO, colour, "lines") for values, colour in sets]
    return {"data": traces, "layout": layout(axis_style(found.unit), axis_style("z, um"), 300, margin=_MARGIN)}


def _line(x: list[float] | list[int], y: Array, colour: str, mode: str) -> Figure:
    style = {"line": {"color": colour, "width": 2}, "marker": {"color": colour, "size": 6}}
    return {"type": "scatter", "mode": mode, "x": x, "y": y.tolist(), **style}
