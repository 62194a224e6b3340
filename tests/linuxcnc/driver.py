#!/usr/bin/python3
"""The DISPLAY program of a headless LinuxCNC: homes, makes moves, runs programs, reads pins and samples them.

It runs under the system's Python, which alone has the modules `linuxcnc` and `hal`. One JSON line answers one, through
a socket.
"""

import json
import socket
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

import hal  # type: ignore[import-not-found]

import linuxcnc  # type: ignore[import-not-found]

UNFINISHED = -1
"""By LinuxCNC's Python interface."""


def wait(condition: Any, seconds: float) -> bool:
    """Return whether the condition came true in time."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.001)
    return True


class Control:
    """The running LinuxCNC.  motors : the pin or signal of each joint that holds the position its motor is sent to"""

    def __init__(self) -> None:
        self.command, self.stat, self.channel = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()
        self.component = hal.component("axiscal")
        self.component.ready()
        self.motors = json.loads(Path("job.json").read_text())["motors"]
        self.joints = range(len(self.motors))

    def home(self) -> None:
        """Switch on, home every joint in place, accept MDI."""
        self.command.state(linuxcnc.STATE_ESTOP_RESET)
        self.command.state(linuxcnc.STATE_ON)
        self.command.wait_complete(5)
        self.command.home(-1)
        if not wait(self.homed, 10):
            raise RuntimeError("the joints were not homed in 10 s")
        self.command.mode(linuxcnc.MODE_MDI)
        self.command.wait_complete(5)

    def answer(self, asked: Any) -> dict[str, Any]:
        """Do what is asked; whatever goes wrong is reported: LinuxCNC hides a program's exit status."""
        try:
            return {"failure": None, **self.done(asked), "errors": self.errors()}
        except Exception as error:  # noqa: BLE001
            return {"failure": f"{type(error).__name__}: {error}"}

    def done(self, asked: Any) -> dict[str, Any]:
        """Make the moves of a list, say where the motors stand at the start, read pins, or sample them during moves."""
        if asked == "start":
            return {"start": self.sent()}
        if isinstance(asked, list):
            return {"steps": [self.move(code) for code in asked]}
        if "sample" in asked:
            return self.sampled(asked["sample"])
        return {"values": [float(hal.get_value(name)) for name in asked["read"]]}

    def errors(self) -> list[str]:
        """Drain the error channel, and pass over what a program shows on the screen."""
        texts = []
        while (message := self.channel.poll()) is not None:
            if message[0] in (linuxcnc.NML_ERROR, linuxcnc.OPERATOR_ERROR):
                texts.append(str(message[1]).strip())
        return texts

    def homed(self) -> bool:
        """Return whether every joint was homed."""
        self.stat.poll()
        return all(self.stat.homed[joint] for joint in range(self.stat.joints))

    def move(self, code: str) -> dict[str, Any]:
        """Execute a line and wait until the correction, which is ramped, has arrived as well."""
        self.execute(code)
        settled = wait(self._settled, 2.0) and wait(self._still, 3.0)
        return {"settled": settled, "motor": self.sent(), "command": self.pins("pos-cmd")}

    def execute(self, code: str) -> None:
        """Execute a G-code line, or what is meant by the first word: `setp PIN VALUE`, `run PROGRAM`, `home JOINT`."""
        word, *rest = code.split()
        if word in ("setp", "run", "home"):
            {"setp": hal.set_p, "run": self.run, "home": self.home_again}[word](*rest)
            return
        self.command.mdi(code)
        while (ended := self.command.wait_complete(1)) == UNFINISHED:
            pass
        if ended != linuxcnc.RCS_DONE:
            raise RuntimeError(f"{code} was not completed: {self.errors()}")

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

    def home_again(self, number: str) -> None:
        """Home one joint where it stands, which sets its position to the home position."""
        joint = int(number)
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

    def sent(self) -> list[float]:
        """Read the position that every motor is sent to."""
        return [hal.get_value(name) for name in self.motors]

    def pins(self, name: str) -> list[float]:
        """Read one pin of every joint."""
        return [hal.get_value(f"joint.{joint}.{name}") for joint in self.joints]

    def _still(self) -> bool:
        before = self.pins("pos-cmd"), self.sent()  # a correction over another axis comes at a limited speed
        for _ in range(4):  # on a busy computer without real time the next servo cycle may be late
            time.sleep(0.01)  # some servo cycles: "in position" may come early, and on a busy computer a cycle late
            if (self.pins("pos-cmd"), self.sent()) != before:
                return False
        return True

    def _settled(self) -> bool:
        self.stat.poll()
        return self.stat.inpos and self.pins("backlash-filt") == self.pins("backlash-corr")


def main() -> None:
    """Serve until the other side closes the socket."""
    with socket.socket(socket.AF_UNIX) as line:
        line.connect("socket")
        stream = line.makefile("rw", encoding="utf-8")

        def tell(result: dict[str, Any]) -> None:
            stream.write(json.dumps(result) + "\n")
            stream.flush()

        try:
            machine = Control()
            machine.home()
            tell({"failure": None})
        except Exception as error:  # noqa: BLE001
            tell({"failure": f"{type(error).__name__}: {error}"})
            return
        for request in stream:
            tell(machine.answer(json.loads(request)))


if __name__ == "__main__":
    main()
