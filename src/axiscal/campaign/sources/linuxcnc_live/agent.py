"""The small program beside a running LinuxCNC: it says how the machine stands, and makes one straight move at a time.

It runs under the system's Python, which alone has the module `linuxcnc`. One JSON line answers one. Nothing but the few
kinds of lines below is ever executed, none of them faster than `LARGEST`, and none while the machine is not as it has
to be. If the other side goes away, says nothing for `SILENCE`, or says stop, what moves is stopped.
"""

from __future__ import annotations

import json
import queue
import re
import signal
import subprocess
import sys
import threading
import time
from typing import Any

import linuxcnc  # type: ignore[import-not-found]

SILENCE = 5.0
"""s; the other side says something every second."""
LARGEST = 3000.0
"""mm/min or deg/min: what a person beside the machine can still stop."""
_STALLED = 120.0
"""s without any motion while the feed override is not zero."""
_WORD = r"[XYZABCUVW]-?\d+(?:\.\d+)?"
_LINES = tuple(
    re.compile(text)
    for text in (
        rf"G53 G1(?: {_WORD})+ F(\d+)",
        rf"G91 G1(?: {_WORD})+ F(\d+)",
        rf"G91 G38\.3(?: {_WORD})+ F(\d+)",
    )
)
_PLAIN = "G21 G90 G94 G61 G17 G40"
"""mm, absolute, mm/min, exact stop: set before the first move, and what was in force is set again at the end."""
_RESTORED = {200, 210, 900, 910, 930, 940, 950, 610, 611, 640, 170, 180, 190}
"""Codes of G20, G21, G90, G91, G93 to G95, G61, G61.1, G64, G17 to G19 as LinuxCNC names them, times ten."""


class GoneError(Exception):
    """The other side has gone, or has said stop."""


class Agent:
    """LinuxCNC, and the line to the other side."""

    def __init__(self) -> None:
        self.command, self.stat, self.channel = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()
        self.asked: queue.Queue[dict[str, Any]] = queue.Queue()
        self.heard, self.gone = time.monotonic(), False
        self.before = ""
        threading.Thread(target=self._listen, daemon=True).start()

    def serve(self) -> None:
        """Answer until the other side goes; then everything stands, and modes are as they were."""
        try:
            while True:
                request = self._next()
                if request.get("do") == "bye":
                    break
                _tell(self._answer(request))
        except GoneError:
            self.command.abort()
            self.command.wait_complete(5)
        self._restore()

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
            try:
                return self.asked.get(timeout=0.05)
            except queue.Empty:
                continue

    def _answer(self, request: dict[str, Any]) -> dict[str, Any]:
        try:
            if request["do"] == "status":
                return {"status": self.status()}
            if request["do"] == "probe":
                return {"probe": self.watched(float(request["seconds"]))}
            if request["do"] == "line":
                return self.line(str(request["code"]))
            return {"failure": f"{request['do']!r} is not understood"}
        except GoneError:
            raise
        except Exception as error:  # noqa: BLE001
            return {"failure": f"{type(error).__name__}: {error}"}

    def status(self) -> dict[str, Any]:
        """Return how the machine stands, in its own units."""
        stat = self.stat
        stat.poll()
        letters = self._letters()
        joints = range(stat.joints)
        spindles = getattr(stat, "spindle", ())
        return {
            "homed": all(stat.homed[joint] for joint in joints),
            "estop": bool(stat.estop),
            "enabled": bool(stat.enabled),
            "idle": stat.interp_state == linuxcnc.INTERP_IDLE,
            "spindle": any(each["enabled"] or each["speed"] for each in spindles[: stat.spindles]),
            "feed": float(stat.feedrate),
            "feed_heeded": bool(stat.feed_override_enabled),
            "probe": bool(stat.probe_val),
            "offsets": [float(each) for each in stat.tool_offset],
            "rotation": float(stat.rotation_xy),
            "scale": float(stat.linear_units) or 1.0,
            "angular": float(stat.angular_units) or 1.0,
            "axes": {
                a: [stat.axis["XYZABCUVW".index(a)][f"{end}_position_limit"] for end in ("min", "max")] for a in letters
            },
            "position": {a: float(stat.position["XYZABCUVW".index(a)]) for a in letters},
            "joints": [
                [a, float(stat.joint_position[joint])] for joint, a in zip(joints, self._joints(), strict=False)
            ],
            "compensated": [joint for joint in joints if self._compensated(joint)],
            "whole": _pin("axiscal-vcomp.active"),
        }

    def watched(self, seconds: float) -> str:
        """Wait until the probe has been closed and opened by hand; returns what was missing, or nothing."""
        end, stage = time.monotonic() + seconds, 0
        while time.monotonic() < end:
            self._heed()
            self.stat.poll()
            closed = bool(self.stat.probe_val)
            if stage == 0 and closed:
                return "closed"
            stage = max(stage, 1)
            if stage == 1:
                stage, closed = self._pressed(end)
            if stage == 3:
                return ""
        return "untouched"

    def _pressed(self, end: float) -> tuple[int, bool]:
        stage, closed = 1, False
        while time.monotonic() < end and stage < 3:
            self._heed()
            self.stat.poll()
            closed = bool(self.stat.probe_val)
            stage = 2 if stage == 1 and closed else 3 if stage == 2 and not closed else stage
            time.sleep(0.01)
        return stage, closed

    def line(self, code: str) -> dict[str, Any]:
        """Execute one line and wait until it is done; whatever is not as it has to be is said instead."""
        found = next((match for pattern in _LINES if (match := pattern.fullmatch(code))), None)
        if found is None or not 0 < float(found[1]) <= LARGEST:
            return {"failure": f"{code!r} is no line that is executed here"}
        now = self.status()
        if not (now["homed"] and now["enabled"] and now["idle"]) or now["estop"] or now["spindle"]:
            return {"failure": "the machine is no longer as it was", "status": now}
        self._prepare()
        self._drain()
        self.command.mdi(code)
        ended = self._waited()
        if code.startswith("G91"):
            self.command.mdi("G90")
            self.command.wait_complete(5)
        said = self._drain()
        if ended != linuxcnc.RCS_DONE or said:
            self.command.abort()
            self.command.wait_complete(5)
            return {"failure": "; ".join(said) or "the line was not completed"}
        self.stat.poll()
        probed = dict(zip("XYZABCUVW", map(float, self.stat.probed_position), strict=False))
        return {"tripped": bool(self.stat.probe_tripped), "probed": probed, "probe": bool(self.stat.probe_val)}

    def _waited(self) -> int:
        moved, last = time.monotonic(), None
        while True:
            ended = self.command.wait_complete(0.02)
            self._heed()
            if ended != -1:
                return int(ended)
            self.stat.poll()
            here = tuple(self.stat.joint_position)
            if here != last or self.stat.feedrate == 0.0:
                moved, last = time.monotonic(), here
            if self.stat.estop or not self.stat.enabled or time.monotonic() - moved > _STALLED:
                self.command.abort()
                return int(linuxcnc.RCS_ERROR)

    def _prepare(self) -> None:
        """Set the modes in which lines are meant, once, and remember those in force."""
        if self.stat.task_mode != linuxcnc.MODE_MDI:
            self.command.mode(linuxcnc.MODE_MDI)
            self.command.wait_complete(5)
        if not self.before:
            self.stat.poll()
            codes = [code for code in self.stat.gcodes[1:] if code in _RESTORED]
            self.before = " ".join(f"G{code / 10:g}" for code in codes) or _PLAIN
            self.command.mdi(_PLAIN)
            self.command.wait_complete(5)

    def _restore(self) -> None:
        self.stat.poll()
        if self.before and self.stat.enabled and self.stat.interp_state == linuxcnc.INTERP_IDLE:
            self.command.mode(linuxcnc.MODE_MDI)
            self.command.wait_complete(5)
            self.command.mdi(self.before)
            self.command.wait_complete(5)

    def _drain(self) -> list[str]:
        """Return the messages of LinuxCNC that are errors."""
        texts = []
        while (message := self.channel.poll()) is not None:
            if message[0] in (linuxcnc.NML_ERROR, linuxcnc.OPERATOR_ERROR):
                texts.append(str(message[1]).strip())
        return texts

    def _ini(self) -> Any:
        return linuxcnc.ini(self.stat.ini_filename)

    def _joints(self) -> str:
        """Return the axis of each joint."""
        kinematics = self._ini().find("KINS", "KINEMATICS") or ""
        found = re.search(r"coordinates=(\w+)", kinematics)
        return (found[1] if found else self._ini().find("TRAJ", "COORDINATES") or "XYZ").replace(" ", "").upper()

    def _letters(self) -> list[str]:
        return list(dict.fromkeys(self._joints()))

    def _compensated(self, joint: int) -> bool:
        sections = [f"JOINT_{joint}"]
        table = any(self._ini().find(section, "COMP_FILE") for section in sections)
        return table or self.stat.joint[joint]["backlash"] != 0.0


def _pin(name: str) -> bool | None:
    """Return a bit of HAL, None where there is no such pin."""
    try:
        found = subprocess.run(["halcmd", "getp", name], capture_output=True, text=True, timeout=5, check=False)
    except OSError:
        return None
    return found.stdout.strip() == "TRUE" if found.returncode == 0 else None


def _tell(answer: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(answer) + "\n")
    sys.stdout.flush()


def main() -> None:
    """Serve until the other side closes the line."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)  # the other side says stop, or goes away
    try:
        agent = Agent()
        _tell({"ready": True})
    except Exception as error:  # noqa: BLE001
        _tell({"failure": f"LinuxCNC does not run here: {error}"})
        return
    try:
        agent.serve()
    except OSError:  # nobody listens any more
        agent.command.abort()


if __name__ == "__main__":
    main()
