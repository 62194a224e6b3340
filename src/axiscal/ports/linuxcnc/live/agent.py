"""The small program beside a running LinuxCNC: it says how the machine stands, and makes one straight move at a time.

It is sent as text to the system's Python, which alone has the module `linuxcnc`. One JSON line answers one. It executes
only the two kinds of lines below, none faster than `LARGEST`, and none while the machine is not as it has to be. A move
stops if the other side goes away, says nothing for `SILENCE`, or says stop. No further move is made once anybody else
gives LinuxCNC a command. Coordinates are those of the machine, in mm and deg.
"""

from __future__ import annotations

import contextlib
import json
import math
import queue
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import linuxcnc  # type: ignore[import-not-found]

LETTERS = "XYZABCUVW"
_SWITCHED = {"xyzac-trt-kins", "xyzbc-trt-kins", "5axiskins"}
"""Kinematics whose type 1 is identity, or 0 with sparm=identityfirst."""
_DUST = 1e-6
"""mm or deg: the last decimal of what is sent."""
SILENCE = 5.0
"""s; the other side says something every second."""
LARGEST = 3000.0
"""mm/min or deg/min: what a person beside the machine can still stop."""
_STALLED = 120.0
"""s without any motion while the feed override is not zero."""
_WITHIN = 1e-3
"""mm or deg: axes that stand so near to the end of a move have made it, joints so near to their axes are with them."""
_EASED = 1.0
"""s after a change of an override in which other commands are taken to belong to it."""
_FIRST_TURN = 1.0
"""deg: so far each rotary axis turns alone at first."""
_LINES = re.compile(rf"(G53 G1|G38\.3(?!.*[ABC]))((?: [{LETTERS}]-?\d+(?:\.\d+)?)+) F(\d+)")
"""The two kinds of lines; a touch names no rotary axis."""
_PLAIN = "G21 G90 G94 G61 G17 G40"
"""mm, absolute, mm/min, exact stop: before every move, and what was in force is set again at the end."""
_NEEDED = {210, 900, 940, 610}
"""What of it a move goes by, as LinuxCNC names codes, times ten."""
_RESTORED = {200, 210, 900, 910, 930, 940, 950, 610, 611, 170, 180, 190}
"""Codes of G20, G21, G90, G91, G93 to G95, G61, G61.1, G17 to G19."""
_SOMEBODY = "somebody stopped it at the machine, or gave it another command"


class GoneError(Exception):
    """The other side has gone, or has said stop."""


class Agent:
    """LinuxCNC that is looked at and given commands, and the line to the other side."""

    def __init__(self) -> None:
        self.stat, self.command, self.channel = linuxcnc.stat(), linuxcnc.command(), linuxcnc.error_channel()
        self.asked: queue.Queue[dict[str, Any]] = queue.Queue()
        self.heard, self.gone = time.monotonic(), False
        self.before, self.turned = list[str](), set[str]()
        self.moving = False  # a move of ours is under way
        self.ours = -1  # number of the last command that is ours, or known
        self.overrides: object = None
        self.eased = -math.inf
        threading.Thread(target=self._listen, daemon=True).start()

    def serve(self) -> None:
        """Answer until the other side goes; then our move has ended, and modes are as they were, or it is said."""
        with contextlib.suppress(GoneError, OSError):
            while (request := self._next()).get("do") != "bye":
                _tell(self._answer(request))
        self._end_move()
        with contextlib.suppress(OSError):  # somebody may listen
            _tell({"left": self._restore()})

    def leave(self, *_: object) -> None:
        """End as if the other side had gone."""
        self.gone = True

    def _end_move(self) -> None:
        """Stop our move; what others do goes on."""
        if self.moving:
            self.moving = False
            self._give(self.command.abort)

    def _listen(self) -> None:
        for line in sys.stdin:
            self.heard = time.monotonic()
            try:
                request = json.loads(line)
            except ValueError:
                break
            if request.get("do") == "stop":
                break
            if request.get("do") != "alive":
                self.asked.put(request)
        self.gone = True

    def _heed(self) -> None:
        if self.gone or time.monotonic() - self.heard > SILENCE:
            raise GoneError

    def _next(self) -> dict[str, Any]:
        while True:
            self._heed()
            with contextlib.suppress(queue.Empty):
                return self.asked.get(timeout=0.05)

    def _answer(self, request: dict[str, Any]) -> dict[str, Any]:
        try:
            if request["do"] == "status":
                return {"status": self.status()}
            if request["do"] == "probe":
                return {"probe": self.watched(float(request["seconds"]))}
            return self.line(str(request["code"]))
        except GoneError:
            raise
        except Exception as error:  # noqa: BLE001
            self._end_move()
            return {"failure": f"{type(error).__name__}: {error}"}

    def watched(self, seconds: float) -> str:
        """Wait until the probe has been closed and opened by hand; returns what was missing, or nothing."""
        end = time.monotonic() + seconds
        self.stat.poll()
        if self.stat.probe_val:
            return "closed"
        for closed in (True, False):
            while bool(self.stat.probe_val) != closed:
                self._heed()
                if time.monotonic() > end:
                    return "untouched"
                time.sleep(0.01)
                self.stat.poll()
        return ""

    def line(self, code: str) -> dict[str, Any]:
        """Make one move and wait until it is done; whatever is not as it has to be is said instead."""
        if (found := _LINES.fullmatch(code)) is None or not 0 < float(found[3]) <= LARGEST:
            return {"failure": f"{code!r} is no line that is executed here"}
        ends = {word[0]: float(word[1:]) for word in found[2].split()}
        self.stat.poll()
        first = self._first_turn(ends)
        if found[1] == "G38.3":  # it names no rotary axis, and one at a limit would end 1e-17 beyond
            first = {a: limit for a, limit in self.at_limits().items() if a in "ABC"}
        if failure := (first and self._made("G53 G1", first, found[3])) or self._made(found[1], ends, found[3]):
            return {"failure": failure}
        probed = {a: float(at) / self.unit(a) for a, at in zip(LETTERS, self.stat.probed_position, strict=False)}
        return {"tripped": bool(self.stat.probe_tripped), "probed": probed, "probe": bool(self.stat.probe_val)}

    def _first_turn(self, ends: dict[str, float]) -> dict[str, float]:
        """Return the first degree of axes that have not turned yet: it shows whether the joints go with them."""
        ways = {a: end - self.here(a) for a, end in ends.items() if a in "ABC" and a not in self.turned}
        self.turned |= {a for a, way in ways.items() if abs(way) > _WITHIN}
        far = {a: way for a, way in ways.items() if abs(way) > _FIRST_TURN}
        return {a: self.here(a) + math.copysign(_FIRST_TURN, way) for a, way in far.items()}

    def _made(self, kind: str, ends: dict[str, float], feed: str) -> str:
        """Make one move and return what was amiss, or nothing.  ends : letter -> where in the machine, mm or deg"""
        if amiss := self._unfit() or self._plain() or self._unfit():
            return amiss
        begun, probing = [self.here(a) for a in self.letters()], kind == "G38.3"
        ends = ends if probing else self.at_limits() | ends
        words = " ".join(f"{a}{end - (self.shift(a) if probing else 0.0):.6f}" for a, end in ends.items())
        self.moving = True
        self._give(self.command.mdi, f"G21 G90 G94 {kind} {words} F{feed}", wait=False)
        amiss = self._awaited()
        if amiss := "; ".join(self._drain()) or amiss:
            self._end_move()
            return amiss
        self.moving = False
        stood = all(abs(self.here(a) - at) < _WITHIN for a, at in zip(self.letters(), begun, strict=True))
        touched = probing and self.stat.probe_tripped and not stood
        ways = {a: abs(self.here(a) - end) for a, end in ends.items()}
        off = max(min(way % 360, -way % 360) if a in "ABC" else way for a, way in ways.items())  # full turns are none
        if not touched and off > _WITHIN:
            return f"the axes are not where the move ends: {_SOMEBODY}"
        return self._apart()

    def _unfit(self) -> str:
        """Return why no move may begin, or nothing."""
        stat = self.stat
        stat.poll()
        ready = {"homed": True, "estop": False, "enabled": True, "spindle": False}
        if self.drives() != ready or stat.interp_state != linuxcnc.INTERP_IDLE or not stat.inpos:
            return "the machine is no longer as it was"
        if self.before and (stat.task_mode != linuxcnc.MODE_MDI or self._interfered()):
            return _SOMEBODY
        return self._apart()

    def _apart(self) -> str:
        """Return which joint does not stand where its axis does, or nothing; joints come a few cycles later."""
        end = time.monotonic() + 0.2
        while True:
            far = [at - self.here(axis) for axis, at in self.joint_places()]
            joint = next((j for j, way in enumerate(far) if abs(way) > _WITHIN), None)
            if joint is None:
                return ""
            if time.monotonic() > end:
                return f"joint {joint} is {far[joint]:.4g} from its axis: the kinematics are not in their identity mode"
            time.sleep(0.01)
            self.stat.poll()

    def _plain(self) -> str:
        """Set the modes in which moves are meant; returns why not, or nothing.  At first, remember those in force."""
        if not self.before:
            self.before = self._modes()
            self.ours, self.overrides = self.stat.echo_serial_number, self._eases()
            self._give(self.command.mode, linuxcnc.MODE_MDI)
        self._drain()
        ended = self._give(self.command.mdi, _PLAIN)
        self.stat.poll()
        said = "; ".join(self._drain())
        if said or ended != linuxcnc.RCS_DONE or not set(self.stat.gcodes) >= _NEEDED:
            return said or f"{_PLAIN} was not executed"
        return ""

    def _modes(self) -> list[str]:
        """Return the lines that set what is in force."""
        active, (blend, naive) = self.stat.gcodes[1:], self.stat.settings[3:5]
        codes = [f"G{code / 10:g}" for code in active if code in _RESTORED]
        path = [f"G64 P{blend:.6f} Q{naive:.6f}" if blend or naive else "G64"] if 640 in active else []
        feed = [] if 930 in active else [f"F{self.stat.settings[1]:.6f}"]  # with G93 every line has its own
        return [" ".join(codes) or _PLAIN, *path, *feed]

    def _awaited(self) -> str:
        """Wait until our move has ended; returns why it has not, or nothing."""
        stat, number = self.stat, self.ours
        moved, last = time.monotonic(), None
        while True:
            self._heed()
            stat.poll()
            if stat.estop or not stat.enabled:
                return "the drives went off"
            if stat.task_mode != linuxcnc.MODE_MDI or self._interfered():
                return _SOMEBODY
            stands = stat.interp_state == linuxcnc.INTERP_IDLE and stat.inpos and stat.queue == 0
            if stat.echo_serial_number >= number and stat.state != linuxcnc.RCS_EXEC and stands:
                return "" if stat.state == linuxcnc.RCS_DONE else "the line was not completed"
            here = tuple(stat.joint_position)
            if here != last or stat.feedrate == 0.0:
                moved, last = time.monotonic(), here
            if time.monotonic() - moved > _STALLED:
                return f"nothing has moved for {_STALLED:g} s"
            time.sleep(0.005)

    def _give(self, command: Callable[..., object], *words: object, wait: bool = True) -> int:
        """Give LinuxCNC a command, known as ours, and return how it ended, 0 where that is not waited for."""
        command(*words)
        self.ours = int(self.command.serial)
        return int(self.command.wait_complete(5)) if wait else 0

    def _interfered(self) -> bool:
        """Whether another command than ours came. Those of the overrides pass; what they change shows them."""
        for pause in (0.05, 0.0):
            if self._eases() != self.overrides:
                self.overrides, self.eased = self._eases(), time.monotonic()
            if self.stat.echo_serial_number <= self.ours:
                return False
            if time.monotonic() - self.eased < _EASED:
                self.ours = int(self.stat.echo_serial_number)
                return False
            if pause:
                time.sleep(pause)  # what it changes may be seen a moment later
                self.stat.poll()
        return True

    def _eases(self) -> object:
        stat = self.stat
        return stat.feedrate, stat.rapidrate, stat.max_velocity, [each.get("override") for each in stat.spindle]

    def _restore(self) -> str:
        """Set the modes that were in force; returns what is still to be typed, or nothing."""
        lines, stat = self.before, self.stat
        try:
            stat.poll()
        except linuxcnc.error:  # it has ended
            return ", ".join(lines)
        free = stat.enabled and not stat.estop and stat.interp_state == linuxcnc.INTERP_IDLE and stat.inpos
        if lines and not (free and stat.task_mode == linuxcnc.MODE_MDI):
            return ", ".join(lines)
        self._drain()
        for number, line in enumerate(lines):
            if self._give(self.command.mdi, line) != linuxcnc.RCS_DONE or self._drain():
                return ", ".join(lines[number:])
        return ""

    def _drain(self) -> list[str]:
        """Return the messages of LinuxCNC that are errors."""
        messages = iter(self.channel.poll, None)
        return [str(text).strip() for kind, text in messages if kind in (linuxcnc.NML_ERROR, linuxcnc.OPERATOR_ERROR)]

    def status(self) -> dict[str, Any]:
        """Return how the machine stands, mm and deg."""
        self.stat.poll()
        stat, letters, joints = self.stat, self.letters(), range(self.stat.joints)
        return {
            "idle": stat.interp_state == linuxcnc.INTERP_IDLE,
            **self.drives(),
            "feed": float(stat.feedrate),
            "feed_heeded": bool(stat.feed_override_enabled),
            "probe": bool(stat.probe_val),
            "offsets": [float(each) / self.unit("X") for each in stat.tool_offset],
            "rotation": float(stat.rotation_xy),
            "axes": {a: self.limits(a) for a in letters},
            "position": {a: self.here(a) for a in letters},
            "joints": self.joint_places(),
            "compensated": [n for n in joints if self._said(f"JOINT_{n}", "COMP_FILE") or stat.joint[n]["backlash"]],
            "whole": _pin("axiscal-vcomp.active") == "TRUE",
            "checksum": _pin("axiscal-vcomp.checksum"),
            "tip": self._tip(),
        }

    def drives(self) -> dict[str, bool]:
        """Return whether every joint is homed, the drives are on, and a spindle turns or is on."""
        stat = self.stat
        homed = all(stat.homed[joint] for joint in range(stat.joints))
        spins = any(each["enabled"] or each["speed"] for each in getattr(stat, "spindle", ())[: stat.spindles])
        return {"homed": homed, "estop": bool(stat.estop), "enabled": bool(stat.enabled), "spindle": spins}

    def unit(self, letter: str) -> float:
        """Return one mm or deg in the machine's units."""
        return float(self.stat.angular_units if letter in "ABC" else self.stat.linear_units) or 1.0

    def here(self, letter: str) -> float:
        """Return where an axis stands, mm or deg."""
        return float(self.stat.position[LETTERS.index(letter)]) / self.unit(letter)

    def at_limits(self) -> dict[str, float]:
        """Return the axes that stand at one of their limits, with it, mm or deg.

        After a touch LinuxCNC goes on from where they are seen to stand, and takes no line that ends 1e-17 beyond.
        """
        ends = [(a, limit) for a in self.letters() for limit in self.limits(a)]
        return {a: limit for a, limit in ends if abs(self.here(a) - limit) < _DUST}

    def limits(self, letter: str) -> list[float]:
        """Return between which an axis may stand, mm or deg."""
        stated = self.stat.axis[LETTERS.index(letter)]
        return [float(stated[f"{end}_position_limit"]) / self.unit(letter) for end in ("min", "max")]

    def shift(self, letter: str) -> float:
        """Return how far the zero of coordinates in force is from the machine's, mm."""
        stat, k = self.stat, LETTERS.index(letter)
        return float(stat.g5x_offset[k] + stat.g92_offset[k] + stat.tool_offset[k]) / self.unit(letter)

    def letters(self) -> str:
        """Return the axis of each joint."""
        found = re.search(r"coordinates=(\w+)", self._said("KINS", "KINEMATICS"))
        return (found[1] if found else self._said("TRAJ", "COORDINATES") or "XYZ").replace(" ", "").upper()

    def joint_places(self) -> list[tuple[str, float]]:
        """Return the axis of each joint and where the joint stands, mm or deg: two belts as X and Y."""
        at = [float(each) for each in self.stat.joint_position[: self.stat.joints]]
        if self._said("KINS", "KINEMATICS").startswith("corexykins"):
            at[:2] = (at[0] + at[1]) / 2, (at[0] - at[1]) / 2
        return [(axis, place / self.unit(axis)) for axis, place in zip(self.letters(), at, strict=False)]

    def _tip(self) -> bool:
        """Whether switchable kinematics are seen to hold the tool point; not every LinuxCNC shows it."""
        first, *words = self._said("KINS", "KINEMATICS").split() or [""]
        return first in _SWITCHED and _pin(f"kinstype.is-{int('sparm=identityfirst' in words)}") == "TRUE"

    def _said(self, section: str, key: str) -> str:
        """Return what the INI file says, "" where it is silent."""
        return str(linuxcnc.ini(self.stat.ini_filename).find(section, key) or "")


def _pin(name: str) -> str | None:
    """Return what halcmd says of a pin, None where there is none."""
    try:
        found = subprocess.run(["halcmd", "getp", name], capture_output=True, text=True, timeout=5, check=False)
    except OSError:
        return None
    return found.stdout.strip() if found.returncode == 0 else None


def _tell(answer: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(answer) + "\n")
    sys.stdout.flush()


def main() -> None:
    """Serve until the other side closes the line."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)  # the other side says stop, or goes away
    try:
        agent = Agent()
        agent.stat.poll()
        _tell({"ready": True})
    except Exception as error:  # noqa: BLE001
        _tell({"failure": f"LinuxCNC does not run here: {error}"})
        return
    signal.signal(signal.SIGTERM, agent.leave)
    agent.serve()
