"""[[artefacts]] of campaign.toml read into `Artefact`: balls, where they are free, and what is known of them."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from itertools import combinations, product
from typing import Annotated

import numpy as np
from pydantic import Field

from axiscal.description.fields import (
    Cone,
    Direction,
    Ends,
    Name,
    Placed,
    Printable,
    Scale,
    Span,
    Spot,
    Turned,
    refuse_same_name,
)
from axiscal.document import Document, Length, shown
from axiscal.document.toml_table import AS_TUPLE, Table
from axiscal.document.validation import Beside, EachAs, ReadAs
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import joined, said
from axiscal.measurement.artefact import CONE, PLACED, SCALE, TURNED, Artefact, Ball
from axiscal.measurement.setup import Vector
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


def _ball(name: str, place: Vector, _: Beside) -> Ball:
    if not name.replace("_", "a").replace("-", "a").isalnum() or len(name) > 40 or name in _TAKEN:
        remedy = "Give a word such as low, high, third"
        raise DescriptionError("{text} is not a name for a ball", remedy, text=shown(name))
    return Ball(name, place)


def _apart(named: Mapping[str, Ball]) -> tuple[Ball, ...]:
    """Return balls, none of which stands where another does."""
    balls = tuple(named.values())
    if len(balls) > MOST_BALLS:
        raise DescriptionError("{count} balls are too many", "Give up to {most}", count=len(balls), most=MOST_BALLS)
    for first, second in combinations(balls, 2):
        apart = math.dist(first.place, second.place)
        if apart < CLOSEST:
            what = "the balls {first} and {second} are {apart} apart"
            remedy, far = "One ball stands at one place: check their coordinates", format_quantity(apart, "mm", 3)
            raise DescriptionError(what, remedy, first=first.name, second=second.name, apart=far)
    return balls


class GridTable(Table):
    """grid: balls of a plate, in rows and columns."""

    origin: Spot = Field(examples=['["0 mm", "0 mm", "50 mm"]'])
    count: Annotated[tuple[int, int], AS_TUPLE] = Field(examples=["[5, 5]"])
    pitch: Annotated[tuple[Length, Length], AS_TUPLE] = Field(examples=['["80 mm", "80 mm"]'])
    along: Annotated[tuple[Direction, Direction], AS_TUPLE] = Field(
        default=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)), examples=['["x", "y"]']
    )


def _grid(grid: GridTable, known: Beside) -> tuple[Ball, ...]:
    if known.data.get("balls"):
        raise DescriptionError("balls and grid exclude one another", "Give one of them")
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


def _calibrated(std: float, known: Beside) -> float:
    """Return the std of balls that are known together; refused where their turn is open."""
    balls = known.data.get("grid") or known.data.get("balls") or ()
    points = np.array([ball.place for ball in balls]).reshape(-1, 3)
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False) if len(balls) > 2 else np.zeros(3)
    if spread[1] < _OFF_LINE:
        what = "balls that are calibrated together need at least three that are not in a line: their turn is open"
        raise DescriptionError(what, "Take calibrated out, and each ball stands where it stands")
    return std


def _box(box: Mapping[str, Ends]) -> tuple[Ends, ...]:
    if not box or not set(box) <= set("xyz"):
        remedy = 'Write {{ x = ["-250 mm", "250 mm"], z = ["-300 mm", "-150 mm"] }}, in the workpiece frame'
        raise DescriptionError("{text} is no box", remedy, text=shown(dict(box)))
    return tuple(box.get(letter, (-_FAR, _FAR)) for letter in "xyz")


class ArtefactTable(Table):
    """[[artefacts]]: what stands on the table to be read."""

    name: Name = Field(examples=['"three spheres"'])
    balls: Annotated[tuple[Ball, ...], ReadAs(Annotated[dict[str, Ball], EachAs(dict[str, Spot], _ball)], _apart)] = (
        Field((), examples=['{ low = ["200 mm", "0 mm", "-80 mm"] }'])
    )
    grid: Annotated[tuple[Ball, ...], ReadAs(GridTable, _grid, by=True)] = Field(
        (), examples=["{ origin = […], count = [5, 5], pitch = […] }"]
    )
    diameter: Placed | None = Field(None, examples=['"25 mm"'])
    calibrated: Annotated[float, ReadAs(Placed, _calibrated, by=True)] | None = Field(None, examples=['"0.7 um"'])
    scale: Scale = Field(SCALE, examples=['"0.5 um/m"'])
    placed: Placed = Field(PLACED, examples=['"1 mm"'])
    turned: Turned = Field(TURNED, examples=['"1 mrad"'])
    free: Direction = Field((0.0, 0.0, 1.0), examples=['"z"'])
    cone: Cone = Field(CONE, examples=['"100 deg"'])
    keep_out: list[Annotated[tuple[Ends, ...], ReadAs(dict[str, Span], _box)]] = Field(
        default=[], examples=['[{ z = ["-300 mm", "-150 mm"] }]']
    )
    serial: Printable = Field("", examples=['"K3-0042"'])
    certificate: Printable = Field("", examples=['"PTB 50123/26"'])

    def artefact(self) -> Artefact:
        """Return what stands there."""
        alike = ("name", "diameter", "calibrated", "scale", "placed", "turned", "free", "cone")
        same = {key: getattr(self, key) for key in alike}
        return Artefact(balls=self.grid or self.balls, keep_out=tuple(self.keep_out), **same)


def read_artefacts(tables: list[ArtefactTable], document: Document) -> Mapping[str, Artefact]:
    """Return the artefacts by name; raises DescriptionError at the line that is wrong."""
    refuse_same_name([table.name for table in tables], document, "artefacts", 'two artefacts are called "{name}"')
    return {table.name: table.artefact() for table in tables}


def unused_artefacts(text: str) -> str | None:
    """Return a sentence about artefacts that no set-up of a campaign file names; None where all are read."""
    data = tomllib.loads(text)
    read = {table.get("artefact") for table in data.get("setups", [])}
    left = [shown(table["name"]) for table in data.get("artefacts", []) if table["name"] not in read]
    if not left:
        return None
    sentence = "nothing reads {names}: write artefact = {first} in a set-up, or take its table out."
    return said(sentence, names=joined(left), first=left[0])
