"""Printers behind their web servers, which are asked how they stand, moved, and probe.

Written from the protocols that Moonraker and RepRapFirmware document. Tried with Klipper behind Moonraker, no printer;
RepRapFirmware's against a small server that speaks it.
"""

from __future__ import annotations

import hashlib
import http.client
import math
import re
import threading
import time
import urllib.error
import urllib.parse
import urllib.request
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from queue import Empty, Queue
from typing import Any, NamedTuple

from axiscal.document.file import json_or_none
from axiscal.exceptions import InputError, SourceError, TableError, TravelError
from axiscal.language.spoken import later, said
from axiscal.measurement.readers.probe_offset import UNTWISTED
from axiscal.ports.printers.klipper import holds_heights

TIMEOUT = 60.0
"""s for one answer: a probe on a slow printer takes some."""
_HOST = re.compile(r"[A-Za-z0-9](?:[A-Za-z0-9.-]{0,251}[A-Za-z0-9])?(?::[0-9]{1,5})?")
_MOST = 2_000_000
"""Bytes of an answer; an object model has a hundred thousand."""
_SAME = 1e-6
"""mm: rounding of a position that is shown twice."""
_THERE = ("toolhead", "position"), ("gcode_move", "gcode_position")
"""Where Klipper's motors are, and where they are said to be: apart by what is in force."""
_SHIFTED = later("the printer {host} has its coordinates shifted, as by G92 or G10")
_REFUSED, _ABSENT = 300, 404
"""Codes of HTTP from here on say that a request was not done, and this one that there is no such file."""
_FOUND = re.compile(r"[Ss]topped at height (-?\d+(?:\.\d+)?) ?mm")
_AMISS = re.compile(r"^\s*Error:?\s*(.+)$", re.MULTILINE)
"""How RepRapFirmware begins the reply to a line that it did not execute."""
_BEYOND = re.compile(r"Move out of range|outside machine limits|not reachable")
"""How Klipper and RepRapFirmware refuse to go where their axes do not reach."""
_OF_MODEL = "state", "move", "sensors"
"""Parts of RepRapFirmware's object model."""
_POLL = 0.1
"""s between two looks for a reply."""


class Exported(NamedTuple):
    """What an export has for a Klipper that is read as left: a mesh, or the checksum of the whole correction.

    files : its SHA-256 by its name
    """

    mesh: str | None
    checksum: str | None
    files: Mapping[str, str]

    @classmethod
    def from_folder(cls, folder: Path) -> Exported:
        """Return that of the files in a folder; raises TableError, OSError."""
        for name in ("axiscal.vcomp", "bed_mesh.cfg"):
            if (folder / name).is_file():
                data = (folder / name).read_bytes()
                text, files = data.decode(errors="replace"), {name: hashlib.sha256(data).hexdigest()}
                return cls(None, text.split()[-1], files) if name == "axiscal.vcomp" else cls(text, None, files)
        what = "it holds neither a mesh nor a whole correction for Klipper"
        raise TableError(what, "Name the folder that axiscal export --to klipper has written", folder)


class Printer(ABC):
    """A printer behind its web server.  host : name or address, with :PORT where it is another than usual"""

    _again = later("Mend it, then go on with --resume")
    """What is to be done after a fault."""

    def __init__(self, host: str) -> None:
        if not _HOST.fullmatch(host):
            remedy = "Write moonraker:voron.local or duet:192.168.1.7"
            raise SourceError("{text!r} is no name of a printer", remedy, text=host[:60])
        self._host = host

    @abstractmethod
    def refuse_unready(self) -> None:
        """Raise SourceError where the printer is not ready to be measured."""

    @abstractmethod
    def probe_offset(self, read: bool = False) -> tuple[float, float]:
        """Return where the probe is beside the nozzle, x and y, mm.  read : where its heights are"""

    @abstractmethod
    def execute(self, codes: list[str]) -> None:
        """Execute lines."""

    @abstractmethod
    def probed(self, codes: list[str], over: list[str]) -> float:
        """Execute lines, probe, and return the height of the bed there, mm.  over : what brings the nozzle there"""

    def _ask(self, path: str, query: dict[str, str] | None = None, **sent: Any) -> bytes:
        """Return an answer; raises SourceError.  sent : of `_answered`"""
        return self._done(path, *self._answered(path, query, **sent))

    def _held(self, path: str, query: dict[str, str] | None = None) -> bytes | None:
        """Return a file, None where the printer says that there is none; raises SourceError."""
        code, data = self._answered(path, query)
        return None if code == _ABSENT else self._done(path, code, data)

    def _done(self, path: str, code: int, data: bytes) -> bytes:
        if code >= _REFUSED:
            stated = found_at(json_or_none(data), "error", "message")  # Moonraker's, without its traceback
            message = stated if isinstance(stated, str) else data[:2000].decode(errors="replace")
            what = "the printer {host} refused {path} ({code}): {message}"
            raise self._failed(what, path=path, code=code, message=" ".join(message.split())[:200])
        return data

    def _answered(
        self,
        path: str,
        query: dict[str, str] | None = None,
        body: bytes | None = None,
        method: str | None = None,
        kind: str | None = None,
    ) -> tuple[int, bytes]:
        """Return the status of HTTP and what was said, refusals too; raises SourceError where nothing is.

        body : what is sent; kind : of that, where it is another than usual
        """
        url = f"http://{self._host}{path}" + (f"?{urllib.parse.urlencode(query)}" if query else "")
        headers = {} if kind is None else {"Content-Type": kind}
        try:
            code, data = _exchanged(urllib.request.Request(url, body, headers, method=method))
        except (OSError, ValueError, http.client.HTTPException) as fault:
            reason = " ".join(str(fault).split())[:200]
            raise self._failed(
                "the printer {host} does not answer {path}: {reason}", path=path, reason=reason
            ) from None
        if len(data) > _MOST:
            raise self._failed("the printer {host} answers {path} with more than {most} bytes", path=path, most=_MOST)
        return code, data

    def _document(self, path: str, query: dict[str, str] | None = None) -> dict[str, Any]:
        found = json_or_none(self._ask(path, query))
        if not isinstance(found, dict):
            raise self._failed("the printer {host} answers {path} with something that is no JSON object", path=path)
        return found

    def _failed(self, what: str, **values: object) -> InputError:
        failure = self._not_ready(what, said(self._again), **values)
        return TravelError(failure.what, failure.remedy) if _BEYOND.search(failure.what) else failure

    def _not_ready(self, what: str, remedy: str, **values: object) -> SourceError:
        return SourceError(what, remedy, None, None, host=self._host, **values)

    def _height(self, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            what = "the printer {host} answers {value!r} where the height of the bed was expected"
            raise self._failed(what, value=value)
        return float(value)


class Moonraker(Printer):
    """Klipper behind Moonraker: `/printer/gcode/script` answers when the lines are done.

    exported : what is to be in force while it probes; None for nothing
    """

    def __init__(self, host: str, exported: Exported | None = None) -> None:
        super().__init__(host)
        self._exported = exported

    def refuse_unready(self) -> None:
        """Ask for state, homing, mesh and the whole correction."""
        self.refuse_busy()
        found = self._status("toolhead", "bed_mesh", "axiscal", "gcode_move")
        if not set("xyz") <= set(str(found_at(found, "toolhead", "homed_axes") or "")):
            raise self._not_ready("the printer {host} is not homed", "Send G28 first")
        self._refuse_other(found)
        there, asked = (found_at(found, "gcode_move", key) or () for key in ("position", "gcode_position"))
        if _apart(there[:3], asked[:3]):
            raise self._not_ready(_SHIFTED, "Send SET_GCODE_OFFSET X=0 Y=0 Z=0 and G28 first")
        self._refuse_skewed(found)

    def _refuse_skewed(self, found: dict[str, Any]) -> None:
        """Raise SourceError where the motors are not where they are said to be, and are to be."""
        motors, asked = (found_at(found, *key) or () for key in _THERE)
        if self._exported is None and _apart(motors[:2], asked[:2]):
            raise self._not_ready("the printer {host} has a skew in force", "Send SET_SKEW CLEAR=1 first")

    def probe_offset(self, read: bool = False) -> tuple[float, float]:
        """Ask for the section of printer.cfg that the probe has."""
        name = str(found_at(self._status("probe"), "probe", "name") or "probe")
        settings = found_at(self._status(configfile="settings"), "configfile", "settings")
        if read and any(map((found_at(settings, "axis_twist_compensation") or {}).get, UNTWISTED)):
            return 0.0, 0.0
        x, y = (self._height(found_at(settings, name, f"{axis}_offset") or 0.0) for axis in "xy")
        return x, y

    def execute(self, codes: list[str]) -> None:
        """Send the lines."""
        self._script("\n".join(codes))

    def _refuse_other(self, found: dict[str, Any]) -> None:
        """Raise SourceError where anything else is in force than is to be."""
        profile, whole = found_at(found, "bed_mesh", "profile_name"), found_at(found, "axiscal", "active")
        mesh, checksum = (None, None) if self._exported is None else self._exported[:2]
        if profile and mesh is None:
            raise self._not_ready("the printer {host} has a bed mesh in force", "Send BED_MESH_CLEAR first")
        if whole and checksum is None:
            raise self._not_ready("the printer {host} has its whole correction in force", "Send AXISCAL ENABLE=0 first")
        heights = found_at(found, "bed_mesh", "probed_matrix") if profile else None
        if mesh is not None and not holds_heights(heights, mesh):
            what = "the printer {host} does not have the exported mesh in force"
            raise self._not_ready(what, "Send BED_MESH_PROFILE LOAD=NAME first")
        held = found_at(found, "axiscal", "checksum") if whole else None
        if checksum is not None and held != checksum:
            what = "the printer {host} does not have the exported axiscal.vcomp in force"
            raise self._not_ready(what, "Copy it and axiscal.py, start Klipper again, and send AXISCAL ENABLE=1")

    def refuse_busy(self) -> None:
        """Raise SourceError where it is not ready, or prints."""
        found = self._status("webhooks", "print_stats")
        if found_at(found, "webhooks", "state") != "ready":
            what = "the printer {host} is {state!r}, not ready"
            raise self._not_ready(what, "Restart it", state=found_at(found, "webhooks", "state"))
        if found_at(found, "print_stats", "state") in ("printing", "paused"):
            raise self._not_ready("the printer {host} prints", "Wait until it has ended")

    def probed(self, codes: list[str], over: list[str]) -> float:
        """Send the lines and PROBE; `last_z_result` is where it met the bed, before what is in force is added."""
        self.execute([*codes, "PROBE"])
        found = self._status("probe", "toolhead", "gcode_move")
        self._refuse_skewed(found)
        height = self._height(found_at(found, "probe", "last_z_result"))
        if self._exported is None:
            return height
        self.execute(over)  # what is in force acts where the nozzle is
        found = self._status("toolhead", "gcode_move")
        motors, asked = ((found_at(found, *key) or [None] * 3)[2] for key in _THERE)
        return height - (self._height(motors) - self._height(asked))

    def _script(self, script: str) -> None:
        self._ask("/printer/gcode/script", {"script": script}, body=b"")

    def _status(self, *objects: str, **parts: str) -> dict[str, Any]:
        found = self._document("/printer/objects/query", dict.fromkeys(objects, "") | parts)
        status = found_at(found, "result", "status")
        if not isinstance(status, dict):
            raise self._failed("the printer {host} answers no status")
        return status


class Duet(Printer):
    """RepRapFirmware: `/machine/code` of a Duet with a computer beside it, `rr_gcode` of one that stands alone."""

    @cached_property
    def _alone(self) -> bool:
        """Whether it has no computer beside it."""
        try:
            self._document("/machine/model")
        except SourceError:
            return True
        return False

    def refuse_unready(self) -> None:
        """Ask the object model for state, homing and compensation."""
        found = self.refuse_busy()
        axes = found_at(found, "move", "axes")
        homed = [axis.get("homed") for axis in axes if isinstance(axis, dict)] if isinstance(axes, list) else []
        if len(homed) < 3 or not all(each is True for each in homed[:3]):
            raise self._not_ready("the printer {host} is not homed", "Send G28 first")
        place = found_at(found, "move", "workplaceNumber") or 0
        if any((axis.get("workplaceOffsets") or [0] * (place + 1))[place] for axis in axes[:3]):
            raise self._not_ready(_SHIFTED, "Send G10 L2 P{place} X0 Y0 Z0 first", place=place + 1)
        if _compensation(found) != "none":
            raise self._not_ready("the printer {host} has a height map in force", "Send G29 S2 first")

    def refuse_busy(self) -> dict[str, Any]:
        """Return its object model; raises SourceError where it does anything."""
        found = self._model()
        if found_at(found, "state", "status") != "idle":
            what = "the printer {host} is {state!r}, not idle"
            raise self._not_ready(what, "Wait, or end what it does", state=found_at(found, "state", "status"))
        return found

    def compensation(self) -> str:
        """Return the kind of compensation in force."""
        return _compensation(self._model())

    def _model(self) -> dict[str, Any]:
        if not self._alone:
            return self._document("/machine/model")
        self._document("/rr_connect", {"password": ""})
        return {key: self._document("/rr_model", {"key": key}).get("result") for key in _OF_MODEL}

    def probe_offset(self, read: bool = False) -> tuple[float, float]:
        """Ask the object model for the first probe."""
        probes = found_at(self._model(), "sensors", "probes")
        found = found_at(probes[0], "offsets") if isinstance(probes, list) and probes else None
        x, y = (self._height(each) for each in (found or (0.0, 0.0))[:2])
        return x, y

    def execute(self, codes: list[str]) -> None:
        """Send the lines, one by one."""
        for code in codes:
            self._run(code)

    def probed(self, codes: list[str], over: list[str]) -> float:
        """Send the lines and G30 S-1, which probes and only says at which height."""
        self.execute(codes)
        found = _FOUND.search(said := self._run("G30 S-1", wait=True))
        if found is None:
            raise self._failed("the printer {host} answers {message!r} to G30 S-1", message=said.strip()[:200])
        return self._height(float(found[1]))

    def _run(self, code: str, wait: bool = False) -> str:
        """Execute a line and return its reply; raises SourceError where that is an error."""
        return self._sound(code, self._reply(code, wait))

    def _sound(self, code: str, said: str) -> str:
        if (amiss := _AMISS.search(said)) is not None:
            what = "the printer {host} answers {message!r} to {code}"
            raise self._failed(what, message=amiss[1].strip()[:200], code=code)
        return said

    def _reply(self, code: str, wait: bool) -> str:
        if not self._alone:
            return self._ask("/machine/code", body=code.encode()).decode(errors="replace")
        self._ask("/rr_gcode", {"gcode": code})
        end = time.monotonic() + (TIMEOUT if wait else 0.0)
        while not (said := self._ask("/rr_reply").decode(errors="replace")).strip() and time.monotonic() < end:
            time.sleep(_POLL)
        return said


def _exchanged(asked: urllib.request.Request) -> tuple[int, bytes]:
    """Return the status of HTTP and what was said; raises OSError also where that has not all come in time."""
    answers = Queue[tuple[int, bytes] | Exception]()
    threading.Thread(target=lambda: answers.put(_exchange(asked)), daemon=True).start()
    try:
        found = answers.get(timeout=TIMEOUT)
    except Empty:
        raise TimeoutError(f"its answer has not come within {TIMEOUT:g} s") from None
    if isinstance(found, Exception):
        raise found
    return found


def _exchange(asked: urllib.request.Request) -> tuple[int, bytes] | Exception:
    try:
        try:
            answer = urllib.request.urlopen(asked, timeout=TIMEOUT)
        except urllib.error.HTTPError as refusal:
            answer = refusal
        with answer:
            return answer.status, answer.read(_MOST + 1)
    except (OSError, ValueError, http.client.HTTPException) as fault:
        return fault


def _apart(one: Sequence[float], other: Sequence[float]) -> bool:
    """Return whether two positions are not the same, mm."""
    return any(abs(a - b) > _SAME for a, b in zip(one, other, strict=False))


def _compensation(model: dict[str, Any]) -> str:
    return str(found_at(model, "move", "compensation", "type") or "none").lower()


def found_at(found: Any, *keys: str) -> Any:
    """Return what stands under keys in an answer, None where nothing does."""
    for key in keys:
        found = found.get(key) if isinstance(found, dict) else None
    return found
