"""A printer that runs: Klipper's micro-controller with a bed under its probe, Klipper's host, and Moonraker."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import time
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from shutil import which
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest

from axiscal.campaign.sources import Answer, Request, open_source
from axiscal.description.campaign import campaign_from_texts
from axiscal.exceptions import SourceError
from axiscal.machine.description import load_machine
from axiscal.measurement.candidates import spread
from axiscal.measurement.readers.bed_map import mesh as saved_mesh
from axiscal.measurement.readers.csv_readings import ALONE
from axiscal.measurement.readers.text_file import TextFile
from axiscal.measurement.setup import Setup
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal.ports.printers.printer import Exported, Moonraker
from axiscal.ports.printers.printer_source import PrinterSource, loader_at
from axiscal.tables.surface import mesh_of_nodes
from tests.controls.fetched import python
from tests.controls.klipper_host import klipper
from tests.controls.known import TRAVELS

BED = (0.31, 0.8, -0.6, 0.5, -0.3)
"""mm: the height of the bed at 0, and by x, y, x y and x x in 100 mm: a bed as crooked as a probe is quick here."""
ASIDE, LEAN = (25.0, -5.0), 0.8e-3
"""mm from the nozzle to the probe, and rad by which Y leans towards -x."""
_TURN, _STEPS = {"x": 16.0, "y": 16.0, "z": 8.0}, 200 * 16
"""mm of a turn of each motor, and its steps."""
_SECONDS = 40.0
_OLD = "axiscal_mesh.cfg"
_AS_LEFT = 0.01
"""mm: a micro-controller that is a program here sees its bed as late as a busy computer lets it."""
_ON_TIME = ("chrt", "-f", "1")
"""Before what must not be late beside other work: Klipper stops a printer whose host is 25 ms late while it homes."""
_PLACES = np.array([[32.0, 8.0, 1.0], [70.0, 15.0, 2.0], [60.0, 70.0, 1.0]])
"""mm, near each other: a source goes slowly"""


def height(x: float, y: float) -> float:
    """Return how high the bed is, mm.  x, y : mm"""
    a, b = x / 100, y / 100
    return BED[0] + BED[1] * a + BED[2] * b + BED[3] * a * b + BED[4] * a * a


def meets(x: float, y: float) -> float:
    """Return how high the bed is where the probe is, with the head of a printer that leans at a place, mm."""
    return height(x - LEAN * (y - ASIDE[1]), y)


SIMULATOR = Simulator(load_machine("printer-gantry"), ())
_FRAME = """
machine = "printer-gantry"
controls = ["klipper"]
[[artefacts]]
name = "frame"
balls = { one = ["-40 mm", "-40 mm", "9 mm"], two = ["40 mm", "-30 mm", "9 mm"], three = ["0 mm", "50 mm", "14 mm"] }
calibrated = "0.3 mm"
diameter = "12 mm"
[[setups]]
name = "frame"
instrument = "sphere"
artefact = "frame"
at = ["100 mm", "80 mm", "-40 mm"]
"""


@dataclass(frozen=True)
class Printer:
    """What answers; port : of Moonraker; files : the folder of the configuration"""

    port: int
    files: Path

    @property
    def host(self) -> str:
        """Its name as of a source."""
        return f"127.0.0.1:{self.port}"

    def asked(self, path: str, query: Mapping[str, str] | None = None, post: bool = False) -> Any:
        """Return what Moonraker answers; raises OSError."""
        url = f"http://{self.host}{path}" + (f"?{urllib.parse.urlencode(query)}" if query else "")
        with urllib.request.urlopen(url, b"" if post else None, timeout=30) as answer:
            return json.loads(answer.read())["result"]

    def told(self, *codes: str) -> None:
        """Have G-code executed; raises AssertionError with the log where it is not."""
        try:
            self.asked("/printer/gcode/script", {"script": "\n".join(codes)}, post=True)
        except urllib.error.HTTPError as fault:
            said = fault.read().decode()
            raise AssertionError(f"{codes}: {said}: {self._log()}") from fault

    def status(self, name: str) -> dict[str, Any]:
        """Return what an object of Klipper says."""
        found: dict[str, Any] = self.asked("/printer/objects/query", {name: ""})["status"][name]
        return found

    def ready(self) -> None:
        """Wait until Klipper is; raises AssertionError with its log."""
        end = time.monotonic() + _SECONDS
        said = ""
        while time.monotonic() < end:
            try:
                said = str(self.asked("/printer/info")["state"])
            except OSError as fault:
                said = str(fault)
            if said == "ready":
                return
            assert said not in ("error", "shutdown"), self._log()
            time.sleep(0.1)
        raise AssertionError(f"{said}: {self._log()}")

    def _log(self) -> str:
        log = (self.files.parent / "klippy.log").read_text()
        return "\n".join([*(line for line in log.splitlines() if "hutdown" in line), log[-1500:]])


def config(data: Path) -> str:
    """Return printer.cfg.  data : the folder in which everything runs"""
    lines = [
        "[include axiscal_*.cfg]",
        "[mcu]",
        f"serial: {data}/mcu",
        "restart_method: command",
        "[printer]",
        "kinematics: cartesian",
    ]
    lines += ["max_velocity: 200", "max_accel: 3000", "max_z_velocity: 10", "max_z_accel: 100"]
    for k, axis in enumerate("xyz"):
        low, high = TRAVELS[axis.upper()]
        lines += [f"[stepper_{axis}]", f"step_pin: gpio{4 * k}", f"dir_pin: gpio{4 * k + 1}", "microsteps: 16"]
        lines += [f"enable_pin: !gpio{4 * k + 2}", f"rotation_distance: {_TURN[axis]}", "homing_retract_dist: 0"]
        lines += [f"position_min: {low - 5}", f"position_max: {high + 5}"]
        if axis == "z":
            lines += ["homing_speed: 5", "endstop_pin: probe:z_virtual_endstop"]
        else:
            lines += ["homing_speed: 40", f"endstop_pin: gpio{4 * k + 3}", "position_endstop: 0"]
    lines += ["[output_pin placed]", "pin: gpio14", "[skew_correction]"]
    lines += [
        "[probe]",
        "pin: gpio13",
        f"x_offset: {ASIDE[0]}",
        f"y_offset: {ASIDE[1]}",
        "z_offset: 0",
        "speed: 4",
        "lift_speed: 10",
        "samples: 1",
    ]
    lines += ["[bed_mesh]", "mesh_min: 0, 0", "mesh_max: 300, 240", "[virtual_sdcard]", f"path: {data}/gcodes"]
    return "\n".join(lines) + "\n"


def read(printer: Printer) -> tuple[Array, Array]:
    """Return what a source reads of the bed, and how high it is, both (n,) mm over the first place."""
    with pytest.raises(SourceError, match="has its whole correction in force"):
        open_source(f"moonraker:{printer.host}", SIMULATOR)
    printer.told("AXISCAL ENABLE=0")
    source = open_source(f"moonraker:{printer.host}", SIMULATOR)
    found = [source.read(_request(x, y)) for x, y, _ in _PLACES]
    assert printer.status("toolhead")["position"][2] == pytest.approx(5.0)  # lifted: a printer homes with dragging else
    heights = np.array([-1e3 * each.value for each in found if isinstance(each, Answer)])
    bed = np.array([meets(x, y) for x, y, _ in _PLACES])
    return heights - heights[0], bed - bed[0]


def refused(printer: Printer) -> None:
    """Set a skew and see it refused."""
    printer.told("SET_SKEW XY=1414.3,1414.1,1000")
    source = open_source(f"moonraker:{printer.host}", SIMULATOR)
    with pytest.raises(SourceError, match="has a skew in force"):  # Klipper shows it with the next move
        source.read(_request(40.0, 60.0))
    printer.told("SET_SKEW CLEAR=1")


def framed(printer: Printer) -> None:
    """Put balls on the bed and read them: each is found where it is for a printer that leans."""
    text = (files("axiscal.machine") / "library" / "printer-gantry.toml").read_text(encoding="utf-8")
    text = text.replace('length = "40 mm"', 'length = "40 mm"\nstylus = "2 mm"')
    campaign = campaign_from_texts(_FRAME, "campaign.toml", text, "printer.toml")
    (setup,) = campaign.setups
    assert setup.artefact is not None
    stated = 1e3 * setup.artefact.points + [0.0, 0.0, 40.0]
    lines = ["7", *(f"{x + 0.3} {y - 0.2} {z + 0.1}" for x, y, z in stated)]
    (printer.files.parent / "balls").write_text("\n".join(lines))
    printer.told("SET_PIN PIN=placed VALUE=1", "G4 P200", "SET_PIN PIN=placed VALUE=0", "G4 P200")
    source = PrinterSource(Moonraker(printer.host), campaign.machine, asked=lambda _: "")
    for pose in spread(campaign.machine, (setup,), 3).poses:
        at = tuple(pose.tolist())
        answer = source.read(Request(1, setup, campaign.machine.axes, at, (0, 0, 0)))
        assert isinstance(answer, Answer)
        y = 1e3 * at[campaign.machine.index("Y")]
        off = -1e3 * np.array([answer.value, answer.others[0]]) - [0.3 + LEAN * (y - ASIDE[1]), -0.2]
        assert np.abs(off).max() < _AS_LEFT, off


def loaded(printer: Printer, mesh: str) -> tuple[Array, Array]:
    """Put a mesh into the printer, and return what it adds to Z and what the mesh says there, (n,) mm each."""
    said = loader_at(f"moonraker:{printer.host}", "klipper").load(mesh, "axiscal")
    assert "the one that was there is axiscal_mesh_" in said
    printer.told("G28")
    with pytest.raises(AssertionError, match="corrects the machine already, and a bed mesh is active too"):
        printer.told("G1 Z2")
    printer.told("AXISCAL ENABLE=0")
    found = added(printer)[:, 2]
    left, bed = as_left(printer, mesh), np.array([meets(x, y) for x, y, _ in _PLACES])
    assert np.abs(np.diff(left) - np.diff(bed - found)).max() < _AS_LEFT
    printer.told("BED_MESH_CLEAR")
    text = TextFile(_OLD, tuple(mesh.splitlines()))
    return found, 1e3 * mesh_of_nodes(saved_mesh(text, ALONE).readings).at(*_PLACES[:, :2].T * 1e-3)


def as_left(printer: Printer, mesh: str) -> Array:
    """Return how high the bed is with the mesh in force, (n,) mm."""
    with pytest.raises(SourceError, match="has a bed mesh in force"):
        open_source(f"moonraker:{printer.host}", SIMULATOR)
    source = PrinterSource(Moonraker(printer.host, Exported(mesh, None, {})), SIMULATOR.machine)
    found = [source.read(_request(x, y)) for x, y, _ in _PLACES]
    return np.array([-1e3 * each.value for each in found if isinstance(each, Answer)])


def added(printer: Printer) -> Array:
    """Return what is added to X, Y, Z at places, (n, 3) mm."""
    found = []
    for place in _PLACES:
        printer.told("G90", "G1 X{} Y{} Z{} F9000".format(*place), "M400")
        found.append(printer.status("toolhead")["position"][:3])
    return np.asarray(np.array(found) - _PLACES)


def whole(printer: Printer) -> tuple[Array, Array]:
    """Return what the extra adds after Klipper and its micro-controller were started again, and where, (n, 3) mm."""
    printer.told("FIRMWARE_RESTART")
    time.sleep(1.0)
    printer.ready()
    printer.told("G28")
    return added(printer), _PLACES


def _request(x: float, y: float) -> Request:
    axes, still = load_machine("printer-gantry").axes, (0.0, 0.0, 0.0)
    setup = Setup("bed", "probe", (0.0, 0.0, 1.0), (1, 2), still, 1e-5, (), 60, 1, 5, still, "both")
    at = {"X": x * 1e-3, "Y": y * 1e-3}
    return Request(1, setup, axes, tuple(at.get(axis.name, 0.0) for axis in axes), (0,) * len(axes))


@contextmanager
def running(exported: Mapping[str, str]) -> Iterator[Printer]:
    """Yield a printer that is homed, with the extra and the file of an export.  exported : its files"""
    at = klipper()
    with TemporaryDirectory(prefix="axiscal-printer-") as folder, ExitStack() as stack:
        data = Path(folder)
        for name in ("config", "gcodes", "logs"):
            (data / name).mkdir()
        (at / "klippy" / "extras" / "axiscal.py").write_text(exported["axiscal.py"])
        (data / "config" / "axiscal.vcomp").write_text(exported["axiscal.vcomp"])
        (data / "config" / "printer.cfg").write_text(config(data) + "[axiscal]\n")
        (data / "config" / _OLD).write_text("# of the owner\n")
        printer = Printer(_free(), data / "config")
        server = ["[server]", "host: 127.0.0.1", f"port: {printer.port}", f"klippy_uds_address: {data}/klippy"]
        server += [
            "[authorization]",
            "trusted_clients:",
            "  127.0.0.1",
            "[file_manager]",
            "[machine]",
            "provider: none",
        ]
        (data / "config" / "moonraker.conf").write_text("\n".join(server) + "\n")
        env = {"PROBE": ",".join(map(str, (*ASIDE, LEAN))), "BALLS": str(data / "balls")}
        env |= {"STEPS_PER_MM": ",".join(f"{_STEPS / turn}" for turn in _TURN.values()), "BED": ",".join(map(str, BED))}
        on_time = _ON_TIME if _permitted() else ()
        words: list[list[str | Path]] = [[*on_time, at / "out" / "klipper.elf", "-I", data / "mcu"]]
        words += [
            [
                *on_time,
                python(),
                at / "klippy/klippy.py",
                data / "config/printer.cfg",
                "-a",
                data / "klippy",
                "-l",
                data / "klippy.log",
            ]
        ]
        words += [[python(), "-m", "moonraker", "-d", data, "-c", data / "config/moonraker.conf", "-n"]]
        for number, each in enumerate(words):
            stack.enter_context(_started(each, data, number, env))
        printer.ready()
        printer.told("G28")
        yield printer


@contextmanager
def _started(words: Sequence[str | Path], data: Path, number: int, env: Mapping[str, str]) -> Iterator[None]:
    with (data / f"said-{number}.log").open("w") as log:
        process = subprocess.Popen(words, cwd=data, stdout=log, stderr=log, env={**os.environ, **env})
        try:
            yield
        finally:
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(5)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait(5)


def _permitted() -> bool:
    """Whether this computer lets us put a process before others."""
    return which(_ON_TIME[0]) is not None and subprocess.run([*_ON_TIME, "true"], check=False).returncode == 0


def _free() -> int:
    with socket.create_server(("127.0.0.1", 0)) as found:
        return int(found.getsockname()[1])
