"""`moonraker:HOST` and `duet:HOST`: a 3D printer that probes its own bed, or balls on it, at the planned points.

A reading is minus the height at which the probe meets the bed: over a high bed the tool is too low by as much.
The probe stands over the point, and the carriage beside it by the probe's offset, as for the printer's own map.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from axiscal.campaign.sources.source import Answer, Request, Skip, at_the_terminal
from axiscal.exceptions import SourceError, TravelError
from axiscal.language.spoken import said
from axiscal.machine.description import Machine
from axiscal.machine.inverse import tip_at
from axiscal.measurement.touched import cycle_of, from_above, read_as, stated
from axiscal.ports.printers.printer import Duet, Moonraker, Printer
from axiscal.units import from_unit, to_unit

_CLEAR, _LIFT, _TRAVEL = 5.0, 600, 3000
"""mm over the bed on the way, mm/min up and across: gentle on any printer."""
_FARTHEST = 5.0
"""mm off the bed's zero; a probe that triggers farther away has met something else, or nothing."""


class PrinterSource:
    """A printer over the network, looked at before the first reading: it probes its bed, or balls on it from above.

    machine : that it is; asked : asks whoever stands at it and returns the answer
    Raises SourceError for a printer that is not ready, not homed, prints, or has a mesh or skew in force.
    """

    def __init__(self, printer: Printer, machine: Machine, asked: Callable[[str], str] = at_the_terminal) -> None:
        self._printer, self._machine, self._asked, self._standing = printer, machine, asked, ""
        printer.refuse_unready()
        self._aside = printer.probe_offset()

    def read(self, request: Request) -> Answer | Skip:
        """Have the probe over the point, come to from the side of the request, and probe; a ball is probed six times.

        A point that it cannot go to is skipped.  Raises SourceError.
        """
        self._refuse_others(request)
        self._printer.refuse_unready()  # somebody may have started a print since
        try:
            return self._ball(request) if request.setup.instrument == "sphere" else self._height(request)
        except TravelError as impossible:
            return Skip(impossible.what)

    def _height(self, request: Request) -> Answer:
        side = {axis.name: sign for axis, sign in zip(request.axes, request.approach, strict=True)}
        at = {axis.name: float(to_unit(value, "mm")) for axis, value in zip(request.axes, request.pose, strict=True)}
        overrun = {axis.name: float(to_unit(axis.overrun, "mm")) for axis in request.axes}
        beside = {name: at[name] - overrun[name] * side[name] for name in "XY"}
        stops = [beside, at] if any(side[name] for name in "XY") else [at]
        height = self._printer.probed(self._way(_CLEAR, stops, self._aside), self._way(_CLEAR, [at], (0.0, 0.0)))
        if not abs(height) <= _FARTHEST:
            what = "the probe met something {height:.3f} mm off the bed's zero"
            remedy = "Look at the probe and its offset; beyond {most:g} mm nothing is believed"
            raise SourceError(what, remedy, height=height, most=_FARTHEST)
        return Answer(-float(from_unit(height, "mm")), live=True)

    def _ball(self, request: Request) -> Answer:
        """Probe the pole, four flanks and the pole again, each from above the highest ball."""
        machine, setup, pose = self._machine, request.setup, np.array(request.pose)
        cycle, met = cycle_of(machine, setup), from_above(machine, pose)
        assert setup.artefact is not None
        over = np.array([*stated(setup, machine, pose)[:2], setup.artefact.points[:, 2].max() + cycle.radius])
        z = machine.index("Z")
        clear = float(to_unit(tip_at(machine, pose[None], over[None])[0, z], "mm")) + _CLEAR
        if setup.artefact.standing != self._standing:
            self._put_down(setup.artefact.standing, clear)
        hits = tip_at(machine, np.tile(pose, (len(met), 1)), stated(setup, machine, pose) + cycle.radius * met)
        for hit in hits:
            stop = {name: float(to_unit(hit[machine.index(name)], "mm")) for name in "XY"}
            hit[z] = from_unit(self._printer.probed(self._way(clear, [stop], self._aside), []), "mm")
        value, *others = read_as(machine, setup, pose, list(hits), met)
        return Answer(value, others=tuple(others), live=True)

    def _put_down(self, standing: str, clear: float) -> None:
        """Lift the probe, and wait until the artefact is put down at its next place."""
        self._printer.moved(["G21", "G90", f"G1 Z{clear:.3f} F{_LIFT}", "M400"])
        answer = self._asked(said("Put it down: {artefact}. Enter goes on, stop ends: ", artefact=standing)).strip()
        if answer:
            remedy = "Give the command again when it is clear"
            raise SourceError("the run was ended by {answer!r}", remedy, answer=answer[:20])
        self._standing = standing
        self._printer.refuse_unready()

    @staticmethod
    def _way(clear: float, stops: Sequence[Mapping[str, float]], aside: tuple[float, float]) -> list[str]:
        """Return the lines that lift the tool and bring what is beside the nozzle over stops, mm."""
        codes = ["G21", "G90", f"G1 Z{clear:.3f} F{_LIFT}"]
        codes += [f"G1 X{stop['X'] - aside[0]:.3f} Y{stop['Y'] - aside[1]:.3f} F{_TRAVEL}" for stop in stops]
        return [*codes, "M400"]

    def close(self) -> None:
        """There is nothing to let go of: the tool stays where it is, over the bed."""

    @staticmethod
    def _refuse_others(request: Request) -> None:
        setup, names = request.setup, {axis.name for axis in request.axes}
        upright = abs(setup.direction[2]) > 1 - 1e-9 and setup.direction[2] > 0
        bed = setup.instrument == "probe" and upright and {"X", "Y"} <= names
        if not bed and not (setup.instrument == "sphere" and set("XYZ") <= names):
            remedy = 'It probes its bed, instrument = "probe" and direction = "z", or balls, instrument = "sphere"'
            raise SourceError("a printer cannot take the readings of the set-up {setup}", remedy, setup=setup.name)


def reached(kind: str, host: str, machine: Machine) -> PrinterSource:
    """Return the printer behind a web server; raises SourceError.  kind : of `open_source`"""
    return PrinterSource({"moonraker": Moonraker, "duet": Duet}[kind](host), machine)
