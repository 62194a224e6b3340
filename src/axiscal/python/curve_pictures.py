"""Every curve of what is known with its 95 % band: pictures for a notebook, arrays for xarray."""

from __future__ import annotations

from dataclasses import dataclass, field
from importlib import import_module
from typing import Any

import numpy as np

from axiscal.present.rendering import curve_pictures
from axiscal.python.own_report import result_of
from axiscal_core import refusals
from axiscal_core.known import Known
from axiscal_core.normal import Normal
from axiscal_core.refusals import Array, one

_SHOWN = 201
"""Points of a drawn line: more than a page has pixels for its bends."""


@dataclass(frozen=True, slots=True)
class NotebookPicture:
    """A picture that a notebook shows.  svg : of each curve, the text of an SVG file"""

    svg: tuple[str, ...] = field(repr=False)

    def _repr_html_(self) -> str:
        return "".join(self.svg)


def plot(known: Known) -> NotebookPicture:
    """Return a picture of every curve with its 95 % band; raises axiscal_core.InputError."""
    one("plot", "known", known, Known, "what `case.estimate` returns")
    return NotebookPicture(tuple(curve_pictures(result_of(known, "Machine"))))


def to_xarray(known: Known) -> Any:
    """Return an `xarray.Dataset`: mean and std of each curve over its axis, m and rad; raises axiscal_core.InputError.

    EXX is EXX_mean and EXX_std over EXX_at.
    """
    one("to_xarray", "known", known, Known, "what `case.estimate` returns")
    data = dict[str, tuple[str, Array, dict[str, str]]]()
    machine, normal = known.case.machine, known.normal
    for term in machine.curves:
        at = np.linspace(term.spline.knots[0], term.spline.knots[-1], _SHOWN)
        columns = term.columns
        own = Normal(normal.mean[columns], normal.covariance[columns, columns]).through(term.spline.rows(at))
        turned, of = ("rad" if turns else "m" for turns in (machine.axes[term.axis].rotary, term.angular))
        along = f"{term.name}_at"
        data |= {along: (along, at, {"units": turned})}
        data |= {f"{term.name}_mean": (along, own.mean, {"units": of})}
        data |= {f"{term.name}_std": (along, np.hypot(own.std, term.rest), {"units": of})}
    try:
        return import_module("xarray").Dataset(data)
    except ModuleNotFoundError as missing:
        raise refusals.InputError("to_xarray", "xarray", "is not installed", "pip install xarray") from missing
