"""Where a pose stands against a chart: the place that it is next to, and how far the tool point is off."""

from __future__ import annotations

import numpy as np

from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames
from axiscal.measurement.charts.chart import Chart
from axiscal.numerics import Array


def off_chart(machine: Machine, chart: Chart, pose: Array) -> float:
    """Return how far the tool point of a pose (q,) is from where the chart has it with the same coordinates, m."""
    nearest = chart.poses(chart.places(pose[None]))
    if not np.all(np.isfinite(nearest)):
        return float("inf")
    here, there = frames(machine, np.concatenate([pose[None], nearest])).tcp
    return float(np.linalg.norm(here - there))
