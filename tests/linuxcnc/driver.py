#!/usr/bin/python3
"""The DISPLAY program of a headless LinuxCNC: homes, makes the moves of job.json, writes result.json.

It runs under the system's Python, which alone has the modules `linuxcnc` and `hal`.
"""

from __future__ import annotations

import json
import os
import time
from pathlib import Path
from typing import Any

import hal  # type: ignore[import-not-found]

import linuxcnc  # type: ignore[import-not-found]

UNFINISHED = -1


def wait(condition: Any, seconds: float) -> bool:
    """Return whether the condition came true in time."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.001)
    return True


class Machine:
    """The running LinuxCNC."""

    def __init__(self, joints: int) -> None:
        self.joints = range(joints)
        self.command, self.stat, self.channel = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()
        self.component = hal.component("axiscal")
        self.component.ready()

    def home(self) -> None:
        """Switch on, home every joint in place, accept MDI."""
        self.command.state(linuxcnc.STATE_ESTOP_RESET)
        self.command.state(linuxcnc.STATE_ON)
        self.command.wait_complete(5)
        self.command.home(-1)
        if not wait(self._homed, 10):
            raise RuntimeError("the joints were not homed in 10 s")
        self.command.mode(linuxcnc.MODE_MDI)
        self.command.wait_complete(5)

    def move(self, code: str) -> dict[str, Any]:
        """Execute a line and wait until the correction, which is ramped, has arrived as well."""
        self.command.mdi(code)
        while (ended := self.command.wait_complete(1)) == UNFINISHED:
            pass
        if ended != linuxcnc.RCS_DONE:
            raise RuntimeError(f"{code} was not completed: {self.errors()}")
        settled = wait(self._settled, 0.5)
        return {"settled": settled, "motor": self.pins("motor-pos-cmd"), "command": self.pins("pos-cmd")}

    def pins(self, name: str) -> list[float]:
        """Read one pin of every joint."""
        return [hal.get_value(f"joint.{joint}.{name}") for joint in self.joints]

    def errors(self) -> list[str]:
        """Drain the error channel."""
        texts = []
        while (message := self.channel.poll()) is not None:
            texts.append(str(message[1]).strip())
        return texts

    def _homed(self) -> bool:
        self.stat.poll()
        return all(self.stat.homed[joint] for joint in self.joints)

    def _settled(self) -> bool:
        self.stat.poll()
        return self.stat.inpos and self.pins("backlash-filt") == self.pins("backlash-corr")


def main() -> None:
    """Do the job; whatever goes wrong is told in the result, since LinuxCNC hides a DISPLAY program's exit status."""
    job = json.loads(Path("job.json").read_text())
    result: dict[str, Any] = {"start": [], "steps": [], "errors": [], "failure": None}
    try:
        machine = Machine(job["joints"])
        machine.home()
        result["start"] = machine.pins("motor-pos-cmd")
        result["steps"] = [machine.move(code) for code in job["moves"]]
        result["errors"] = machine.errors()
    except Exception as error:  # noqa: BLE001
        result["failure"] = f"{type(error).__name__}: {error}"
    Path("result.part").write_text(json.dumps(result))
    os.replace("result.part", "result.json")


if __name__ == "__main__":
    main()
