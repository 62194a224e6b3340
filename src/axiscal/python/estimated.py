"""The estimate of a machine, in Python: curves with bands, deviations, tables, a picture."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from axiscal.description.placed_readings import placed_readings
from axiscal.document.ports import ours
from axiscal.errors.model import ErrorFunction
from axiscal.estimation.belief import Belief
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.machine_estimate import Band
from axiscal.estimation.prediction import tcp_prediction
from axiscal.estimation.promise.agreement import Agreement
from axiscal.estimation.wrong_unit import refuse_implausible
from axiscal.exceptions import ReadingError
from axiscal.machine.description import Machine
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.reading import Reading
from axiscal.present.delivery import write_files
from axiscal.python.curve import Curve
from axiscal.python.measured_case import Case, Quantity, si
from axiscal.python.pictures import html_table
from axiscal.tables import registry
from axiscal.tables.exporter import ExportOptions
from axiscal.units import to_unit

if TYPE_CHECKING:
    from axiscal.python.pictures import NotebookPicture

_CAMPAIGN = "ports.fleet.type_learning:campaign_with_sisters"
Pose = Mapping[str, Quantity]
"""Coordinates by axis, m or rad or text; an axis that is left out stands in the middle of its travel."""


def estimate(campaign: Case | str | Path, readings: Sequence[Reading] | str | Path) -> Estimated:
    """Return what readings make known of a machine.

    campaign : a case, or the file campaign.toml; readings : of `Reading`, or a file that `axiscal data estimate` reads
    Raises InputError with file, line, value and remedy.
    """
    description = campaign.description if isinstance(campaign, Case) else ours(_CAMPAIGN)(campaign, target_needed=False)
    if isinstance(readings, str | Path):
        file, readings = readings, placed_readings(read_any(Path(readings)), description, readings)
        refuse_implausible(readings, description, file)
    return Estimated(concluded(case_of(description), tuple(readings)))


class Estimated(Mapping[str, Curve]):
    """The errors of a machine by name, as curves; all of them together give its deviation anywhere."""

    def __init__(self, estimation: Estimation) -> None:
        self.estimation = estimation

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

        approach : +1 or −1 by axis, from which side it comes; raises ReadingError outside the travel
        """
        at = np.array([self._pose(pose) for pose in poses])
        sides = np.array([float((approach or {}).get(axis.name, 0)) for axis in self.machine.axes])
        return Band(*tcp_prediction(self.estimation, at, np.tile(sides, (len(at), 1))))

    def _pose(self, pose: Pose) -> list[float]:
        axes = {axis.name: axis for axis in self.machine.axes}
        for name in pose:
            if name not in axes:
                remedy = "Its axes are {known}"
                raise ReadingError('the machine has no axis "{name}"', remedy, name=name, known=", ".join(axes))
        found = []
        for name, axis in axes.items():
            value = si(pose[name], axis.dimension) if name in pose else sum(axis.travel) / 2
            if not axis.travel[0] <= value <= axis.travel[1]:
                what = "{axis} = {shown} is outside the travel"
                shown, travel = f"{value:g}", axis.travel_text
                raise ReadingError(what, "{axis} goes from {travel}", axis=name, shown=shown, travel=travel)
            found.append(value)
        return found

    def export(self, controller: str, folder: str | Path) -> list[Path]:
        """Write the files of a controller with their README.txt and return them; raises InputError, OSError."""
        offered = registry.export(self.estimation.estimate(), controller, ExportOptions())
        write_files(offered, Path(folder))
        return [Path(folder) / name for name in (*offered.files, "README.txt")]

    def plot(self) -> NotebookPicture:
        """Return a picture of every curve with its 95 % band."""
        from axiscal.python.pictures import curves_picture

        return curves_picture([self[name].line() for name in self if self._function(name).basis.size > 1])

    def _function(self, name: str) -> ErrorFunction:
        return self.estimation.case.errors.names[name]

    def __repr__(self) -> str:
        count = len(self.estimation.readings)
        return f"<{self.machine.name} after {count} readings: {len(self)} errors, {to_unit(self.rms, 'um'):.3g} um RMS>"

    def _repr_html_(self) -> str:
        rows = []
        for name in self:
            curve = self[name]
            before = float(np.sqrt(np.mean(np.diag(self._function(name).covariance)) + curve.rest**2))
            rows.append([name, *(f"{to_unit(size, curve.unit):.3g} {curve.unit}" for size in (before, curve.rms))])
        return html_table(["error", "stated std", "known to (RMS)"], rows, repr(self).strip("<>"))
