"""The tests of other standards than ISO 230-2: circles, diagonals, spindles, axes together; and which one a file holds.

Circular tests by ISO 230-4: readings of a ball bar or a grid plate along a circle, in one or both directions. From the
deviations of the radius, actual minus nominal, with the centre of least squares taken off (LSC):

    G     circular deviation of one direction: max e − min e, the radial width of the path about its own centre
    G_b   bidirectional circular deviation: the same of both paths together about their common centre
    F     radial deviation, largest and smallest deviation of the radius from the nominal one about that centre
    D     mean bidirectional radial deviation: mean of the radii of least squares of both paths, less the nominal one

The standard defines G by the two concentric circles of least separation. The width about the centre of least squares is
never smaller, and a few percent larger at most. The least-squares centre of readings around a turn is that of
r(θ) = r₀ + a cos θ + b sin θ + e(θ).

Diagonal tests by ISO 230-6: a laser along face or body diagonals of the volume, each tested as an axis is.

    E   of each diagonal: bidirectional systematic deviation of positioning;  E_d = max over the diagonals
    B   of each diagonal: reversal;                                           B_d = max over the diagonals

each by the formulas of ISO 230-2 along the diagonal.

Error motions of a spindle or rotary axis by ISO 230-7: a sensor's readings over angle and turns. About the centre of
least squares, with m(θ) the mean over the turns at an angle and e the residual of the readings:

    total          max e − min e over all turns
    synchronous    max m − min m
    asynchronous   the largest width over the turns at one angle, max over θ of (max − min over turns)

A radial sensor sees the place of the target as a first harmonic: it is taken off. Along the axis it is an error motion,
the fundamental, and stays: `axial_` figures are of the readings less their mean alone. The standard asks for twenty
turns at least.

Kinematic tests by ISO 10791-6: a point, or the length of a bar, held while axes move together. Circles with a rotary
axis in step (K), and a point held while a rotary axis of head or table turns (AK, BK, CK). For each test, along each
direction in which it is read, over the whole path

    E_plus, E_minus   max e − min e while the angle grows, while it falls
    E                 max e − min e of both ways together

A constant is the place of the ball or the instrument, and is in none of them; the names of the figures are ours.

(Formulas after ISO 230-4:2005, ISO 230-6:2002, ISO 230-7:2006 and ISO 10791-6:2014, quoted from memory.)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.evaluation.one_axis import Positioning, PositioningTest, arranged, evaluate
from axiscal.exceptions import EvaluationError
from axiscal.measurement.readers.around import (
    CIRCLE,
    HELD,
    TURNS,
    CircularTest,
    HeldPath,
    Turns,
    circle_of,
    held_paths,
    turns_of,
)
from axiscal.measurement.readers.csv_table import CsvTable, table_of
from axiscal.measurement.readers.positioning import positioning_rows
from axiscal.measurement.readers.renishaw import is_rtl, rtl_positioning
from axiscal.measurement.readers.text import read_text
from axiscal.numerics import Array
from axiscal.units import to_unit

_AROUND = 8
"""Angles that tell a centre from a lobed circle of two or three lobes."""
_TURNS = 20
"""Turns that the standard asks for."""
_HELD = 4
"""Readings of a way, below which a range says nothing: the ends and two between."""
_FACES, _BODY = 2, 4
"""Diagonals of a face, and of the body."""


@dataclass(frozen=True, slots=True)
class StandardFigures:
    """Figures by name, m, of the standard whose document is `schema`.

    centre : of a circle, both paths together, m; diagonals : the figures of each by its name
    """

    schema: str
    figures: Mapping[str, float]
    warnings: tuple[str, ...] = ()
    centre: tuple[float, float] | None = None
    diagonals: Mapping[str, Positioning] = field(default_factory=dict)

    def as_json(self) -> dict[str, object]:
        """Return the document, figures in um, those of each diagonal by ISO 230-2."""
        figures: dict[str, object] = {name: to_unit(value, "um") for name, value in self.figures.items()}
        figures = {"figures": figures} if self.schema == _TOGETHER else figures
        each = {name: found.as_json() for name, found in self.diagonals.items()}
        diagonals = {"diagonals": each} if each else {}
        return {"schema": self.schema, "unit": "um", **figures, **diagonals, "warnings": list(self.warnings)}


_TOGETHER = "axiscal-iso10791-6/1"


def figures_of(path: str | Path) -> Positioning | StandardFigures:
    """Return the figures of the standard that a file is a test of; raises ReadingError, EvaluationError."""
    file = read_text(path)
    if is_rtl(file):
        return evaluate(arranged(rtl_positioning(file)))
    table = table_of(file)
    stems = {column.stem for column in table.columns}
    if stems >= HELD:
        return kinematic(held_paths(table))
    if stems >= TURNS:
        return error_motion(turns_of(table))
    if stems >= CIRCLE:
        return circular(circle_of(table))
    if "diagonal" in stems:
        return diagonals({name: arranged(positioning_rows(part)) for name, part in _by_diagonal(table).items()})
    return evaluate(arranged(positioning_rows(table)))


def _by_diagonal(table: CsvTable) -> dict[str, CsvTable]:
    """Return the rows of each diagonal as a separate table."""
    column = table.one_of("diagonal", "diagonal")
    columns = tuple(each for each in table.columns if each is not column)
    names = dict.fromkeys(row.text(column) for row in table.rows)
    return {
        name: replace(table, columns=columns, rows=tuple(row for row in table.rows if row.text(column) == name))
        for name in names
    }


def circular(test: CircularTest) -> StandardFigures:
    """Return G_plus (counter-clockwise), G_minus, G_b, F_max, F_min, D; raises EvaluationError for less than a turn."""
    measured = _ways(test.directions)
    for name, mine in measured.items():
        if not _covers_a_turn(test.angles[mine]):
            what = "the clockwise readings do not go all around"
            what = "the counter-clockwise readings do not go all around" if name == "plus" else what
            raise EvaluationError(what, "Give eight angles or more, no quarter of the turn without one", test.file)
    whole = _centred(test.angles, test.deviations)
    each = {name: _centred(test.angles[mine], test.deviations[mine]) for name, mine in measured.items()}
    figures = {f"G_{name}": float(np.ptp(found.left)) for name, found in each.items()}
    radial = whole.radius + whole.left
    if len(measured) == 2:
        figures["G_b"] = float(np.ptp(whole.left))
        figures["D"] = float(np.mean([found.radius for found in each.values()]))
    figures |= {"F_max": float(radial.max()), "F_min": float(radial.min())}
    missing = () if len(measured) == 2 else ("Only one direction was measured: G_b and D are not known.",)
    return StandardFigures("axiscal-iso230-4/1", figures, missing, whole.centre)


def _ways(directions: Array) -> dict[str, NDArray[np.bool_]]:
    """Return which readings were taken one way and the other, without ways that none was taken on."""
    ways = {"plus": directions > 0, "minus": directions < 0}
    return {name: mine for name, mine in ways.items() if np.any(mine)}


class _Centred(NamedTuple):
    """radius : r₀; centre : (a, b); left : (m,) e, all m"""

    radius: float
    centre: tuple[float, float]
    left: Array


def _centred(angles: Array, deviations: Array) -> _Centred:
    """Return deviations (m,) of a radius without what the place of the centre does, by least squares.

    angles : (m,) rad, on at least half a turn or the centre is not told from the radius
    """
    columns = np.column_stack([np.ones_like(angles), np.cos(angles), np.sin(angles)])
    radius, a, b = np.linalg.lstsq(columns, deviations, rcond=None)[0].tolist()
    return _Centred(radius, (a, b), deviations - columns @ np.array([radius, a, b]))


def _covers_a_turn(angles: Array) -> bool:
    """Whether no gap between neighbouring angles is as large as a quarter of a turn."""
    around = np.sort(np.mod(angles, 2 * np.pi))
    gaps = np.diff(around, append=around[:1] + 2 * np.pi)
    return bool(len(around) >= _AROUND and gaps.max() < np.pi / 2)


def diagonals(tests: Mapping[str, PositioningTest]) -> StandardFigures:
    """Return E_d and B_d, where both directions were measured, of diagonals by name; raises EvaluationError."""
    each = {name: evaluate(test) for name, test in tests.items()}
    both = [found for found in each.values() if found.E is not None and found.B is not None]
    figures = {}
    if len(both) == len(each):
        figures = {"E_d": max(found.E or 0.0 for found in both), "B_d": max(found.B or 0.0 for found in both)}
    few = len(each) not in (_FACES, _BODY)
    asked = f"ISO 230-6 asks for the two diagonals of a face or the four of the body; there are {len(each)}."
    return StandardFigures("axiscal-iso230-6/1", figures, (asked,) if few else (), diagonals=each)


def error_motion(test: Turns) -> StandardFigures:
    """Return radial_total, _synchronous, _asynchronous, the same axial_, and fundamental, of angles and turns.

    Raises EvaluationError for less than two turns.
    """
    turns, count = test.deviations, test.deviations.shape[1]
    if count < 2 or not _covers_a_turn(test.angles):
        what = "an error motion needs two turns, each read at eight angles all around"
        raise EvaluationError(what, "Read more turns at the same angles", test.file)
    around = np.repeat(test.angles, count)
    found = _centred(around, turns.ravel())
    radial, axial = found.left.reshape(turns.shape), turns - turns.mean()
    figures = {**_named("radial", radial), **_named("axial", axial), "fundamental": float(np.hypot(*found.centre))}
    few = () if count >= _TURNS else (f"ISO 230-7 asks for {_TURNS} turns; there are {count}.",)
    return StandardFigures("axiscal-iso230-7/1", figures, few)


def _named(name: str, left: Array) -> dict[str, float]:
    """Return total, synchronous and asynchronous error motion.  left : (angles, turns)"""
    mean = left.mean(axis=1)
    return {
        f"{name}_total": float(np.ptp(left)),
        f"{name}_synchronous": float(np.ptp(mean)),
        f"{name}_asynchronous": float(np.ptp(left, axis=1).max()),
    }


def kinematic(tests: Mapping[str, HeldPath]) -> StandardFigures:
    """Return figures such as `CK_x`, `CK_x_plus`, `CK_x_minus` of tests by name.

    Raises EvaluationError for a way of fewer than four readings.
    """
    figures, warnings = dict[str, float](), list[str]()
    for name, test in tests.items():
        read = _ways(test.directions)
        if any(np.sum(mine) < _HELD for mine in read.values()):
            what = "{name} has a way of fewer than {least} readings"
            raise EvaluationError(what, "Read it at four angles or more", test.file, name=name, least=_HELD)
        for along, values in test.deviations.items():
            stem = f"{name}_{along}" if along else name
            figures[stem] = float(np.ptp(values))
            figures |= {f"{stem}_{way}": float(np.ptp(values[mine])) for way, mine in read.items()}
        if len(read) < 2:
            warnings.append(f"Of {name} only one way was read: what changes with the side is not in its figures.")
    return StandardFigures(_TOGETHER, figures, tuple(warnings))
