"""[[artefacts]] of campaign.toml read into `Artefact`: balls, where they are free, and what is known of them."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from functools import partial
from itertools import combinations, product
from types import MappingProxyType

import numpy as np

from axiscal.description.campaign_schema import ArtefactTable, GridTable
from axiscal.description.vectors import At
from axiscal.document import Document, shown
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import joined, said
from axiscal.measurement.artefact import Artefact, Ball
from axiscal.units import format_quantity

MOST_BALLS = 400
"""More balls on a plate are a slip."""
CLOSEST = 2e-3
"""m; balls nearer to each other than this are one."""
_FAR = 10.0
"""m: beyond any machine, where a box names no end."""
_OFF_LINE = 1e-3
"""Sine, or m: less is one line to any setting-up."""
_TAKEN = ("place", "turn", "scale", "station", "tool", "zero")
"""Words that the names of unknowns begin with."""


def read_artefacts(tables: list[ArtefactTable], document: Document) -> Mapping[str, Artefact]:
    """Return the artefacts by name; raises DescriptionError or UnitError at the line that is wrong."""
    found: dict[str, Artefact] = {}
    for number, table in enumerate(tables):
        artefact = _artefact(table, partial(document.placed, "artefacts", number))
        if artefact.name in found:
            what = 'two artefacts are called "{artefact}"'
            fault = DescriptionError(what, "Give each a name of its own", artefact=artefact.name)
            raise document.fault(fault, "artefacts", number, "name")
        found[artefact.name] = artefact
    return MappingProxyType(found)


def _artefact(table: ArtefactTable, at: At) -> Artefact:
    balls = _balls(table, at)
    with at("calibrated"):
        if table.calibrated is not None:
            _refuse_open_turn(balls)
    return Artefact(
        name=table.name,
        balls=balls,
        free=table.free,
        cone=table.cone,
        keep_out=tuple(_kept_out(at, number, box) for number, box in enumerate(table.keep_out)),
        placed=table.placed,
        turned=table.turned,
        calibrated=table.calibrated,
        scale=table.scale,
        diameter=table.diameter,
    )


def _balls(table: ArtefactTable, at: At) -> tuple[Ball, ...]:
    if table.grid is not None:
        with at("grid"):
            if table.balls:
                raise DescriptionError("balls and grid exclude one another", "Give one of them")
            return _grid(table.grid)
    balls = []
    for name, place in table.balls.items():
        with at("balls", name):
            balls.append(Ball(_ball_name(name), place))
    with at("balls"):
        _refuse_close(tuple(balls))
    return tuple(balls)


def _grid(grid: GridTable) -> tuple[Ball, ...]:
    if len(grid.count) != 2 or len(grid.pitch) != 2 or len(grid.along) != 2:
        remedy = 'Write count = [5, 5], pitch = ["80 mm", "80 mm"], along = ["x", "y"]'
        raise DescriptionError("a grid has two directions", remedy)
    if min(grid.count) < 2 or grid.count[0] * grid.count[1] > MOST_BALLS:
        what = "a grid of {rows} by {columns} balls"
        remedy = "Give 2 to {most} balls in rows of 2 and more, or a row as balls"
        raise DescriptionError(what, remedy, rows=grid.count[0], columns=grid.count[1], most=MOST_BALLS)
    pitch, ways = grid.pitch, [np.array(way) for way in grid.along]
    if min(pitch) < CLOSEST or np.linalg.norm(np.cross(ways[0], ways[1])) < _OFF_LINE:
        raise DescriptionError("the balls of this grid fall together", "Give two directions and a pitch each")
    balls = []
    for i, j in product(*map(range, grid.count)):
        x, y, z = (np.array(grid.origin) + i * pitch[0] * ways[0] + j * pitch[1] * ways[1]).tolist()
        balls.append(Ball(f"ball_{i + 1}_{j + 1}", (x, y, z)))
    return tuple(balls)


def _refuse_open_turn(balls: tuple[Ball, ...]) -> None:
    points = np.array([ball.place for ball in balls]).reshape(-1, 3)
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False) if len(balls) > 2 else np.zeros(3)
    if spread[1] < _OFF_LINE:
        what = "balls that are calibrated together need at least three that are not in a line: their turn is open"
        raise DescriptionError(what, "Take calibrated out, and each ball stands where it stands")


def _kept_out(at: At, number: int, box: Mapping[str, tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    with at("keep_out", number):
        if not box or not set(box) <= set("xyz"):
            remedy = 'Write {{ x = ["-250 mm", "250 mm"], z = ["-300 mm", "-150 mm"] }}, in the workpiece frame'
            raise DescriptionError("{text} is no box", remedy, text=shown(dict(box)))
        return tuple(box.get(letter, (-_FAR, _FAR)) for letter in "xyz")


def _ball_name(text: str) -> str:
    if not text.replace("_", "a").replace("-", "a").isalnum() or len(text) > 40 or text in _TAKEN:
        remedy = "Give a word such as low, high, third"
        raise DescriptionError("{text} is not a name for a ball", remedy, text=shown(text))
    return text


def _refuse_close(balls: tuple[Ball, ...]) -> None:
    if len(balls) > MOST_BALLS:
        raise DescriptionError("{count} balls are too many", "Give up to {most}", count=len(balls), most=MOST_BALLS)
    for first, second in combinations(balls, 2):
        apart = math.dist(first.place, second.place)
        if apart < CLOSEST:
            what = "the balls {first} and {second} are {apart} apart"
            remedy = "One ball stands at one place: check their coordinates"
            raise DescriptionError(
                what, remedy, first=first.name, second=second.name, apart=format_quantity(apart, "mm", 3)
            )


def unused_artefacts(text: str) -> str | None:
    """Return a sentence about artefacts that no set-up of a campaign file names; None where all are read."""
    data = tomllib.loads(text)
    read = {table.get("artefact") for table in data.get("setups", [])}
    left = [shown(table["name"]) for table in data.get("artefacts", []) if table["name"] not in read]
    if not left:
        return None
    sentence = "nothing reads {names}: write artefact = {first} in a set-up, or take its table out."
    return said(sentence, names=joined(left), first=left[0])
