"""`moonraker:HOST` and `duet:HOST`: a 3D printer that probes its own bed, or balls on it, at the planned points.

A reading is minus the height at which the probe meets the bed: over a high bed the tool is too low by as much.
The probe stands over the point, and the carriage beside it by the probe's offset, as for the printer's own map.

Height maps put into a printer over the network, in force when it is done, and read back.

Written from what Moonraker and RepRapFirmware document. Tried with Klipper behind Moonraker, no printer; for a Duet
against a small server. What is there under the same name is kept beside it.
"""

from __future__ import annotations

import math
import posixpath
import re
import time
import urllib.parse
import zlib
from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from fnmatch import fnmatchcase

import numpy as np

from axiscal.campaign.sources.source import Answer, Request, Skip, at_the_terminal
from axiscal.document import shown
from axiscal.document.file import json_or_none
from axiscal.exceptions import SourceError, TableError, TravelError
from axiscal.language.spoken import later, said
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import tip_at
from axiscal.measurement.instrument import instrument_of
from axiscal.measurement.readers.homing import Place, homed_at, zero_of
from axiscal.measurement.setup import Setup
from axiscal.measurement.touched import FROM_ABOVE, cycle_of, met_from, read_as, stated
from axiscal.ports.printers.klipper import holds_heights, plain_profile
from axiscal.ports.printers.printer import Duet, Moonraker, Printer, found_at
from axiscal.units import from_unit, to_unit

_CONFIG = "axiscal_mesh.cfg"
_INCLUDE = re.compile(r"^\[include\s+(\S.*?)\s*\]", re.MULTILINE)
_MAP, _HOMES_Z = "0:/sys/heightmap.csv", "0:/sys/homez.g"
_STARTING = (404, 503)
"""How Moonraker answers for Klipper while that starts: no such page yet, or nobody there."""
_RESTART = 60.0
"""s for Klipper to read its files again."""
_SWITCHED = 15.0
"""s for a Duet to read a map from its card, and for its object model to say so."""
_POLL = 0.2
"""s between two looks whether it has."""
_BOUNDARY = "axiscal-8f2c61"
"""Between the parts of what is sent; in no file of ours."""


def loader_at(where: str, controller: str) -> MoonrakerLoader | DuetLoader:
    """Return what puts the files of a control into a printer; raises TableError where it takes no files of that.

    where : moonraker:HOST or duet:HOST
    """
    kind, _, host = where.partition(":")
    if kind not in _LOADERS:
        remedy = "Write --load moonraker:voron.local or duet:192.168.1.7"
        raise TableError("{text!r} is no printer", remedy, text=where[:60])
    made = _LOADERS[kind]
    if controller.casefold() != made.controller:
        what, remedy = "{kind} takes no files of {controller}", "Export with --to {needed}"
        raise TableError(what, remedy, kind=kind, controller=shown(controller), needed=made.controller)
    return made(host.strip())


class _Loader(Printer):
    """A printer that takes one file of an export.  controller : what the export is for"""

    controller: str
    _file: str
    _again = later("Mend it, then give the command again")

    @abstractmethod
    def _stored(self, file: str) -> bytes | None:
        """Return a file of the printer, None where there is none; raises SourceError."""

    @abstractmethod
    def _store(self, file: str, data: bytes) -> None:
        """Write a file into the printer; raises SourceError."""

    def _replaced(self, file: str, new: bytes, beside: str) -> str:
        """Write a file, keep the one that was there under another name, and say so; raises SourceError.

        beside : that name, with {digest} in it
        """
        said, old = "", self._stored(file)
        if old not in (None, new):
            kept, data = beside.format(digest=_digest(old or b"")), old or b""
            self._store(kept, data)
            if self._stored(kept) != data:
                raise self._not_ready("the printer {host} did not keep {kept}", "Look at its disk or card", kept=kept)
            said = f"; the one that was there is {kept}"
        self._store(file, new)
        return said

    @abstractmethod
    def zero(self) -> Place | None:
        """Return where the printer homes Z, m, None where its files do not say; raises SourceError."""

    def accepted_text(self, files: Mapping[str, str]) -> str:
        """Return the text that the printer takes; raises TableError where an export does not hold it."""
        if self._file not in files:
            remedy = "Leave --load out; the README of the export says how its files are used"
            raise TableError("the printer takes {needed}, which this export does not hold", remedy, needed=self._file)
        return files[self._file]


class MoonrakerLoader(_Loader, Moonraker):
    """Klipper reads a profile from a file that printer.cfg includes, when it is started again."""

    controller, _file = "klipper", "bed_mesh.cfg"

    def load(self, mesh: str, name: str) -> str:
        """Keep the file that is there, write the profile, start Klipper again, load and compare; raises SourceError."""
        self.refuse_busy()
        kept = self._replaced(_CONFIG, plain_profile(mesh).encode(), "axiscal_mesh_{digest}.bak")  # no *.cfg
        read = _INCLUDE.findall(self._ask("/server/files/config/printer.cfg").decode(errors="replace"))
        if not any(fnmatchcase(_CONFIG, posixpath.normpath(named)) for named in read):  # patterns as Klipper takes them
            what = "the printer {host} has {config} now, and its printer.cfg does not read it"
            remedy = "Write the line [include {config}] at the top of printer.cfg, then again"
            raise self._not_ready(what, remedy, config=_CONFIG)
        self.refuse_busy()  # somebody may have started a print since, which a restart would end
        self._ask("/printer/restart", body=b"")
        self._wait_until_ready()
        self._script(f"BED_MESH_PROFILE LOAD={name}")
        found = self._status("bed_mesh")
        if found_at(found, "bed_mesh", "profile_name") != name or not holds_heights(
            found_at(found, "bed_mesh", "probed_matrix"), mesh
        ):
            what = "the printer {host} does not hold the profile {name} as it was sent"
            raise self._not_ready(what, "Look at its console", name=name)
        return f"{_CONFIG} is in the printer, and its profile {name} is in force{kept}. It has to be homed again."

    def zero(self) -> Place | None:
        """Ask for the configuration that Klipper has read."""
        return zero_of(found_at(self._status(configfile="config"), "configfile", "config") or {})

    def _stored(self, file: str) -> bytes | None:
        return self._held(f"/server/files/config/{file}")

    def _store(self, file: str, data: bytes) -> None:
        head = f"--{_BOUNDARY}\r\nContent-Disposition: form-data; name="
        root, named = f'{head}"root"\r\n\r\nconfig\r\n', f'{head}"file"; filename="{file}"\r\n\r\n'
        body = f"{root}{named}".encode() + data + f"\r\n--{_BOUNDARY}--\r\n".encode()
        self._ask("/server/files/upload", body=body, kind=f"multipart/form-data; boundary={_BOUNDARY}")

    def _wait_until_ready(self) -> None:
        end = time.monotonic() + _RESTART
        while (state := self._state()) != "ready":
            if state in ("error", "shutdown") or time.monotonic() > end:
                what = "the printer {host} is {state!r} after it was started again"
                remedy = "Take [include {config}] out of printer.cfg, and look at its log"
                raise self._not_ready(what, remedy, state=state, config=_CONFIG)
            time.sleep(_POLL)

    def _state(self) -> object:
        """Return the state of Klipper."""
        code, data = self._answered("/printer/info")
        if code in _STARTING:
            return "startup"
        return found_at(json_or_none(data), "result", "state")


class DuetLoader(_Loader, Duet):
    """RepRapFirmware reads `0:/sys/heightmap.csv` at G29 S1."""

    controller, _file = "reprapfirmware", "heightmap.csv"

    def load(self, mesh: str, name: str) -> str:
        """Keep the map that is there, write the new one, load it and compare; raises SourceError."""
        self.refuse_busy()
        kept = self._replaced(_MAP, mesh.encode(), "0:/sys/heightmap_before_axiscal_{digest}.csv")
        if self._stored(_MAP) != mesh.encode():
            remedy = "Look at its card"
            raise self._not_ready("the printer {host} does not hold {kept} as it was sent", remedy, kept=_MAP)
        self.refuse_busy()  # somebody may have started a print since
        if self.compensation() == "mesh":
            self._switch("G29 S2", "none")  # else that of before would be taken for the new one
        self._switch("G29 S1", "mesh")
        return f"{_MAP} is in the printer and in force{kept}."

    def zero(self) -> Place | None:
        """Read the file that homes Z; G30 probes beside the nozzle."""
        x, y = (float(from_unit(each, "mm")) for each in self.probe_offset())
        return homed_at((self._stored(_HOMES_Z) or b"").decode(errors="replace"), (x, y))

    def _switch(self, code: str, kind: str) -> None:
        """Execute a line and wait until the compensation is of a kind; raises SourceError."""
        self._run(code)
        end = time.monotonic() + _SWITCHED
        while (found := self.compensation()) != kind:
            if time.monotonic() > end:
                what = "the printer {host} says its compensation is {found!r} after {code}"
                raise self._not_ready(what, "Look at its console", found=found, code=code)
            time.sleep(_POLL)
            if self._alone:
                self._sound(code, self._ask("/rr_reply").decode(errors="replace"))

    def _stored(self, file: str) -> bytes | None:
        if self._alone:
            return self._held("/rr_download", {"name": file})
        return self._held(f"/machine/file/{urllib.parse.quote(file, safe='')}")

    def _store(self, file: str, data: bytes) -> None:
        if not self._alone:
            self._ask(f"/machine/file/{urllib.parse.quote(file, safe='')}", body=data, method="PUT")
            return
        said = self._ask("/rr_upload", {"name": file, "crc32": _digest(data)}, body=data)
        if found_at(json_or_none(said), "err") != 0:
            raise self._not_ready("the printer {host} did not take {kept}", "Look at its card", kept=file)


def _digest(data: bytes) -> str:
    """Return the CRC-32 of a file: what was kept once is overwritten by nothing else."""
    return f"{zlib.crc32(data):08x}"


_LOADERS: Mapping[str, type[MoonrakerLoader | DuetLoader]] = {"moonraker": MoonrakerLoader, "duet": DuetLoader}


_CLEAR, _LIFT, _TRAVEL = 5.0, 600, 3000
"""mm over the bed on the way, mm/min up and across: gentle on any printer."""
_FARTHEST = 5.0
"""mm off the bed's zero; a probe that triggers farther away has met something else, or nothing."""


_STANDS = 0.1
"""mm, to which a probe may stand elsewhere than stated: nobody measures it better."""


class PrinterSource:
    """A printer over the network, looked at before the first reading: it probes its bed, or balls on it from above.

    machine : that it is; asked : asks whoever stands at it and returns the answer
    Raises SourceError for a printer that is not ready, not homed, prints, or has a mesh or skew in force.
    """

    def __init__(self, printer: Printer, machine: Machine, asked: Callable[[str], str] = at_the_terminal) -> None:
        self._printer, self._machine, self._asked, self._standing = printer, machine, asked, ""
        printer.refuse_unready()
        self._aside, self._reads = printer.probe_offset(), printer.probe_offset(read=True)

    def read(self, request: Request) -> Answer | Skip:
        """Have the probe over the point, come to from the side of the request, and probe; a ball is probed six times.

        A point that it cannot go to is skipped.  Raises SourceError.
        """
        self._refuse_others(request)
        self._refuse_other_offset(request.setup)
        self._printer.refuse_unready()  # somebody may have started a print since
        try:
            return self._ball(request) if instrument_of(request.setup).all_round else self._height(request)
        except TravelError as impossible:
            return Skip(impossible.what)

    def _height(self, request: Request) -> Answer:
        side = {axis.name: sign for axis, sign in zip(request.axes, request.approach, strict=True)}
        at = {axis.name: float(to_unit(value, "mm")) for axis, value in zip(request.axes, request.pose, strict=True)}
        beside = {each.name: at[each.name] - to_unit(each.overrun, "mm") * side[each.name] for each in request.axes}
        stops = [beside, at] if any(side[name] for name in "XY") else [at]
        height = self._printer.probed(self._way(_CLEAR, stops, self._aside), self._way(_CLEAR, [at]))
        self._printer.execute(self._way(_CLEAR, []))  # homing would drag what still touches
        if not abs(height) <= _FARTHEST:
            what = "the probe met something {height:.3f} mm off the bed's zero"
            remedy = "Look at the probe and its offset; beyond {most:g} mm nothing is believed"
            raise SourceError(what, remedy, height=height, most=_FARTHEST)
        return Answer(-float(from_unit(height, "mm")), live=True)

    def _ball(self, request: Request) -> Answer:
        """Probe the pole, four flanks and the pole again, each from above the highest ball."""
        machine, setup, pose = self._machine, request.setup, np.array(request.pose)
        cycle, met = cycle_of(machine, setup), met_from(machine, pose, FROM_ABOVE)
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
        self._printer.execute(self._way(clear, []))
        value, *others = read_as(machine, setup, pose, list(hits), met)
        return Answer(value, others=tuple(others), live=True)

    def _put_down(self, standing: str, clear: float) -> None:
        """Lift the probe, and wait until the artefact is put down at its next place."""
        self._printer.execute(self._way(clear, []))
        answer = self._asked(said("Put it down: {artefact}. Enter goes on, stop ends: ", artefact=standing)).strip()
        if answer:
            remedy = "Give the command again when it is clear"
            raise SourceError("the run was ended by {answer!r}", remedy, answer=answer[:20])
        self._standing = standing
        self._printer.refuse_unready()

    @staticmethod
    def _way(clear: float, stops: Sequence[Mapping[str, float]], aside: tuple[float, float] = (0, 0)) -> list[str]:
        """Return the lines that lift the tool and bring what is beside the nozzle over stops, mm."""
        codes = ["G21", "G90", f"G1 Z{clear:.3f} F{_LIFT}"]
        codes += [f"G1 X{stop['X'] - aside[0]:.3f} Y{stop['Y'] - aside[1]:.3f} F{_TRAVEL}" for stop in stops]
        return [*codes, "M400"]

    def close(self) -> None:
        """There is nothing to let go of: the tool stays where it is, lifted off what was probed last."""

    @staticmethod
    def _refuse_others(request: Request) -> None:
        setup, names = request.setup, {axis.name for axis in request.axes}
        upright = abs(setup.direction[2]) > 1 - 1e-9 and setup.direction[2] > 0
        bed = setup.instrument == "probe" and upright and {"X", "Y"} <= names
        if not bed and not (instrument_of(setup).all_round and set("XYZ") <= names):
            remedy = 'It probes its bed, instrument = "probe" and direction = "z", or balls, instrument = "sphere"'
            raise SourceError("a printer cannot take the readings of the set-up {setup}", remedy, setup=setup.name)

    def _refuse_other_offset(self, setup: Setup) -> None:
        if setup.offset is not None:
            stated = [float(to_unit(each, "mm")) for each in setup.offset[:2]]
            if math.dist(stated, self._reads) > _STANDS:
                what = "the probe of the printer stands {found} mm beside the nozzle along x and y, and not {stated} mm"
                found, given = (" ".join(f"{each:g}" for each in pair) for pair in (self._reads, stated))
                remedy = "Start the campaign again with this offset in campaign.toml"
                raise SourceError(what, remedy, found=found, stated=given)


def moonraker(host: str, machine: Machine, active: bool) -> PrinterSource:
    """Return the Klipper behind a web server, with whatever corrects it; raises SourceError."""
    return PrinterSource(Moonraker(host), machine)


def duet(host: str, machine: Machine, active: bool) -> PrinterSource:
    """Return the RepRapFirmware behind a web server, with whatever corrects it; raises SourceError."""
    return PrinterSource(Duet(host), machine)
