"""Every curve of what is known with its 95 % band: pictures for a notebook, arrays for xarray."""

from __future__ import annotations

from dataclasses import dataclass, field
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from axiscal.estimation.accuracy.expanded import BAND
from axiscal.language.spoken import said
from axiscal.present.drawing.plot import Plot
from axiscal.present.sentences import unit_text
from axiscal.units import to_unit
from axiscal_core import refusals
from axiscal_core.known import Known
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal
from axiscal_core.refusals import Array, one
from axiscal_core.terms import Term

_WIDE, _NARROW = 640, 360
"""Pixels; a matter of taste."""
_SHOWN = 201
"""Points of a drawn line: more than a page has pixels for its bends."""


@dataclass(frozen=True, slots=True)
class NotebookPicture:
    """A picture that a notebook shows.  plots : side by side"""

    plots: tuple[Plot, ...] = field(repr=False)

    @property
    def svg(self) -> tuple[str, ...]:
        """Each plot as the text of an SVG file."""
        return tuple(plot.svg(_WIDE if len(self.plots) == 1 else _NARROW) for plot in self.plots)

    def _repr_html_(self) -> str:
        return "".join(self.svg)


class DrawnCurve(NamedTuple):
    """An error along its axis.

    of, along : "rad" or "m", what its values are and what positions are; at : (n,) from end to end
    mean, std : (n,) with what no spline follows
    """

    name: str
    of: str
    along: str
    at: Array
    mean: Array
    std: Array

    @property
    def unit(self) -> str:
        """In which its values are shown."""
        return "urad" if self.of == "rad" else "um"

    def plot(self) -> Plot:
        """Return the curve with its band, as it is drawn."""
        turns = self.along == "rad"
        shown, text = ("deg", said("position, °")) if turns else ("mm", said("position, mm"))
        x, unit = to_unit(self.at, shown).tolist(), self.unit
        middle, half = (to_unit(each, unit).tolist() for each in (self.mean, BAND * self.std))
        return Plot(self.name, text, f"{self.name}, {unit_text(unit)}", x, middle, half)


def drawn(machine: Machine, term: Term, known: Normal) -> DrawnCurve:
    """Return a curve of a machine.  known : of its coefficients, others behind them"""
    at = np.linspace(term.spline.knots[0], term.spline.knots[-1], _SHOWN)
    own = Normal(known.mean[term.columns], known.covariance[term.columns, term.columns]).through(term.spline.rows(at))
    of, along = ("rad" if turns else "m" for turns in (term.angular, machine.axes[term.axis].rotary))
    return DrawnCurve(term.name, of, along, at, own.mean, np.hypot(own.std, term.rest))


def plot(known: Known) -> NotebookPicture:
    """Return a picture of every curve with its 95 % band; raises axiscal_core.InputError."""
    one("plot", "known", known, Known, "what `case.estimate` returns")
    machine, normal = known.case.machine, known.normal
    curves = (drawn(machine, term, normal) for term in machine.curves if term.spline.size > 1)
    return NotebookPicture(tuple(curve.plot() for curve in curves))


def to_xarray(known: Known) -> Any:
    """Return an `xarray.Dataset`: mean and std of each curve over its axis, m and rad; raises axiscal_core.InputError.

    EXX is EXX_mean and EXX_std over EXX_at.
    """
    one("to_xarray", "known", known, Known, "what `case.estimate` returns")
    data = dict[str, tuple[str, Array, dict[str, str]]]()
    machine, normal = known.case.machine, known.normal
    for curve in (drawn(machine, term, normal) for term in machine.curves):
        along, of = f"{curve.name}_at", {"units": curve.of}
        data |= {along: (along, curve.at, {"units": curve.along})}
        data |= {f"{curve.name}_mean": (along, curve.mean, of), f"{curve.name}_std": (along, curve.std, of)}
    try:
        return import_module("xarray").Dataset(data)
    except ModuleNotFoundError as missing:
        raise refusals.InputError("to_xarray", "xarray", "is not installed", "pip install xarray") from missing
