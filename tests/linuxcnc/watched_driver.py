#!/usr/bin/python3
"""The DISPLAY program of a headless LinuxCNC that also runs programs, homes joints anew, and samples pins.

It runs under the system's Python, beside the program that makes moves.
"""

from __future__ import annotations

import subprocess
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import hal  # type: ignore[import-not-found]

import linuxcnc  # type: ignore[import-not-found]

if TYPE_CHECKING:
    from tests.linuxcnc.moving_driver import MovingControl, main, wait
else:
    from moving_driver import MovingControl, main, wait


class WatchedControl(MovingControl):
    """The running LinuxCNC, which also takes `run PROGRAM` and `home JOINT`."""

    def execute(self, code: str) -> None:
        """Execute a line, or what is meant by the first word."""
        if code.startswith("run "):
            self.run(code.split()[1])
        elif code.startswith("home "):
            self.home_again(int(code.split()[1]))
        else:
            super().execute(code)

    def done(self, asked: Any) -> dict[str, Any]:
        """Make the moves of {"sample": codes} while pins are sampled, or what is asked for otherwise."""
        if isinstance(asked, dict) and "sample" in asked:
            return self.sampled(asked["sample"])
        return super().done(asked)

    def run(self, name: str) -> None:
        """Run a program of the configuration's folder to its end; start is pressed wherever it stops for it."""
        self.command.mode(linuxcnc.MODE_AUTO)
        self.command.wait_complete(5)
        self.command.program_open(str(Path(name).resolve()))
        self.command.auto(linuxcnc.AUTO_RUN, 0)
        wait(lambda: self.interpreter() != linuxcnc.INTERP_IDLE, 2)
        while (state := self.interpreter()) != linuxcnc.INTERP_IDLE:
            if state == linuxcnc.INTERP_PAUSED:
                self.command.auto(linuxcnc.AUTO_RESUME)
                self.command.wait_complete(1)
            time.sleep(0.005)
        self.command.mode(linuxcnc.MODE_MDI)
        self.command.wait_complete(5)

    def interpreter(self) -> int:
        """Read what the interpreter does."""
        self.stat.poll()
        return int(self.stat.interp_state)

    def home_again(self, joint: int) -> None:
        """Home one joint where it stands, which sets its position to the home position."""
        self.command.mode(linuxcnc.MODE_MANUAL)
        self.command.wait_complete(5)
        self.command.teleop_enable(0)
        self.command.wait_complete(5)
        self.command.unhome(joint)
        wait(lambda: not self.homed(), 5)
        self.command.home(joint)
        if not wait(self.homed, 10):
            raise RuntimeError(f"joint {joint} was not homed in 10 s")
        self.command.mode(linuxcnc.MODE_MDI)
        self.command.wait_complete(5)

    def sampled(self, codes: list[str]) -> dict[str, Any]:
        """Make moves while `halsampler` writes down what its component takes in every servo cycle."""
        with tempfile.NamedTemporaryFile("r") as kept:
            sampler = subprocess.Popen(["halsampler", kept.name])
            hal.set_p("sampler.0.enable", "1")
            try:
                steps = [self.move(code) for code in codes]
            finally:
                hal.set_p("sampler.0.enable", "0")
                time.sleep(0.1)  # until the queue is read
                sampler.terminate()
                sampler.wait(5)
            rows = [line.split() for line in kept.read().splitlines()]
            rows = rows[rows[:1] == [["overrun"]] :]  # it counts from the first sample ever taken
        full = [[float(word) for word in row] for row in rows if row and "overrun" not in row]
        return {"steps": steps, "samples": full[:-1], "overruns": len(rows) - len(full)}


if __name__ == "__main__":
    main(WatchedControl)
