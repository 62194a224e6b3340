"""Where a plan reads, as four pictures: part, balls and tool point on the workpiece; axes within their travels."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.machine import Machine
from axiscal.machine.kinematics import frames
from axiscal.measurement.place import Place
from axiscal.measurement.place_texts import place_text
from axiscal.numerics import Array
from axiscal.report.digits import numbers
from axiscal.report.drawing.shown import shown
from axiscal.report.drawing.svg_picture import Figure
from axiscal.report.figures import SYMBOLS, axis_style, layout
from axiscal.report.standalone import environment, inlined
from axiscal.units import to_unit

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6d31", "#7b4173")
_HEIGHT, _WIDTH = 400, 520
"""Pixels; a matter of taste."""
_CIRCLE = np.linspace(0.0, math.tau, 73)
"""Mathematics: a circle drawn every five degrees."""


class View(NamedTuple):
    """Two directions, 0, 1, 2 for x, y, z, to the right and up, and what it is called."""

    right: int
    up: int
    name: str


_VIEWS = (View(0, 1, "from above"), View(0, 2, "from the front"))
"""Two of the three sides show all of it; a matter of taste."""


def render(title: str, campaign: CampaignDescription, places: Sequence[Place]) -> str:
    """Return the page as self-contained HTML.  places : in the order in which they are read"""
    pictures = [
        {"title": title, "svg": shown(picture(campaign, places, view), title)}
        for frame, picture in (("On the workpiece", on_workpiece), ("In the machine", in_machine))
        for view in _VIEWS
        for title in (f"{frame}, {view.name}",)
    ]
    used = list(dict.fromkeys(place.setup for place in places))
    legend = [
        {"name": name, "colour": colour(k), "readings": sum(place.setup == name for place in places)}
        for k, name in enumerate(used)
    ]
    text: str = (
        environment("axiscal.report")
        .get_template("room.html")
        .render(title=title, pictures=pictures, legend=legend, **inlined())
    )
    return text


def colour(number: int) -> str:
    """Return the colour of a set-up."""
    return COLOURS[number % len(COLOURS)]


def on_workpiece(campaign: CampaignDescription, places: Sequence[Place], view: View) -> Figure:
    """Return part, balls, what is to be kept out, and the tool point's way, in the workpiece frame."""
    tips = frames(campaign.machine, np.array([place.pose for place in places])).tcp
    traces = [*_part(campaign, view), *_kept_out(campaign, view), *_balls(campaign, view)]
    return _figure([*traces, *_readings(campaign.machine, places, tips, view)], view, "xyz")


def in_machine(campaign: CampaignDescription, places: Sequence[Place], view: View) -> Figure:
    """Return the travels of X, Y and Z, and where these stand at the readings."""
    machine = campaign.machine
    linear = [machine.index(name) for name in "XYZ" if name in {axis.name for axis in machine.axes}]
    at = np.zeros((len(places), 3))
    travels = np.zeros((3, 2))
    for k in linear:
        direction = "XYZ".index(machine.axes[k].name)
        at[:, direction] = [place.pose[k] for place in places]
        travels[direction] = machine.axes[k].travel
    box = _outline(travels[view.right], travels[view.up], "travel of the axes", "var(--soft)")
    return _figure([box, *_readings(machine, places, at, view)], view, "XYZ")


def _readings(machine: Machine, places: Sequence[Place], at: Array, view: View) -> Iterator[Figure]:
    """Yield the way in order, and the readings of each set-up."""
    x, y = (_mm(at[:, way]) for way in (view.right, view.up))
    yield {"type": "scatter", "mode": "lines", "x": x, "y": y, "line": {"color": "var(--rule)", "width": 1}, "name": ""}
    for k, name in enumerate(dict.fromkeys(place.setup for place in places)):
        mine = [number for number, place in enumerate(places) if place.setup == name]
        said = [f"reading {n + 1}, {name}\n{place_text(machine.axes, places[n].pose)}" for n in mine]
        marker = {"color": colour(k), "symbol": SYMBOLS[k % len(SYMBOLS)], "size": 7}
        points = {"x": [x[n] for n in mine], "y": [y[n] for n in mine], "text": said}
        yield {"type": "scatter", "mode": "markers", "marker": marker, **points, "name": name}


def _part(campaign: CampaignDescription, view: View) -> Iterator[Figure]:
    part = campaign.target.part
    if part is None:
        return
    if part.radius is not None and {view.right, view.up} == {0, 1}:
        round_x, round_y = (_mm(part.radius * turn(_CIRCLE)) for turn in (np.cos, np.sin))
        yield _closed(round_x, round_y, "part", "var(--accent)")
        return
    yield _outline(np.array(part.spans[view.right]), np.array(part.spans[view.up]), "part", "var(--accent)")


def _kept_out(campaign: CampaignDescription, view: View) -> Iterator[Figure]:
    for artefact in {setup.artefact.name: setup.artefact for setup in campaign.setups if setup.artefact}.values():
        for box in artefact.keep_out:
            low, high = np.clip(np.array(box), -1.0, 1.0).T
            right, up = (np.array([low[way], high[way]]) for way in (view.right, view.up))
            yield _outline(right, up, "kept out", "#b00020")


def _balls(campaign: CampaignDescription, view: View) -> Iterator[Figure]:
    for artefact in {setup.artefact.name: setup.artefact for setup in campaign.setups if setup.artefact}.values():
        x, y = (_mm(artefact.points[:, way]) for way in (view.right, view.up))
        names = [ball.name for ball in artefact.balls]
        marker = {"symbol": "circle-open", "size": 20, "color": "var(--ink)", "line": {"width": 2}}
        named = {"mode": "markers+text", "name": artefact.name}
        yield {"type": "scatter", "x": x, "y": y, "text": names, "marker": marker, "hoverinfo": "skip", **named}


def _outline(right: Array, up: Array, name: str, shade: str) -> Figure:
    return _closed(_mm(right[[0, 1, 1, 0, 0]]), _mm(up[[0, 0, 1, 1, 0]]), name, shade)


def _closed(x: list[float], y: list[float], name: str, shade: str) -> Figure:
    line = {"color": shade, "width": 1.5, "dash": "dot"}
    return {"type": "scatter", "mode": "lines", "x": x, "y": y, "line": line, "name": name}


def _mm(values: Array) -> list[float]:
    return [float(value) for value in numbers([to_unit(float(v), "mm") for v in values], "places of a plan")]


def _figure(traces: list[Figure], view: View, names: str) -> Figure:
    x = axis_style(f"{names[view.right]}, mm")
    y = axis_style(f"{names[view.up]}, mm", scaleanchor="x", scaleratio=1)
    margin = {"l": 52, "r": 12, "t": 12, "b": 44}
    return {"data": traces, "layout": layout(x, y, _HEIGHT, margin=margin, width=_WIDTH)}
