"""The commands of docs/linuxcnc.md in one go, word for word, beside a LinuxCNC that stands in for somebody's mill.

    python -m benchmarks.linuxcnc_howto

It needs Debian's linuxcnc-uspace-dev, gcc and the rights to make namespaces. In them the mill has a home with its
configuration, LinuxCNC's modules are a copy that may be installed into, and a person stands at the machine: starts and
stops LinuxCNC, homes it, presses the stylus, presses Enter. The feeds alone are not those of a real machine.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import tomllib
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from tests.docs.howtos import DOCS
from tests.linuxcnc.bench import BALLS, at_full_speed
from tests.linuxcnc.lab import Joint, Settings, files
from tests.linuxcnc.running import BASE, NOBODY, OWN_TMP, SPACES, add_modules, mounted

PAGE, ROOT = DOCS / "linuxcnc.md", DOCS.parent
_BLOCK = re.compile(r"^[ \t]*```sh\n(.*?)^[ \t]*```", re.MULTILINE | re.DOTALL)
_SENSE = -1.0
"""A and C of xyzac-trt-kins count against ISO 841."""
LINES = {"ay": 0.031, "az": -120.018, "cx": 0.012, "cy": 0.006}
"""mm: where the axis lines of A and C are; stated are 0, -120, 0, 0."""
_DISPLAY = """#!/usr/bin/python3
# The person who switches the machine on and homes it, and stops LinuxCNC when asked.
import linuxcnc, time, pathlib
c, s = linuxcnc.command(), linuxcnc.stat()
c.state(linuxcnc.STATE_ESTOP_RESET); c.state(linuxcnc.STATE_ON); c.wait_complete(5)
c.home(-1)
s.poll()
while not all(s.homed[:5]):
    time.sleep(0.05); s.poll()
c.mode(linuxcnc.MODE_MDI); c.wait_complete(5)
for code in ("M68 E3 Q1", "M66 E0 L0", "G49", "G53 G0 Z190"):  # identity kinematics, Z up
    c.mdi(code); c.wait_complete(20)
pathlib.Path("ready").write_text("")
while not pathlib.Path("quit").exists():
    time.sleep(0.1)
"""
_AXISCAL = """#!{python}
# axiscal, with the feeds of a simulated machine
import sys
from pathlib import Path
from pytest import MonkeyPatch
from axiscal.ports.linuxcnc.live import attached
from tests.linuxcnc.bench import quickened
quickened(MonkeyPatch(), Path({work!r}))
attached._SLOWER = 1
from axiscal.cli.app import run
sys.exit(run(sys.argv[1:]))
"""
_SUDO = """#!/bin/sh
# who is root already; what is installed already is not installed again
if [ "$1" = apt-get ]; then shift 2; exec dpkg --status "$@" >/dev/null; fi
exec "$@"
"""


def blocks(page: Path = PAGE) -> list[list[str]]:
    """Return the commands of each block of a page, continued lines joined."""
    found = _BLOCK.findall(page.read_text(encoding="utf-8"))
    lines = ([line.strip() for line in block.replace("\\\n", " ").splitlines()] for block in found)
    return [[line for line in block if line] for block in lines]


class Mill:
    """Somebody's mill: its configuration, its LinuxCNC, and who stands beside it."""

    def __init__(self, work: Path) -> None:
        self.work, self.home = work, work / "home"
        self.folder = self.home / "linuxcnc" / "configs" / "mill"
        self.folder.mkdir(parents=True)
        self.running: subprocess.Popen[bytes] | None = None
        (work / "rt").mkdir()
        os.chown(work / "rt", NOBODY, NOBODY)
        self._shims()
        self._configured()

    @property
    def environment(self) -> dict[str, str]:
        """What a login at the mill has."""
        path = f"{self.work / 'bin'}:/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
        kept = {name: os.environ[name] for name in ("LANG", "OPENBLAS_CORETYPE") if name in os.environ}
        real_time = {"RTAPI_UID": str(NOBODY), "RTAPI_FIFO_PATH": str(self.work / "rt" / "f")}
        return kept | real_time | {"HOME": str(self.home), "PATH": path, "PYTHONPATH": ":".join(sys.path[1:])}

    def _shims(self) -> None:
        folder = self.work / "bin"
        folder.mkdir()
        for name, text in {
            "axiscal": _AXISCAL.format(python=sys.executable, work=str(self.work)),
            "sudo": _SUDO,
            "ssh": '#!/bin/sh\nfor last; do :; done\nexec sh -c "$last"\n',
        }.items():
            (folder / name).write_text(text)
            (folder / name).chmod(0o755)

    def _configured(self) -> None:
        reach = {"A": (-60.0, 60.0), "C": (0.0, 360.0)}
        joints = [Joint(name, *reach.get(name, (-200.0, 200.0)), 2000.0, 5e4) for name in "XYZAC"]
        hal = ["setp xyzac-trt-kins.z-rot-point -120", "net switched motion.analog-out-03 => motion.switchkins-type"]
        hal += [
            "loadrt axiscal_balls",
            "loadrt scale count=2",
            "addf scale.0 servo-thread",
            "addf scale.1 servo-thread",
        ]
        hal += ["addf axiscal-balls servo-thread"]
        hal += [f"net j{n}m => axiscal-balls.{axis}" for n, axis in enumerate("xyz")]
        for number, axis in enumerate("ac"):
            hal += [f"setp scale.{number}.gain {_SENSE}", f"net j{3 + number}m => scale.{number}.in"]
            hal += [f"net {axis}-iso scale.{number}.out => axiscal-balls.{axis}"]
        hal += [f"setp axiscal-balls.{name} {value}" for name, value in LINES.items()]
        hal += ["net probe axiscal-balls.touched => motion.probe-input", ""]
        made = files(joints, Settings("\n".join(hal), kinematics="xyzac-trt-kins"))
        for name, text in made.items():
            (self.folder / name.replace("machine.ini", "mill.ini")).write_text(text)
        (self.folder / "driver.py").write_text(_DISPLAY)
        (self.folder / "driver.py").chmod(0o755)

    def placed(self) -> None:
        """Put the spheres where campaign.toml has them, a little off, and the probe that machine.toml has."""
        campaign = tomllib.loads(Path("mill/campaign.toml").read_text())
        machine = tomllib.loads(Path("mill/machine.toml").read_text())
        (artefact,) = campaign["artefacts"]
        radius = (_mm(artefact["diameter"]) + _mm(machine["tool"]["stylus"])) / 2
        pins = {"tool": _mm(machine["tool"]["length"]), "radius": radius}
        for number, (place, off) in enumerate(zip(artefact["balls"].values(), (0.2, -0.3, 0.1), strict=True)):
            pins |= {f"b{axis}{number}": _mm(at) + off for axis, at in zip("xyz", place, strict=True)}
        for name, value in pins.items():
            self.halcmd("setp", f"axiscal-balls.{name}", str(value))

    def halcmd(self, *words: str) -> None:
        """Do what the person does to the machine with his hands."""
        subprocess.run(["halcmd", *words], check=True, env=self.environment, timeout=20, capture_output=True)

    def start(self) -> None:
        """Start LinuxCNC, switch it on, home it; raises RuntimeError where that does not come to pass."""
        for name in ("ready", "quit"):
            (self.folder / name).unlink(missing_ok=True)
        with (self.work / "linuxcnc.log").open("ab") as log:
            words = ["linuxcnc", "-r", "mill.ini"]
            self.running = subprocess.Popen(
                words, cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL, stdout=log, stderr=log
            )
        end = time.monotonic() + 60
        while not (self.folder / "ready").exists():
            if time.monotonic() > end or self.running.poll() is not None:
                raise RuntimeError((self.work / "linuxcnc.log").read_text(errors="replace")[-3000:])
            time.sleep(0.1)
        self.placed()

    def stop(self) -> None:
        """Let LinuxCNC end."""
        if self.running is not None:
            (self.folder / "quit").write_text("")
            self.running.wait(60)
            self.running = None


def _mm(text: str) -> float:
    number, unit = text.split()
    assert unit == "mm"
    return float(number)


class Person:
    """Types what a command asks for, and presses the stylus when it is to be pressed."""

    def __init__(self, mill: Mill) -> None:
        self.mill = mill

    def run(self, line: str) -> str:
        """Run a line in a shell; returns what it printed, raises RuntimeError where it fails."""
        process = subprocess.Popen(
            ["sh", "-c", line],
            cwd=Path.cwd(),
            env=self.mill.environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            bufsize=1,
        )
        assert process.stdin is not None
        assert process.stdout is not None
        with suppress(BrokenPipeError):
            process.stdin.write(next((_TYPED[word] for word in shlex.split(line) if word in _TYPED), ""))
            process.stdin.close()
        said = list[str]()
        for text in process.stdout:
            said.append(text)
            if "Press the stylus once by hand" in text:
                threading.Thread(target=self._press).start()
        if process.wait() != 0:
            raise RuntimeError(f"{line}\n{''.join(said)[-3000:]}")
        return "".join(said)

    def _press(self) -> None:
        for value in "10":
            time.sleep(0.5)
            self.mill.halcmd("setp", "axiscal-balls.stuck", value)


_TYPED = {"run": "\n\ngo\n", "verify": "\n\ngo\n", "measure": "\n0.4 -1.2 0.9\n1.1 0.2 -0.3\n"}
"""By command: two single steps above the ball and the rest of them; two readings, and then the person leaves."""


_LOGGED = """
import linuxcnc, sys, time
c, s = linuxcnc.command(), linuxcnc.stat()
for name in sys.argv[1:]:
    c.mode(linuxcnc.MODE_AUTO); c.wait_complete(5); c.program_open(name); c.auto(linuxcnc.AUTO_RUN, 0)
    time.sleep(1); s.poll()
    while s.interp_state != linuxcnc.INTERP_IDLE:
        if s.interp_state == linuxcnc.INTERP_PAUSED:
            c.auto(linuxcnc.AUTO_RESUME)
        time.sleep(0.1); s.poll()
c.mode(linuxcnc.MODE_MDI); c.wait_complete(5)
"""


def before(line: str, mill: Mill) -> None:
    """Do what the page has a person do with LinuxCNC before a command."""
    attached = "linuxcnc-live" in line or line.startswith("halcmd")
    if attached and mill.running is None:
        mill.start()
    if line.startswith("sudo halcompile"):
        mill.stop()
    if " --log ~" in line:
        programs = [mill.work / path.name for path in sorted(Path("logged").glob("*.ngc"))]
        for program in programs:
            program.write_text(at_full_speed((Path("logged") / program.name).read_text(encoding="ascii")))
        words = ["/usr/bin/python3", "-c", _LOGGED, *map(str, programs)]
        subprocess.run(words, check=True, env=mill.environment, timeout=1800)


def inside(work: Path, say: Callable[[str], None]) -> str:
    """Run every command of the page; returns what the last verification said."""
    mill = Mill(work)
    person, verdict, folder = Person(mill), "", mill.home
    try:
        for block in blocks():
            os.chdir(folder)
            for line in block:
                if line.startswith("cd "):
                    os.chdir(line.removeprefix("cd "))
                    continue
                before(line, mill)
                begun = time.monotonic()
                said = person.run(line)
                say(f"$ {line}   ({time.monotonic() - begun:.0f} s)")
                if line.startswith("halcmd setp axiscal-vcomp.enable"):
                    time.sleep(3)
                if "verify" in line and (
                    found := re.search(
                        r"^(AS PROMISED|WORSE THAN PROMISED|TABLES DO NOT WORK|UNDECIDED).*", said, re.MULTILINE
                    )
                ):
                    verdict = found[0]
                    say("\n".join(said.strip().splitlines()[-6:]))
    finally:
        mill.stop()
    return verdict


def _own_tmp(work: Path) -> str:
    """Return the lines of a shell that give LinuxCNC a /tmp of its own, in which the checkout stands where it stood."""
    if not ROOT.is_relative_to("/tmp"):
        return OWN_TMP
    (work / "checkout").mkdir()
    here, kept = shlex.quote(str(ROOT)), shlex.quote(str(work / "checkout"))
    return f"mount --bind {here} {kept} && {OWN_TMP} && mkdir -p {here} && mount --bind {kept} {here} && cd {here}"


def main(arguments: list[str]) -> int:
    """Go into namespaces of its own, and there through the page; returns the exit status."""
    if arguments[:1] == ["--inside"]:
        verdict = inside(Path(arguments[1]), lambda text: print(text, flush=True))
        return 0 if verdict.startswith("AS PROMISED") else 1
    work = Path(tempfile.mkdtemp(prefix="axiscal-howto-", dir=BASE))
    try:
        work.chmod(0o755)
        add_modules(work, {"axiscal_balls.comp": BALLS})
        mounts = " && ".join([_own_tmp(work), *mounted(work)])
        again = shlex.join([sys.executable, "-m", "benchmarks.linuxcnc_howto", "--inside", str(work)])
        path = {"PYTHONPATH": ":".join(str(Path(part).resolve()) for part in (".", "src"))}
        return subprocess.run(
            [*SPACES, "sh", "-c", f"{mounts} && exec {again}"], env=os.environ | path, check=False
        ).returncode
    finally:
        shutil.rmtree(work, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
