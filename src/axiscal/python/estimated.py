"""The estimate of a machine, in Python: curves with bands, deviations, tables, a picture."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from html import escape
from importlib import import_module
from pathlib import Path
from typing import Any, Self, TypeAlias

import numpy as np

from axiscal.answers.prediction import pose_and_sides, tcp_joint, tcp_normal
from axiscal.errors.term import Term
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.belief import Belief
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import in_detail
from axiscal.estimation.estimation import Estimation, expanded_uncertainty
from axiscal.estimation.promise.agreement import Agreement
from axiscal.exceptions import ReadingError
from axiscal.language.spoken import said
from axiscal.machine.description import Machine
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.present.delivery import deliver, evaluated, write_files
from axiscal.present.drawing.plot import Plot
from axiscal.present.sentences import unit_text
from axiscal.present.summarising import Extras
from axiscal.python.given import GivenReadings, readings_of
from axiscal.tables import registry
from axiscal.tables.exporter import ExportOptions
from axiscal.units import format_quantity, to_unit
from axiscal_core import curve as own
from axiscal_core import refusals
from axiscal_core.normal import Normal
from axiscal_core.refusals import Array, finite, one, sided, whole
from axiscal_core.units import EITHER, METRES, RADIANS, Quantity, quantities, si


def html_table(heads: Sequence[str], rows: Sequence[Sequence[str]], caption: str) -> str:
    """Return a table with a caption."""
    head = "".join(f"<th>{escape(text)}</th>" for text in heads)
    body = "".join("<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>" for row in rows)
    return f"<table><caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


_WIDE, _NARROW = 640, 360
"""Pixels; a matter of taste."""


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


_SHOWN = 201
"""Points of a drawn line: more than a page has pixels for its bends."""


class MeanAndStd(Normal):
    """A normal that is, as a pair, its mean and its standard deviation."""

    def __iter__(self) -> Iterator[Array]:
        return iter((self.mean, self.std))


class Curve(own.Curve):
    """A cubic spline of which mean and covariance are known; nothing changes it, reading returns another.

    travel : its two ends; std : of its values before any reading; length : over which they are alike, None for
        independent control values; knots : how many, evenly spaced
    raises axiscal_core.InputError
    """

    name, rest, unit, position_unit = "curve", 0.0, "um", "mm"

    def __init__(
        self, travel: Sequence[Quantity], std: Quantity, length: Quantity | None = None, knots: int = 7
    ) -> None:
        ends = quantities(travel, "Curve", "travel", (2,), [METRES])
        super().__init__(ends, si(std, "Curve", "std", METRES), knots, length)

    @property
    def belief(self) -> Belief:
        """What is known of its control values."""
        return Belief(self.known.mean, self.known.covariance)

    def __call__(self, t: Quantity | Sequence[Quantity] | Array) -> MeanAndStd:
        """Return mean and standard deviation at positions t within the travel, m or rad, (m,)."""
        found = super().__call__(t)
        return MeanAndStd(found.mean, found.covariance + self.rest**2 * np.eye(len(found.mean)))

    @property
    def rms(self) -> float:
        """The root of the mean variance over the travel, rest included (B&H eq. 26), m or rad."""
        return float(np.hypot(super().rms, self.rest))

    def read(self, t: Quantity, value: Quantity, noise: Quantity) -> Self:
        """Return the curve after a reading at t; raises InputError for one of an estimate, which has its readings.

        The part that no spline can follow repeats at each place: only a whole estimate keeps it apart.
        """
        if self.rest > 0:
            what, remedy = "has a rest that readings share", "Give them to `ac.estimate`"
            raise refusals.InputError("Curve.read", self.name, what, remedy)
        after = copy(self)
        after.known = super().read(t, value, noise).known
        return after

    def plot(self) -> NotebookPicture:
        """Return a picture: mean, and the band that holds it with 95 %."""
        return NotebookPicture((self.line(),))

    @property
    def drawn_at(self) -> Array:
        """Positions over the travel, close enough to draw it, m or rad."""
        return np.linspace(self.spline.knots[0], self.spline.knots[-1], _SHOWN)

    def line(self) -> Plot:
        """Return the curve as it is drawn."""
        at = self.drawn_at
        mean, std = self(at)
        along = said("position, °") if self.position_unit == "deg" else said("position, mm")
        shown = [to_unit(each, self.unit).tolist() for each in (mean, BAND * std)]
        x = to_unit(at, self.position_unit).tolist()
        return Plot(self.name, along, f"{self.name}, {unit_text(self.unit)}", x, *shown)

    def __repr__(self) -> str:
        low, high = (to_unit(float(end), self.position_unit) for end in self.spline.knots[[0, -1]])
        size = f"known to {format_quantity(self.rms, self.unit, 3)}"
        return f"<Curve {self.name}: from {low:g} to {high:g} {self.position_unit}, {size}>"


Poses: TypeAlias = Mapping[str, Quantity] | Sequence[Sequence[Quantity]] | Array
"""Coordinates of one pose by axis, or an array (m, q) in the order of the axes."""


def names_of(observation: Observation) -> tuple[str, ...]:
    """Return the name of every unknown: "EXX[3]", "laser.zero"; what several set-ups share has that of the first."""
    own = dict[int, str]()
    counted = ((term.name, range(term.columns.stop - term.columns.start)) for term in observation.errors.terms)
    for index, setup in enumerate(observation.setups):
        for column, unknown in zip(observation.unknowns_of(index).tolist(), setup.unknowns, strict=True):
            own.setdefault(column, f"{setup.name}.{unknown.name}")
    return (*(f"{name}[{i}]" for name, each in counted for i in each), *(own[column] for column in sorted(own)))


class UnknownError(refusals.InputError, KeyError):
    """An error that a machine has not: a mapping has no such key."""

    __str__ = BaseException.__str__


class Estimated(Mapping[str, Curve]):
    """What is known of a machine: its errors by name, as curves; all together give its deviation anywhere."""

    def __init__(self, case: Case, readings: tuple[Reading, ...]) -> None:
        self._given = case, readings
        self.estimation: Estimation = in_detail(case, readings)

    @property
    def machine(self) -> Machine:
        """The machine."""
        return self.estimation.case.description.machine

    @property
    def names(self) -> tuple[str, ...]:
        """The name of every unknown: "EXX[3]", "laser.zero"."""
        return names_of(self.estimation.case.observation)

    @property
    def mean(self) -> Array:
        """The mean of the unknowns, (n,) m and rad."""
        return self._belief.mean

    @property
    def covariance(self) -> Array:
        """Their covariance, (n, n), causes of type B among it."""
        return self._belief.covariance

    @property
    def _belief(self) -> Belief:
        return self.estimation.printed.belief

    def read(self, readings: GivenReadings) -> Estimated:
        """Return what is known after more readings: all of them are estimated anew."""
        case, before = self._given
        described, more = readings_of(readings, case.description, "Estimated.read", "readings")
        return Estimated(case if described is case.description else replace(case, description=described), before + more)

    def sample(self, count: int, seed: int = 0) -> Array:
        """Return machines that fit the readings, (count, n)."""
        where = "Estimated.sample"
        known = Normal(self.mean, self.covariance)
        return known.sample(whole(where, "count", count, 1), whole(where, "seed", seed, 0))

    def table(self) -> dict[str, list[object]]:
        """Return the unknowns as columns: `pandas.DataFrame(known.table())`."""
        std = np.sqrt(np.diagonal(self.covariance))
        return {"name": [*self.names], "mean": self.mean.tolist(), "std": std.tolist()}

    def to_xarray(self) -> Any:
        """Return an `xarray.Dataset`: mean and std of each error over its axis, m and rad."""
        data = dict[str, tuple[str, Array, dict[str, str]]]()
        for name, curve in self.items():
            at, along = curve.drawn_at, f"{name}_at"
            mean, std = curve(at)
            of = {"units": "rad" if self._function(name).angular else "m"}
            axis = {"units": "rad" if curve.position_unit == "deg" else "m"}
            data |= {along: (along, at, axis), f"{name}_mean": (along, mean, of), f"{name}_std": (along, std, of)}
        try:
            return import_module("xarray").Dataset(data)
        except ModuleNotFoundError as missing:
            what, remedy = "is not installed", "pip install xarray"
            raise refusals.InputError("Estimated.to_xarray", "xarray", what, remedy) from missing

    @property
    def rms(self) -> float:
        """The RMS standard deviation of the tool point over the volume, m."""
        return self.estimation.accuracy.rms

    @property
    def U(self) -> float:  # noqa: N802 (the field's letter)
        """Expanded uncertainty over the volume, m: of all machines and places 5 % are left with a larger deviation."""
        return expanded_uncertainty(self.estimation).space

    @property
    def agreement(self) -> Agreement:
        """Whether the readings agree with each other."""
        return self.estimation.agreement

    def __getitem__(self, name: str) -> Curve:
        """Return one error; raises InputError, which is a KeyError, for a name that the machine has not."""
        if name not in self.estimation.case.errors.names:
            raise UnknownError("Estimated", "name", f"= {name!r} is no error", f"Errors are {', '.join(self)}")
        function, known = self._function(name), self.estimation.printed.belief
        mean, factor = known.mean[function.columns], known.factor[function.columns]
        unit = "urad" if function.angular else "um"
        at = self.machine.axes[function.axis].unit
        curve = Curve.of(function.basis, Normal(mean, factor @ factor.T))
        curve.name, curve.rest, curve.unit, curve.position_unit = name, function.rest, unit, at
        return curve

    def __iter__(self) -> Iterator[str]:
        return iter(self.estimation.case.errors.names)

    def __len__(self) -> int:
        return len(self.estimation.case.errors.functions)

    def deviation(self, *poses: Poses, approach: Mapping[str, int] | None = None, joint: bool = False) -> MeanAndStd:
        """Return the deviation of the tool point in the workpiece frame.

        poses : coordinates by axis, m or rad or text, where one that is left out stands in the middle of its travel; or
            an array (m, q) in the order of the axes
        approach : +1 or −1 by axis, from which side it comes; raises ReadingError outside the travel
        joint : of all poses at once instead, mean (3 m,) and covariance (3 m, 3 m)
        """
        where = "Estimated.deviation"
        one(where, "joint", joint, bool, "True or False")
        axes = {axis.name: RADIANS if axis.rotary else METRES for axis in self.machine.axes}
        sided_by = one(where, "approach", {} if approach is None else approach, Mapping, '{"X": 1}')
        finite(where, "approach", [*sided_by.values()], (None,))
        found = []
        for given in poses:
            one(where, "poses", given, (Mapping, Sequence, np.ndarray), '{"X": "300 mm"}, or an array (m, q)')
            rows = [given] if isinstance(given, Mapping) else quantities(given, where, "poses", (None, len(axes)))
            for row in rows:
                pose = row if isinstance(row, Mapping) else dict(zip(axes, row.tolist(), strict=True))
                position = {name: si(at, where, name, axes.get(name, EITHER)) for name, at in pose.items()}
                try:
                    found.append(pose_and_sides(self.machine, position, sided_by))
                except ReadingError as fault:
                    raise fault.placed(f"{where}: poses") from None
        if not found:
            raise refusals.InputError(where, "poses", "are none", "Give one or more")
        at, sides = np.array(found).reshape(-1, 2, len(axes)).transpose(1, 0, 2)
        came = sided(where, sides, sides.shape)
        return MeanAndStd(**vars((tcp_joint if joint else tcp_normal)(self.estimation, at, came)))

    def export(self, controller: str, folder: str | Path) -> list[Path]:
        """Write the files of a controller with their README.txt and return them; raises InputError, OSError."""
        one("Estimated.export", "controller", controller, str, 'such as "linuxcnc"')
        one("Estimated.export", "folder", folder, (str, Path), 'such as "tables"')
        offered = registry.export(self.estimation.estimate(), controller, ExportOptions())
        write_files(offered, Path(folder))
        return [Path(folder) / name for name in (*offered.files, "README.txt")]

    def report(self, folder: str | Path, language: str | None = None) -> Path:
        """Write report.pdf with result.json, tables and the record into a folder; return the report.

        language : of the report, "en" or "de"; that of AXISCAL_LANGUAGE, or of the campaign, where it is not said
        Raises InputError, OSError; axiscal_core.InputError where nothing was read.
        """
        one("Estimated.report", "folder", folder, (str, Path), 'such as "report"')
        if not self._given[1]:
            raise refusals.InputError("Estimated.report", "readings", "are none", "Estimate a machine from readings")
        with evaluated(self._given[0].description, self._given[1]) as campaign:
            deliver(campaign, campaign.estimate(ended=True), Path(folder), Extras(language=language))
        return Path(folder) / "report.pdf"

    def plot(self) -> NotebookPicture:
        """Return a picture of every curve with its 95 % band."""
        return NotebookPicture(tuple(self[name].line() for name in self if self._function(name).basis.size > 1))

    def _function(self, name: str) -> Term:
        return self.estimation.case.errors.names[name]

    def __repr__(self) -> str:
        count, known = len(self.estimation.readings), format_quantity(self.rms, "um", 3)
        return f"<{self.machine.name} after {count} readings: {len(self)} errors, {known} RMS>"

    def _repr_html_(self) -> str:
        rows = []
        for name in self:
            curve = self[name]
            before = float(np.sqrt(np.mean(np.diag(self._function(name).covariance)) + curve.rest**2))
            rows.append([name, *(format_quantity(size, curve.unit, 3) for size in (before, curve.rms))])
        return html_table(["error", "stated std", "known to (RMS)"], rows, repr(self).strip("<>"))
