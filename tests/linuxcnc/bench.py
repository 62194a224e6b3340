"""A LinuxCNC that runs headless with spheres on its table, to be attached to as if it were somebody's machine."""

import os
import re
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import pytest

from axiscal.measurement import touched
from axiscal.ports.linuxcnc.live import attached, connection
from tests.generators import touched_table as table
from tests.linuxcnc.lab import Joint, Session, Settings

NAMES = "XYZAC"
BALLS = Path(__file__).with_name("axiscal_balls.comp").read_text(encoding="ascii")


def hal(scale: float = 1.0) -> str:
    """Return HAL with the spheres on the table, where the motors of X, Y, Z, A, C are.  scale : mm in its unit"""
    lines = ["loadrt axiscal_balls", "addf axiscal-balls servo-thread", f"setp axiscal-balls.tool {80 / scale}"]
    lines += [f"net j{n}m => axiscal-balls.{axis}" for n, axis in enumerate("xyzac")]
    lines += [f"setp axiscal-balls.{name} {value / scale}" for name, value in table.LINES.items()]
    lines += [f"setp axiscal-balls.radius {table.RADIUS / scale}"]
    for number, place in enumerate([*table.BALLS.values(), (1e6, 0.0, 0.0)]):
        lines += [f"setp axiscal-balls.b{axis}{number} {at / scale}" for axis, at in zip("xyz", place, strict=True)]
    return "\n".join([*lines, "net probe axiscal-balls.touched => motion.probe-input"]) + "\n"


def joints(scale: float = 1.0) -> list[Joint]:
    return [Joint(n, *((-400.0, 400.0) if n in "AC" else (-400 / scale, 400 / scale)), 2000.0, 5e4) for n in NAMES]


class Bench:
    """The running LinuxCNC, and what is done to it from beside."""

    def __init__(self, session: Session) -> None:
        self.session = session
        inside = next(iter(_children(session.process_id)), session.process_id)
        self._enter = ("nsenter", "-t", str(inside), "--ipc", "--net", "--pid", "--mount", "--")

    def words(self) -> tuple[str, ...]:
        """Return what starts the agent beside it."""
        return (*self._enter, *connection.command(""))

    def ssh(self, folder: Path) -> str:
        """Write an `ssh` that leads to it, and return the PATH with which it is found."""
        script = folder / "ssh"
        script.write_text(f'#!/bin/bash\nexec {" ".join(self._enter)} sh -c "${{@: -1}}"\n')
        script.chmod(0o755)
        return f"{folder}:{os.environ['PATH']}"

    def says(self, code: str) -> str:
        """Run Python beside it, with c the command and s the status of LinuxCNC, and return what it prints."""
        begin = "import linuxcnc as l, time, hal\nc, s = l.command(), l.stat()\ns.poll()\n"
        done = subprocess.run(
            [*self._enter, "/usr/bin/python3", "-c", begin + code],
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    def pin(self, name: str, value: object) -> None:
        """Set a pin of the simulated spheres."""
        words = [*self._enter, "halcmd", "setp", f"axiscal-balls.{name}", str(value)]
        subprocess.run(words, check=True, timeout=20, capture_output=True)

    def stands(self) -> bool:
        """Whether no joint moves."""
        seen = self.says("p=s.joint_position\ntime.sleep(0.3)\ns.poll()\nprint(p == s.joint_position)")
        return seen.strip() == "True"

    def ready(self) -> None:
        """Put it into the state of a machine that is ready, whatever was done to it."""
        self.says(
            "c.abort(); c.wait_complete(5); c.state(l.STATE_ESTOP_RESET); c.wait_complete(5); c.state(l.STATE_ON)\n"
            "c.wait_complete(5); s.poll()\n"
            "if not all(s.homed[:5]):\n"
            "    c.mode(l.MODE_MANUAL); c.wait_complete(5); c.teleop_enable(0); c.wait_complete(5); c.home(-1)\n"
            "    time.sleep(0.5)\n"
            "c.feedrate(1.0); c.mode(l.MODE_MDI); c.wait_complete(5)\n"
            "for code in ('M5', 'M48', 'G49', 'G10 L2 P1 R0 X0 Y0 Z0', 'G90 G21', 'G53 G0 Z200'):\n"
            "    c.mdi(code); c.wait_complete(20)\n"
        )
        for name, value in {
            "stuck": 0,
            "deaf": 0,
            "sticky": 0,
            "radius": table.RADIUS,
            "bz0": -90.0,
            "bz1": -70.0,
        }.items():
            self.pin(name, value)


@contextmanager
def running(text: str | None = None, machine: Sequence[Joint] | None = None) -> Iterator[Bench]:
    """Yield a running LinuxCNC with the spheres.  text, machine : HAL and joints of another one than XYZAC"""
    settings = Settings(text or hal(), sources={"axiscal_balls.comp": BALLS})
    with Session(machine or joints(), settings, timeout=240) as session:
        yield Bench(session)


def quickened(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    """Let the program beside LinuxCNC move as fast as can be but for the slow touch.  folder : where it is kept"""
    agent = connection._AGENT.read_text(encoding="utf-8").replace("LARGEST = 3000.0", "LARGEST = 99999.0")
    (folder / "agent.py").write_text(agent, encoding="utf-8")
    monkeypatch.setattr(connection, "_AGENT", folder / "agent.py")
    monkeypatch.setattr(attached, "_FASTEST", 90_000)
    monkeypatch.setattr(touched, "Cycle", partial(touched.Cycle, fast=0.04))


def at_full_speed(program: str) -> str:
    """Return a program as fast as can be, but for the slow touch."""
    quick = program.replace(" [300] ", " [2400] ").replace(" [600]", " [30000]")
    return re.sub(r"(?<= F)\d+$", "60000", quick, flags=re.MULTILINE)


def _children(pid: int) -> list[int]:
    found = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return [int(each) for each in found]
