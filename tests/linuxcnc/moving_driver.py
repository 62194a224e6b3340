#!/usr/bin/python3
"""The DISPLAY program of a headless LinuxCNC that also makes moves.

It runs under the system's Python, beside the program of axiscal.
"""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import hal  # type: ignore[import-not-found]

import linuxcnc  # type: ignore[import-not-found]

if TYPE_CHECKING:
    from axiscal.ports.linuxcnc.lab.driver import RunningControl, main, wait
else:
    from plain_driver import RunningControl, main, wait

UNFINISHED = -1
"""By LinuxCNC's Python interface."""


class MovingControl(RunningControl):
    """The running LinuxCNC, which also makes the moves of a list.

    motors : the pin or signal of each joint that holds the position its motor is sent to
    """

    def __init__(self) -> None:
        super().__init__()
        self.motors = json.loads(Path("job.json").read_text())["motors"]
        self.joints = range(len(self.motors))

    def done(self, asked: Any) -> dict[str, Any]:
        """Make the moves of a list, say where the motors stand at the start, or do what is asked for otherwise."""
        if asked == "start":
            return {"start": self.sent()}
        return {"steps": [self.move(code) for code in asked]} if isinstance(asked, list) else super().done(asked)

    def move(self, code: str) -> dict[str, Any]:
        """Execute a line and wait until the correction, which is ramped, has arrived as well."""
        self.execute(code)
        settled = wait(self._settled, 0.5) and wait(self._still, 3.0)
        self.stat.poll()
        tripped = [list(self.stat.probed_position)[:6], bool(self.stat.probe_tripped)]
        return {"settled": settled, "motor": self.sent(), "command": self.pins("pos-cmd"), "probe": tripped}

    def execute(self, code: str) -> None:
        """Execute a G-code line, or `setp PIN VALUE`."""
        if code.startswith("setp "):
            hal.set_p(*code.split()[1:])
            return
        self.command.mdi(code)
        while (ended := self.command.wait_complete(1)) == UNFINISHED:
            pass
        if ended != linuxcnc.RCS_DONE:
            raise RuntimeError(f"{code} was not completed: {self.errors()}")

    def sent(self) -> list[float]:
        """Read the position that every motor is sent to."""
        return [hal.get_value(name) for name in self.motors]

    def pins(self, name: str) -> list[float]:
        """Read one pin of every joint."""
        return [hal.get_value(f"joint.{joint}.{name}") for joint in self.joints]

    def _still(self) -> bool:
        before = self.pins("pos-cmd"), self.sent()  # a correction over another axis comes at a limited speed
        for _ in range(4):  # on a busy computer without real time the next servo cycle may be late
            time.sleep(0.003)  # three servo cycles: "in position" may come a cycle early
            if (self.pins("pos-cmd"), self.sent()) != before:
                return False
        return True

    def _settled(self) -> bool:
        self.stat.poll()
        return self.stat.inpos and self.pins("backlash-filt") == self.pins("backlash-corr")


if __name__ == "__main__":
    main(MovingControl)
