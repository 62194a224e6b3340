"""The estimate of a machine, in Python: curves with bands, deviations, tables, a picture."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from copy import copy
from numbers import Real
from pathlib import Path
from typing import Self

import numpy as np

from axiscal.answers.prediction import pose_and_sides, tcp_prediction
from axiscal.campaign.beginning import campaign_with_sisters
from axiscal.campaign.wrong_unit import refuse_implausible
from axiscal.description.campaign import CampaignDescription
from axiscal.description.placed_readings import file_readings, placed_pose
from axiscal.errors.model import ErrorFunction
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.belief import Belief
from axiscal.estimation.estimate import in_detail
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.machine_estimate import Band
from axiscal.estimation.promise.agreement import Agreement
from axiscal.exceptions import InputError, ReadingError, ShapeError
from axiscal.language.spoken import joined
from axiscal.machine.description import Machine
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.reading import Reading, refuse_other_values
from axiscal.present.delivery import deliver, evaluated, write_files
from axiscal.present.drawing.svg_picture import Figure, axis_style, band, layout, line_trace
from axiscal.present.summarising import Extras
from axiscal.python.measured_case import FILL, HEIGHT, LINE, Case, NotebookPicture, html_table
from axiscal.tables import registry
from axiscal.tables.exporter import ExportOptions
from axiscal.units import format_quantity, to_unit
from axiscal_core import curve as alone
from axiscal_core.normal import Normal
from axiscal_core.places import sided
from axiscal_core.refusals import Array, finite, one
from axiscal_core.splines import Spline
from axiscal_core.units import EITHER, METRES, RADIANS, Quantity, quantities, si

_SHOWN = 201
"""Points of a drawn line: more than a page has pixels for its bends."""


class Curve:
    """A cubic spline of which mean and covariance are known; nothing changes it, reading returns another.

    travel : its two ends; std : of its values before any reading; length : over which they are alike, None for
        independent control values; knots : how many, evenly spaced
    raises axiscal_core.InputError
    """

    def __init__(
        self, travel: Sequence[Quantity], std: Quantity, length: Quantity | None = None, knots: int = 7
    ) -> None:
        ends = quantities(travel, "Curve", "travel", (2,), [METRES])
        self._known = alone.Curve(ends, si(std, "Curve", "std", METRES), knots, length)
        self.name, self.rest, self.unit, self.position_unit = "curve", 0.0, "um", "mm"

    @classmethod
    def of(
        cls, name: str, spline: Spline, belief: Belief, rest: float = 0.0, unit: str = "um", position_unit: str = "mm"
    ) -> Self:
        """Return a curve that is known already.

        belief : over the spline's control values; rest : std of what no spline follows, m or rad
        unit, position_unit : in which it is shown
        """
        curve = cls.__new__(cls)
        known = alone.Curve.of(spline, Normal(belief.mean, belief.covariance))
        curve._known, curve.name, curve.rest, curve.unit, curve.position_unit = known, name, rest, unit, position_unit
        return curve

    @property
    def spline(self) -> Spline:
        """The spline."""
        return self._known.spline

    @property
    def belief(self) -> Belief:
        """What is known of its control values."""
        return Belief(self._known.known.mean, self._known.known.covariance)

    def __call__(self, t: Quantity | Sequence[Quantity] | Array) -> Band:
        """Return mean and standard deviation at positions t within the travel, m or rad: a number, or (m,)."""
        known = self._known(t)
        return Band(known.mean, np.hypot(known.std, self.rest))

    @property
    def rms(self) -> float:
        """The root of the mean variance over the travel, rest included (B&H eq. 26), m or rad."""
        return float(np.hypot(self._known.rms, self.rest))

    def next(self, noise: Quantity) -> float:
        """Return where a reading lets the mean variance over the travel fall most, exactly (B&H eq. 27), m or rad."""
        return self._known.next(noise)

    def read(self, t: Quantity, value: Quantity, noise: Quantity) -> Self:
        """Return the curve after a reading at t; raises ShapeError for one of an estimate, which has its readings.

        The part that no spline can follow repeats at each place: only a whole estimate keeps it apart.
        """
        if self.rest > 0:
            raise ShapeError(f"{self.name} has a rest that readings share; give its readings to `ac.estimate`")
        after = copy(self)
        after._known = self._known.read(t, value, noise)
        return after

    def plot(self) -> NotebookPicture:
        """Return a picture: mean, and the band that holds it with 95 %."""
        return NotebookPicture((self.line(),))

    def line(self) -> Figure:
        """Return the curve as it is drawn."""
        at = np.linspace(self.spline.knots[0], self.spline.knots[-1], _SHOWN)
        mean, std = self(at)
        x, middle = to_unit(at, self.position_unit).tolist(), to_unit(mean, self.unit).tolist()
        half = (BAND * to_unit(std, self.unit)).tolist()
        axes = axis_style(f"position, {self.position_unit}"), axis_style(f"{self.name}, {self.unit}")
        data = [band(x, middle, half, FILL), line_trace(x, middle, LINE, 1.5)]
        return {"name": self.name, "data": data, "layout": layout(*axes, HEIGHT)}

    def __repr__(self) -> str:
        low, high = (to_unit(float(end), self.position_unit) for end in self.spline.knots[[0, -1]])
        size = f"known to {format_quantity(self.rms, self.unit, 3)}"
        return f"<Curve {self.name}: from {low:g} to {high:g} {self.position_unit}, {size}>"


def estimate(campaign: Case | str | Path, readings: Iterable[Reading] | str | Path) -> Estimated:
    """Return what readings make known of a machine.

    campaign : a case, or the file campaign.toml; readings : of `Reading`, or a file that `axiscal data estimate` reads
    Raises InputError with file, line, value and remedy.
    """
    one("estimate", "campaign", campaign, (Case, str, Path), 'a case, or "campaign.toml"')
    one("estimate", "readings", readings, (Iterable, str, Path), 'a list of Reading, or "readings.csv"')
    description = (
        campaign.description if isinstance(campaign, Case) else campaign_with_sisters(campaign, target_needed=False)
    )
    if not isinstance(readings, str | Path):
        taken = tuple(readings)
        _refuse_foreign(taken, description)
        return Estimated(description, taken)
    raw = read_any(Path(readings), description.machine.axes, description.setups)
    description, found = file_readings(raw, description, readings)
    refuse_implausible(found, description, readings)
    return Estimated(description, tuple(found))


def _refuse_foreign(readings: Sequence[Reading], description: CampaignDescription) -> None:
    """Raise ReadingError, with its number from 1, for a reading that no set-up of the campaign can have taken."""
    names = [axis.name for axis in description.machine.axes]
    for number, reading in enumerate(readings, start=1):
        try:
            setup = description.setup(one("estimate", "readings", reading, Reading, "a list of Reading").setup)
            refuse_other_values(setup, len(reading.values))
            sides, numbers = reading.approach, (*reading.values, 1.0 if reading.std is None else reading.std)
            if len(reading.pose) != len(names) or len(sides) != len(names) or {*sides} - {-1, 0, 1}:
                remedy = "Give each of {axes} a coordinate and a side"
                raise ReadingError("pose and approach do not have one number an axis", remedy, axes=joined(names))
            if not all(isinstance(each, Real) and np.isfinite(each) for each in numbers) or numbers[-1] <= 0:
                raise ReadingError("its values or its std are no numbers", "Give finite ones, and a std above zero")
            placed_pose(setup, description.machine, dict(zip(names, reading.pose, strict=True)))
        except InputError as failure:
            raise ReadingError(failure.what, failure.remedy, "readings", number) from None


class Estimated(Mapping[str, Curve]):
    """The errors of a machine by name, as curves; all of them together give its deviation anywhere."""

    def __init__(self, campaign: CampaignDescription, readings: tuple[Reading, ...]) -> None:
        self._given = campaign, readings
        self.estimation: Estimation = in_detail(case_of(campaign), readings)

    @property
    def machine(self) -> Machine:
        """The machine."""
        return self.estimation.case.description.machine

    @property
    def rms(self) -> float:
        """The RMS standard deviation of the tool point over the volume, m."""
        return self.estimation.accuracy.rms

    @property
    def agreement(self) -> Agreement:
        """Whether the readings agree with each other."""
        return self.estimation.agreement

    def __getitem__(self, name: str) -> Curve:
        """Return one error; raises KeyError for a name that the machine has not."""
        function, known = self.estimation.case.errors.names[name], self.estimation.printed.belief
        mean, factor = known.mean[function.columns], known.factor[function.columns]
        unit = "urad" if function.angular else "um"
        at = self.machine.axes[function.axis].unit
        return Curve.of(name, function.basis, Belief(mean, factor @ factor.T), function.rest, unit, at)

    def __iter__(self) -> Iterator[str]:
        return iter(self.estimation.case.errors.names)

    def __len__(self) -> int:
        return len(self.estimation.case.errors.functions)

    def deviation(self, *poses: Mapping[str, Quantity], approach: Mapping[str, int] | None = None) -> Band:
        """Return the deviation of the tool point in the workpiece frame, mean and standard deviation, (m, 3), m.

        poses : coordinates by axis, m or rad or text; one that is left out stands in the middle of its travel
        approach : +1 or −1 by axis, from which side it comes; raises ReadingError outside the travel
        """
        where, axes = (
            "Estimated.deviation",
            {axis.name: RADIANS if axis.rotary else METRES for axis in self.machine.axes},
        )
        finite(where, "approach", [*(approach or {}).values()], (None,))
        found = []
        for pose in poses:
            given = one(where, "poses", pose, Mapping, '{"X": "300 mm"}').items()
            position = {name: si(at, where, name, axes.get(name, EITHER)) for name, at in given}
            found.append(pose_and_sides(self.machine, position, approach or {}))
        at, sides = np.array(found).reshape(-1, 2, len(axes)).transpose(1, 0, 2)
        return Band(*tcp_prediction(self.estimation, at, sided(where, sides, sides.shape)))

    def export(self, controller: str, folder: str | Path) -> list[Path]:
        """Write the files of a controller with their README.txt and return them; raises InputError, OSError."""
        one("Estimated.export", "controller", controller, str, 'such as "linuxcnc"')
        offered = registry.export(self.estimation.estimate(), controller, ExportOptions())
        write_files(offered, Path(folder))
        return [Path(folder) / name for name in (*offered.files, "README.txt")]

    def report(self, folder: str | Path) -> Path:
        """Write report.pdf with result.json, tables and the record into a folder; return the report.

        Raises InputError, OSError.
        """
        with evaluated(*self._given) as campaign:
            deliver(campaign, campaign.estimate(ended=True), Path(folder), Extras())
        return Path(folder) / "report.pdf"

    def plot(self) -> NotebookPicture:
        """Return a picture of every curve with its 95 % band."""
        return NotebookPicture(tuple(self[name].line() for name in self if self._function(name).basis.size > 1))

    def _function(self, name: str) -> ErrorFunction:
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
