"""A headless LinuxCNC for one job after another: configuration text in, motor commands, pins and samples out."""

import json
import re
import shutil
import socket
import tempfile
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import Any, Self

from axiscal.language.spoken import put
from tests.linuxcnc.running import (
    BASE,
    ControlError,
    add_modules,
    available,
    can_compile,
    fill,
    log_of,
    started,
)

__all__ = ["Ending", "Joint", "Session", "Settings", "available", "can_compile", "files", "run"]

_DRIVER = Path(__file__).with_name("driver.py")
_START = 30.0
"""s; LinuxCNC starts in a few, on a busy computer in some more."""


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint of an axis in machine units, mm or inch, deg and seconds, with the text of its COMP_FILE.

    home_offset : coordinate of the place where it is homed
    """

    axis: str
    low: float = -500.0
    high: float = 500.0
    velocity: float = 5000.0
    acceleration: float = 5e5
    table: str | None = None
    home_offset: float = 0.0

    @property
    def rotary(self) -> bool:
        """Whether the axis turns."""
        return self.axis[0] in "ABC"


@dataclass(frozen=True, slots=True)
class Settings:
    """What a LinuxCNC is given besides its joints.

    hal : text of the component, which stands between motion and the motors; "" where nothing does
    kinematics : name of the module; unit : mm or in
    beside : files that lie beside the configuration; sources : of a realtime component, X.comp and what it includes
    """

    hal: str = ""
    kinematics: str = "trivkins"
    unit: str = "mm"
    beside: Mapping[str, str] = field(default_factory=dict)
    sources: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def loading(cls, exported: Mapping[str, str]) -> Self:
        """Return what loads exported files but COMP_FILEs: HAL text in their order, the component and its data."""
        hal = "".join(text for name, text in exported.items() if name.endswith(".hal"))
        sources = {name: text for name, text in exported.items() if name.startswith("axiscal_vcomp")}
        return cls(hal, beside={n: text for n, text in exported.items() if n.endswith(".vcomp")}, sources=sources)


@dataclass(frozen=True, slots=True)
class Ending:
    """Positions at the end of a move, one number for each joint in mm or deg.

    motor : where the motors are sent; command : the positions that LinuxCNC shows; settled : the correction had arrived
    """

    motor: tuple[float, ...]
    command: tuple[float, ...]
    settled: bool


class Session:
    """A LinuxCNC that is switched on and homed, and takes lines: G-code, or what `driver.py` knows; a context manager.

    joints : in the order of their numbers; settings : what LinuxCNC is given besides them
    start : where the motors were sent after homing; errors : messages to the operator so far
    Raises ControlError when LinuxCNC is missing, does not start, does not finish in time, or refuses what is asked.
    """

    def __init__(self, joints: Sequence[Joint], settings: Settings | None = None, timeout: float = 60.0) -> None:
        if not available():
            raise ControlError("LinuxCNC is not here with namespaces of its own", "Install Debian's linuxcnc-uspace")
        self.errors: tuple[str, ...] = ()
        self._timeout = timeout
        self._stack = ExitStack()
        try:
            self._begin(joints, settings or Settings())
            self.start = tuple(self._ask("start")["start"])
        except BaseException:
            self.close()
            raise

    def move(self, codes: Sequence[str]) -> tuple[Ending, ...]:
        """Execute lines, and return where each ended."""
        return tuple(
            Ending(tuple(each["motor"]), tuple(each["command"]), each["settled"])
            for each in self._ask(list(codes))["steps"]
        )

    def sample(self, codes: Sequence[str]) -> tuple[tuple[float, ...], ...]:
        """Execute lines and return what the loaded `sampler` took meanwhile, one row for each servo cycle."""
        result = self._ask({"sample": list(codes)})
        if result["overruns"]:
            raise ControlError(f"{result['overruns']} samples were lost", "Give sampler more depth")
        return tuple(tuple(row) for row in result["samples"])

    def written(self, name: str) -> str:
        """Return a file that LinuxCNC has written into the folder from which it was started."""
        return (self._work / name).read_text(encoding="utf-8")

    @property
    def process_id(self) -> int:
        """That of the first process of the run, in whose namespaces, or its child's, LinuxCNC is."""
        return self._process.pid

    def read(self, pins: Sequence[str]) -> tuple[float, ...]:
        """Return the values of HAL pins or signals."""
        return tuple(self._ask({"read": list(pins)})["values"])

    def close(self) -> None:
        """Stop LinuxCNC; may be called twice."""
        self._stack.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _begin(self, joints: Sequence[Joint], settings: Settings) -> None:
        self._work = Path(tempfile.mkdtemp(prefix="axiscal-linuxcnc-", dir=BASE))
        self._stack.callback(shutil.rmtree, self._work, ignore_errors=True)
        job = json.dumps({"motors": _motors(len(joints), settings.hal)})
        driver = _DRIVER.read_text(encoding="utf-8")
        fill(self._work, {"driver.py": driver, "job.json": job, **files(joints, settings)})
        if settings.sources:
            add_modules(self._work, settings.sources)
        listener = self._stack.enter_context(socket.socket(socket.AF_UNIX))
        listener.bind(str(self._work / "socket"))
        listener.listen(1)
        listener.settimeout(0.1)
        self._process = self._stack.enter_context(started(self._work))
        self._line = self._stack.enter_context(self._accepted(listener))
        self._stack.callback(self._line.shutdown, socket.SHUT_RDWR)
        self._answer(time.monotonic() + _START)

    def _accepted(self, listener: socket.socket) -> socket.socket:
        end = time.monotonic() + _START
        while time.monotonic() < end:
            with suppress(TimeoutError):
                return listener.accept()[0]
            if self._process.poll() is not None:
                raise ControlError("LinuxCNC ended before it was ready:\n{log}", _LOOK, log=log_of(self._work))
        what = "LinuxCNC was not ready in {seconds:g} s:\n{log}"
        raise ControlError(what, _LOOK, seconds=_START, log=log_of(self._work))

    def _ask(self, message: object) -> dict[str, Any]:
        self._line.sendall((json.dumps(message) + "\n").encode())
        result = self._answer(time.monotonic() + self._timeout)
        self.errors += tuple(result["errors"])
        return result

    def _answer(self, end: float) -> dict[str, Any]:
        received = b""
        while not received.endswith(b"\n"):
            self._line.settimeout(max(0.01, end - time.monotonic()))
            try:
                part = self._line.recv(1 << 20)
            except TimeoutError:
                remedy = "Move less far, or faster"
                raise ControlError("LinuxCNC did not finish in {seconds:g} s", remedy, seconds=self._timeout) from None
            if not part:
                raise ControlError("LinuxCNC ended without an answer:\n{log}", _LOOK, log=log_of(self._work))
            received += part
        result: dict[str, Any] = json.loads(received)
        if result["failure"]:
            raise ControlError(put("{message}", message=result["failure"]), "Keep to the limits of the machine")
        return result


_LOOK = "Look at its last words above"


@dataclass(frozen=True, slots=True)
class Run:
    """A whole job: motor commands after homing, each move's end, and the messages to the operator."""

    start: tuple[float, ...]
    steps: tuple[Ending, ...]
    errors: tuple[str, ...]


def run(joints: Sequence[Joint], moves: Sequence[str], timeout: float = 60.0) -> Run:
    """Start LinuxCNC, make the moves (G-code lines), stop it; raises ControlError."""
    with Session(joints, timeout=timeout) as session:
        steps = session.move(moves)
        return Run(session.start, steps, session.errors)


def files(joints: Sequence[Joint], settings: Settings) -> Mapping[str, str]:
    """Return name and text of every file that LinuxCNC reads."""
    return {
        "machine.ini": _ini(joints, settings),
        "machine.hal": _hal(len(joints), settings.hal),
        "sim.tbl": "T1 P1 D6 Z0\n",
        **{f"joint{number}.comp": joint.table for number, joint in enumerate(joints) if joint.table is not None},
        **settings.beside,
    }


def _ini(joints: Sequence[Joint], settings: Settings) -> str:
    letters = "".join(joint.axis for joint in joints)
    gantry = " kinstype=BOTH" if len(set(letters)) < len(letters) else ""
    fastest, hardest = max(joint.velocity for joint in joints), max(joint.acceleration for joint in joints)
    traj: dict[str, object] = {"COORDINATES": letters, "LINEAR_UNITS": _UNITS[settings.unit], "ANGULAR_UNITS": "degree"}
    for limit, kind in product(("MAX", "DEFAULT"), ("LINEAR", "ANGULAR")):
        traj |= {f"{limit}_{kind}_VELOCITY": fastest, f"{limit}_{kind}_ACCELERATION": hardest}
    sections: dict[str, dict[str, object]] = {
        "EMC": {"VERSION": 1.1, "MACHINE": "axiscal"},
        "DISPLAY": {"DISPLAY": "./driver.py"},
        "TASK": {"TASK": "milltask", "CYCLE_TIME": 0.001},
        "RS274NGC": {"PARAMETER_FILE": "sim.var"},
        "EMCMOT": {"EMCMOT": "motmod", "COMM_TIMEOUT": 4.0, "SERVO_PERIOD": _SERVO_PERIOD},
        "EMCIO": {"EMCIO": "io", "CYCLE_TIME": 0.1, "TOOL_TABLE": "sim.tbl"},
        "HAL": {"HALFILE": "machine.hal"},
        "KINS": {"KINEMATICS": f"{settings.kinematics} coordinates={letters}{gantry}", "JOINTS": len(joints)},
        "TRAJ": traj,
    }
    for number, joint in enumerate(joints):
        sections |= _axis(number, joint)
    lines = (
        f"[{name}]\n" + "".join(f"{key} = {value}\n" for key, value in body.items()) for name, body in sections.items()
    )
    return "\n".join(lines)


_UNITS = {"mm": "mm", "in": "inch"}
_SERVO_PERIOD = 1_000_000
"""ns."""


def _axis(number: int, joint: Joint) -> dict[str, dict[str, object]]:
    limits: dict[str, object] = {
        "MIN_LIMIT": joint.low,
        "MAX_LIMIT": joint.high,
        "MAX_VELOCITY": joint.velocity,
        "MAX_ACCELERATION": joint.acceleration,
    }
    drive = {"TYPE": "ANGULAR" if joint.rotary else "LINEAR", "FERROR": 100, "MIN_FERROR": 100}
    table = {} if joint.table is None else {"COMP_FILE": f"joint{number}.comp", "COMP_FILE_TYPE": 0}
    home = {"HOME": 0, "HOME_OFFSET": joint.home_offset, "HOME_SEQUENCE": 0}
    return {f"AXIS_{joint.axis}": limits, f"JOINT_{number}": table | drive | limits | home}


_MOTION = """\
loadrt [KINS]KINEMATICS
loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS
addf motion-command-handler servo-thread
addf motion-controller servo-thread
net estop-loop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
net tool-prep iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
net tool-chg iocontrol.0.tool-change => iocontrol.0.tool-changed
"""
"""What every configuration loads and joins."""


def _fed_back(joint: int) -> str:
    """Return the line by which a motor stands where it is sent."""
    return f"net j{joint}m joint.{joint}.motor-pos-cmd => joint.{joint}.motor-pos-fb\n"


def _motors(count: int, hal: str) -> list[str]:
    """Return the pin or signal of each joint that holds the position its motor is sent to."""
    moved = _moved(hal)
    return [moved.get(n, f"joint.{n}.motor-pos-cmd") for n in range(count)]


def _moved(hal: str) -> dict[int, str]:
    """Return the signals that hold where motors are sent, of the joints whose motors the text moves."""
    tables = re.findall(r"net (\S+)-seen => joint\.(\d+)\.motor-pos-fb", hal)
    whole = re.findall(r"net (vc)-fb-(\d+) \S+ => joint\.\2\.motor-pos-fb", hal)
    return {int(n): f"{name}-motor" for name, n in tables} | {int(n): f"{name}-drv-{n}" for name, n in whole}


def _hal(count: int, hal: str) -> str:
    """Return HAL text; where a motor really turns, its encoder shows where it was sent."""
    moved = _moved(hal)
    straight = "".join(_fed_back(n) for n in range(count) if n not in moved)
    wired = re.sub(r"(axiscal-[a-z0-9-]+)-encoder", r"\1-motor", re.sub(r"net vc-enc-(\d)", r"net vc-drv-\1", hal))
    return _MOTION + straight + _loaded_once(wired)


_LOADED = re.compile(r"^loadrt (\S+) names=(\S+)\n", re.MULTILINE)


def _loaded_once(hal: str) -> str:
    """Return HAL text in which a module that several parts load is loaded once, with all their names."""
    names: dict[str, list[str]] = {}
    for module, given in _LOADED.findall(hal):
        names.setdefault(module, []).append(given)

    def first(found: re.Match[str]) -> str:
        given = names.pop(found[1], None)
        return "" if given is None else f"loadrt {found[1]} names={','.join(given)}\n"

    return _LOADED.sub(first, hal)
