"""Klipper's own host in batch mode: where each motor goes, by the steps that it would send to the micro-controller."""

import re
import time
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path
from subprocess import DEVNULL, PIPE, Popen
from tempfile import TemporaryDirectory

import numpy as np

from axiscal.numerics import Array
from axiscal.units import from_unit, to_unit
from tests.controls.fetched import built, python, run

VERSION = "84104bbb"
_ARCHIVE = "klipper.tar.xz"
_ROUNDS = {"x": 8.0, "y": 8.0, "z": 4.0}
"""mm of a turn of each motor, of 200 full steps of 128: a step is 0.3 um, of Z 0.16 um."""
_STEPS = 200 * 128
_MARK = "gpio12"
_NUMBER = re.compile(r"(\w+)=(-?\w+(?:/\w+)?)")
_WRAP = 1 << 32
_QUIET = 15
"""Tenths of a second without a byte, after which nothing is to come."""


def klipper() -> Path:
    """Return the folder of a Klipper whose micro-controller runs here; raises MissingError."""
    return built(_ARCHIVE, [], _build) / "klipper"


def _build(folder: Path) -> None:
    at = folder / "klipper"
    (at / ".config").write_text("CONFIG_LOW_LEVEL_OPTIONS=y\nCONFIG_MACH_LINUX=y\n")
    run(["make", "olddefconfig"], at)
    run(["make", "-j2"], at)


def config(more: str) -> str:
    """Return a printer.cfg of three axes.  more : further sections"""
    lines = ["[mcu]", "serial: /none", "[printer]", "kinematics: cartesian", "max_velocity: 300", "max_accel: 5000"]
    lines += ["max_z_velocity: 100", "max_z_accel: 2000", "[force_move]", "enable_force_move: True"]
    lines += ["[output_pin mark]", f"pin: {_MARK}"]
    for k, axis in enumerate("xyz"):
        pins = zip(("step_pin: ", "dir_pin: ", "enable_pin: !", "endstop_pin: ^"), range(4 * k, 4 * k + 4), strict=True)
        lines += [f"[stepper_{axis}]", "microsteps: 128", f"rotation_distance: {_ROUNDS[axis]}", "position_endstop: 0"]
        lines += ["position_min: -20", "position_max: 420", *(f"{key}gpio{number}" for key, number in pins)]
    return "\n".join(lines) + f"\n{more}"


def motors(files: Mapping[str, str], codes: list[str], poses: Array) -> Array:
    """Return where the motors stand at poses (m, 3) by X, Y, Z, m.

    files : of the configuration, printer.cfg among them; codes : sent first
    """
    at = klipper()
    lines = ["SET_KINEMATIC_POSITION X=0 Y=0 Z=0", *codes]
    for number, place in enumerate(np.asarray(to_unit(poses, "mm"))):
        lines += ["G1 X{:.6f} Y{:.6f} Z{:.6f} F12000".format(*place), "G4 P200"]
        lines += [f"SET_PIN PIN=mark VALUE={(number + 1) % 2}", "G4 P200"]
    lines += ["G1 X1 Y1 Z1 F12000", "G1 X9 Y9 Z9 F600", "GET_POSITION"]
    with TemporaryDirectory() as folder:
        here = Path(folder)
        for name, text in files.items():
            (here / name).write_text(text)
        words: list[str | Path] = ["-i", "/dev/stdin", "-o", here / "sent", "-l", here / "log"]
        words += ["-d", at / "out" / "klipper.dict"]
        start: list[str | Path] = [python(), "klippy/klippy.py", here / "printer.cfg", *words]
        with Popen(start, cwd=at, stdin=PIPE, stdout=DEVNULL, stderr=DEVNULL) as host:
            assert host.stdin is not None
            host.stdin.write("\n".join([*lines, ""]).encode())
            host.stdin.flush()
            _written(host, here)
            host.stdin.close()  # on which it ends at once, whatever is not written
        said = (here / "log").read_text()
        sent = run([python(), "klippy/parsedump.py", at / "out" / "klipper.dict", here / "sent"], at)
    stood = _stood(sent)
    assert len(stood) == len(poses), f"{len(stood)} of {len(poses)} places were reached: {said[-1500:]}"
    return np.asarray(from_unit(stood * np.array([_ROUNDS[axis] / _STEPS for axis in "xyz"]), "mm"))


def _written(host: Popen[bytes], here: Path) -> None:
    """Wait until it has done all that it was told, and has written nothing more for a while."""
    end, sizes = time.monotonic() + 60.0, list[int]()
    while host.poll() is None and time.monotonic() < end and (len(sizes) < _QUIET or len(set(sizes[-_QUIET:])) > 1):
        time.sleep(0.1)
        log = here / "log"
        done = log.exists() and "gcode homing: X:" in log.read_text()
        sizes += [(here / "sent").stat().st_size] if done else []


def _stood(sent: str) -> Array:
    """Return the steps of each motor whenever the marking pin was set, (n, 3)."""
    way, clock, steps = defaultdict[int, int](int), defaultdict[int, int](int), defaultdict[int, int](int)
    ends = defaultdict[int, list[tuple[int, int]]](list)
    motor, pin, marks = dict[int, int](), dict[int, str](), list[int]()
    for line in sent.splitlines():
        name, numbers = line.partition(" ")[0], dict(_NUMBER.findall(line))
        own = int(numbers.get("oid", 0))
        if name == "config_stepper":
            motor[own] = int(numbers["step_pin"].rpartition("gpio")[2]) // 4
        elif name == "config_digital_out":
            pin[own] = numbers["pin"].rpartition("/")[2]
        elif name == "set_next_step_dir":
            way[own] = 1 if int(numbers["dir"]) else -1
        elif name == "reset_step_clock":
            clock[own] += (int(numbers["clock"]) - clock[own]) % _WRAP
        elif name == "queue_step":
            count, add = int(numbers["count"]), int(numbers["add"])
            clock[own] += int(numbers["interval"]) * count + add * (count * (count - 1) // 2)
            steps[own] += way[own] * count
            ends[own].append((clock[own], steps[own]))
        elif name == "queue_digital_out" and pin[own] == _MARK:
            last = marks[-1] if marks else 0
            marks.append(last + (int(numbers["clock"]) - last) % _WRAP)
    found = np.zeros((len(marks), 3))
    for own, reached in ends.items():
        clocks, stood = np.array(reached).T
        assert clocks[-1] > marks[-1], f"cut off before the last place: {own} {clocks[-1]} {marks[-4:]} {len(marks)}"
        place = np.searchsorted(clocks, marks, side="right") - 1
        found[:, motor[own]] = np.where(place < 0, 0, stood[place])
    return found
