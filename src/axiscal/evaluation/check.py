"""A check of a machine whose tables were loaded: where to read, what was read there, and what it says.

A virtual machine gives as-found and as-left readings: the same truth without tables and with them.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import repeat, zip_longest
from pathlib import Path

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.sources import Request, Skip, Source, virtual_machine
from axiscal.campaign.wrong_unit import refuse_implausible
from axiscal.description.campaign import CampaignDescription
from axiscal.description.placed_readings import placed_readings
from axiscal.description.target import Target
from axiscal.document.durable import write_whole
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.machine_estimate import Estimate
from axiscal.evaluation.datums import Readout, datums_of, fewest, taken_away
from axiscal.evaluation.table_checks import Judgement, Part, far_from, parts_of
from axiscal.evaluation.verification import (
    expected,
    judge,
    plan_check,
    same_place,
    with_displacements,
)
from axiscal.exceptions import InputError, ReadingError, SourceError, TargetError
from axiscal.language.spoken import said
from axiscal.language.stages import stage
from axiscal.measurement.readers.csv_readings import blank_sheet, filled_sheet
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.reading import Place, Places, Reading, shown_pose
from axiscal.measurement.reading_rows import places_of
from axiscal.measurement.simulation import Simulator, VirtualMachine, by_number
from axiscal.numerics import Array
from axiscal.planning.other_readings import with_rooms
from axiscal.tables import registry
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.offer import Export
from axiscal.tables.surface import CommandedMachine
from axiscal.units import parse_quantity


def _read(file: Path, description: CampaignDescription) -> tuple[Reading, ...]:
    return placed_readings(read_any(file, description.machine.axes, description.setups), description, file)


@dataclass(frozen=True, slots=True)
class Sheet:
    """A file of readings at places, one after another.

    wanted : a request for each place
    """

    file: Path
    description: CampaignDescription
    wanted: Sequence[Request]

    def held(self) -> tuple[Reading, ...]:
        """Return the readings that it holds; raises ReadingError where they are of other places."""
        if not self.file.exists():
            return ()
        held = _read(self.file, self.description)
        for reading, place in zip_longest(held, self.wanted[: len(held)]):
            if place is None or not same_place(reading, place.setup.name, place.pose, place.approach):
                what = "it holds readings of other places than this check"
                raise ReadingError(what, "Name another file, or give --points as then", self.file, reading.line)
        return held

    def complete(self) -> bool:
        """Whether it holds all of its readings."""
        return len(self.held()) == len(self.wanted)

    @stage("readings")
    def fill(self, opened: Callable[[], Source]) -> None:
        """Read what is missing; raises ReadingError before that, SourceError with how many readings are kept."""
        readings = list(self.held())
        if not os.access(self.file.absolute().parent, os.W_OK | os.X_OK):
            raise ReadingError("nothing can be written there", "Name a file in a folder of yours", self.file)
        source = opened()
        try:
            for request in self.wanted[len(readings) :]:
                answer = source.read(request)
                if isinstance(answer, Skip):
                    raise SourceError(
                        "{reason}", "Name another number of --points, and other files", reason=answer.reason
                    )
                at = (request.setup.name, request.pose, request.approach)
                readings.append(Reading(*at, answer.value, answer.std, others=answer.others))
                write_whole(self.file, filled_sheet(self.description.machine.axes, readings).encode())
        except InputError as failure:
            kept = "{remedy}. {count} of {wanted} readings are kept in {path}; go on with the same command"
            count, wanted = len(readings), len(self.wanted)
            remedy = said(kept, remedy=failure.remedy, path=self.file, count=count, wanted=wanted)
            raise type(failure)(failure.what, remedy, failure.file, failure.line) from failure
        finally:
            source.close()


_PROBES = 300
"""Places at which is looked what the tables change; any few hundred spread over the volume do."""
FoundAndLeft = tuple[tuple[Reading, ...], tuple[Reading, ...]]
"""Readings without the tables and with them, of the same places."""


@dataclass(frozen=True, eq=False)
class Check:
    """The campaign's estimate, and the tables of one controller that come from it."""

    description: CampaignDescription
    estimation: Estimation
    used: tuple[Reading, ...]
    estimate: Estimate
    tables: Export

    @classmethod
    def from_campaign(cls, campaign: Campaign, controller: str, options: ExportOptions | None = None) -> Check:
        """Return the check of a campaign; raises InputError for a controller that its tables cannot be made for."""
        estimation = campaign.estimate(ended=True)
        estimate = estimation.estimate()
        tables = registry.export(estimate, controller, options or ExportOptions())
        return cls(campaign.description, estimation, tuple(campaign.state.readings), estimate, tables)

    @stage("places to check")
    def planned(self, count: int | None = None, by: str = "", tolerance: float = 0.0) -> Places:
        """Return where to read, set-up by set-up along the axes; raises ReadingError, as `plan_check`.

        by : instrument of the only set-ups that are read, "" for any; count, tolerance : as of `plan_check`
        Places are new, but of a set-up without enough new ones. Set-ups that the campaign has read come alone: of
        others nobody knows how they lie.
        """
        setups, lattice = self.description.setups, self.estimation.case.lattice
        candidates, used = with_displacements(setups, lattice, by), places_of(setups, self.used)
        if len(judges := np.intersect1d(used.setups, candidates.setups)):
            candidates = candidates.within(np.isin(candidates.setups, judges))
        again = np.array([setups[index].name in self.exhausted for index in candidates.setups], dtype=bool)
        new = candidates.within(again | far_from(self.description.machine, candidates, used))
        found = plan_check(self.estimate, setups, new, self.parts, count, tolerance)
        return found.within(np.lexsort((*found.approaches.T[::-1], *found.poses.T[::-1], found.setups)))

    @property
    def parts(self) -> tuple[Part, ...]:
        """The tables, each by itself, those first that correct most."""
        machine, lattice = self.description.machine, self.estimation.case.lattice
        places = lattice.within(np.arange(0, len(lattice), max(1, len(lattice) // _PROBES)))
        parts, readout = parts_of(self.estimate, self.tables), Readout(machine, self.description.setups, places)
        return tuple(sorted(parts, key=lambda part: -float(np.std(taken_away(readout, part.control)))))

    @cached_property
    def exhausted(self) -> set[str]:
        """The set-ups with too few places that were not read, such as a board."""
        setups, lattice, machine = self.description.setups, self.estimation.case.lattice, self.description.machine
        new = far_from(machine, lattice, places_of(setups, self.used))
        return {
            setups[index].name
            for index, mine in lattice.by_setup()
            if np.sum(new[mine]) < fewest(setups[index], lattice.poses[mine], 0.0)
        }

    def predicted(self, places: Places) -> tuple[list[Array], list[Array]]:
        """Return the values (k,) that each place is expected to show without the tables and with them, m."""
        readout = Readout(self.description.machine, self.description.setups, places)
        free = datums_of(readout, np.inf).free  # zeros alone
        each = (free @ expected(self.estimate, readout, control)[0] for control in (None, self.tables.control))
        before, after = ([values[readout.of == i] for i in range(len(places))] for values in each)
        return before, after

    def asked(self, source: str, places: Places) -> FoundAndLeft:
        """Return what a virtual machine shows there; raises SourceError, InputError."""
        simulator = Simulator(self.description.machine, self.description.setups)
        return self.read_on(*virtual_machine(source, simulator), places)

    def read_on(self, truth: VirtualMachine, seed: int, places: Places) -> FoundAndLeft:
        """Return what a given virtual machine shows there."""
        setups, machines = self.description.setups, (truth, CommandedMachine.behind(truth, self.tables.control))
        found, left = (
            machine.measured(setups, places.listed(setups), repeat(0.0), by_number(seed, first))
            for machine, first in zip(machines, _FIRST, strict=True)
        )
        return found, left

    def sheets(self, places: Places, found: Path, left: Path) -> tuple[Sheet, Sheet]:
        """Return the files that a machine that runs fills, without the tables and with them."""
        wanted = requests(self.description, with_rooms(self.estimation.case, places))
        before, after = (Sheet(file, self.description, wanted) for file in (found, left))
        return before, after

    def read(self, found: Path, left: Path) -> FoundAndLeft:
        """Return the readings of two files; raises ReadingError, also where those found have another unit.

        What is left may be anything: tables that a control takes in another unit leave a thousand times as much.
        """
        before, after = (_read(file, self.description) for file in (found, left))
        refuse_implausible(before, self.description, found)
        return before, after

    def judged(self, readings: FoundAndLeft, tolerance: str | None) -> Judgement:
        """Return what readings say; raises ReadingError, TargetError.  tolerance : as of `tolerance_of`"""
        setups, control = self.description.setups, self.tables.control
        known, allowed = self.known(tolerance), tolerance_of(self.description.target, tolerance)
        posterior = self.estimation.posterior
        judged = judge(self.estimate, setups, *readings, control, known, self.parts, allowed, posterior)
        return replace(judged, places=self._positions(readings[1]), promised=self.tables.certain)

    def known(self, tolerance: str | None) -> float:
        """Return to what a set-up has to be known, m: to the tolerance, else to what the tables promise."""
        return tolerance_of(self.description.target, tolerance) or self.tables.certain

    def _positions(self, readings: Sequence[Reading]) -> list[dict[str, float]]:
        """Return where each was read, mm and deg by axis: by the rotary axes that its set-up moves, else by all."""
        axes, found = self.description.machine.axes, list[dict[str, float]]()
        for reading in readings:
            moved = [axes[k] for k in self.description.setup(reading.setup).moves]
            names = [axis.name for axis in moved if axis.rotary] or [axis.name for axis in moved]
            found.append({name: value for name, value in shown_pose(axes, reading.pose).items() if name in names})
        return found

    def sheet(self, places: Places) -> str:
        """Return the places as a file of readings to fill in."""
        setups, axes = self.description.setups, self.description.machine.axes
        return blank_sheet(setups, axes, places)


def requests(description: CampaignDescription, places: Sequence[Place]) -> list[Request]:
    """Return a request for the reading at each place, numbered from 1."""
    return [
        Request(number, description.setup(place.setup), description.machine.axes, place.pose, place.approach)
        for number, place in enumerate(places, start=1)
    ]


def tolerance_of(target: Target, text: str | None) -> float | None:
    """Return the largest deviation allowed, m: as said, or the target's at the worst place; None where there is none.

    Raises TargetError, UnitError.
    """
    if text is None:
        return target.worst
    value = parse_quantity(text, "length")
    if value <= 0:
        raise TargetError('a tolerance of "{text}"', "Give a length above zero", text=text)
    return value


_FIRST = (1_000_000, 2_000_000)
"""Numbers of the readings, so that their noise is that of no reading of the campaign."""
