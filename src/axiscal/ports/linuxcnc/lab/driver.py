#!/usr/bin/python3
"""The DISPLAY program of a headless LinuxCNC: homes, then sets and reads the pins that are asked for through a socket.

It runs under the system's Python, which alone has the modules `linuxcnc` and `hal`. One JSON line answers one.
"""

from __future__ import annotations

import json
import socket
import time
from typing import Any

import hal  # type: ignore[import-not-found]
import linuxcnc  # type: ignore[import-not-found]


def wait(condition: Any, seconds: float) -> bool:
    """Return whether the condition came true in time."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.001)
    return True


class RunningControl:
    """The running LinuxCNC."""

    def __init__(self) -> None:
        self.command, self.stat, self.channel = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()
        self.component = hal.component("axiscal")
        self.component.ready()

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
        """Set the pins of {"set": values by name}, or read those of {"read": names}."""
        for name, value in asked.get("set", {}).items():
            hal.set_p(name, value)
        return {"values": [float(hal.get_value(name)) for name in asked.get("read", ())]}

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


def main(control: type[RunningControl] = RunningControl) -> None:
    """Serve until the other side closes the socket."""
    with socket.socket(socket.AF_UNIX) as line:
        line.connect("socket")
        stream = line.makefile("rw", encoding="utf-8")

        def tell(result: dict[str, Any]) -> None:
            stream.write(json.dumps(result) + "\n")
            stream.flush()

        try:
            machine = control()
            machine.home()
            tell({"failure": None})
        except Exception as error:  # noqa: BLE001
            tell({"failure": f"{type(error).__name__}: {error}"})
            return
        for request in stream:
            tell(machine.answer(json.loads(request)))


if __name__ == "__main__":
    main()
