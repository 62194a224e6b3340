"""Printers as sources: a Duet, and what goes wrong, against small servers; Klipper itself is in tests/controls."""

from __future__ import annotations

import json
import re
import threading
import urllib.parse
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from io import StringIO
from typing import Any, TypeVar

import numpy as np
import pytest

from axiscal.campaign.sources import open_source
from axiscal.campaign.sources.source import Answer, Request, Skip
from axiscal.description.campaign import campaign_from_texts
from axiscal.exceptions import SourceError
from axiscal.machine.description import load_machine
from axiscal.measurement.candidates import spread
from axiscal.measurement.setup import Setup
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal.ports.printers.printer import Exported, Moonraker
from axiscal.ports.printers.printer_source import PrinterSource, moonraker


def bed(x: float, y: float) -> float:
    """How high the bed is, mm."""
    return 0.05 + 0.0004 * x - 0.0002 * y


ASIDE = (20.0, -5.0)
"""mm from the nozzle to the probe."""


class Server(ThreadingHTTPServer):
    """A printer: where it is, what it was told, and what it answers."""

    daemon_threads = True
    state: dict[str, Any]

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.at = {"X": 0.0, "Y": 0.0, "Z": 0.0}
        self.told: list[str] = []
        self.replies: list[str] = []
        self.last: object = None
        self.lost = False
        self.alone = False
        self.klipper: dict[str, Any] = {
            "webhooks": {"state": "ready"},
            "print_stats": {"state": "standby"},
            "toolhead": {"homed_axes": "xyz"},
            "bed_mesh": {"profile_name": ""},
            "axiscal": {},
            "configfile": {"settings": {"bltouch": {"x_offset": 20.0, "y_offset": -5.0}}},
            "gcode_move": {"position": [1.0, 2.0, 5.0, 9.0], "gcode_position": [1.0, 2.0, 5.0, 0.0]},
        }
        self.duet: dict[str, Any] = {
            "state": {"status": "idle"},
            "move": {"axes": [{"homed": True}] * 3, "compensation": {"type": "none"}, "workplaceNumber": 1},
            "sensors": {"probes": [{"offsets": [20.0, -5.0]}]},
        }

    def height(self, x: float, y: float) -> float:
        """How high the probe meets anything at a place, mm."""
        return bed(x, y)

    def execute(self, code: str) -> str:
        self.told.append(code)
        self.at |= {axis: float(value) for axis, value in re.findall(r"([XYZ])(-?[\d.]+)", code)}
        height = round(self.height(self.at["X"] + ASIDE[0], self.at["Y"] + ASIDE[1]), 6)
        if code == "PROBE":
            self.last = height
        return f"Stopped at height {height} mm\n" if code == "G30 S-1" else ""


class Handler(BaseHTTPRequestHandler):
    server: Server

    def do_GET(self) -> None:
        path, _, query = self.path.partition("?")
        asked = dict(urllib.parse.parse_qsl(query, keep_blank_values=True))
        printer = self.server
        if printer.lost:
            self.connection.close()
        elif path == "/printer/objects/query":
            known = printer.klipper | {"probe": {"name": "bltouch", "last_z_result": printer.last}}
            self._say(json.dumps({"result": {"status": {name: known[name] for name in asked}}}))
        elif path == "/machine/model" and not printer.alone:
            self._say(json.dumps(printer.duet))
        elif path == "/rr_connect":
            self._say('{"err": 0}')
        elif path == "/rr_model":
            self._say(json.dumps({"key": asked["key"], "result": printer.duet[asked["key"]]}))
        elif path == "/rr_gcode":
            printer.replies.append(printer.execute(asked["gcode"]))
            self._say('{"buff": 200}')
        elif path == "/rr_reply":
            self._say(printer.replies.pop(0) if printer.replies else "")
        else:
            self.send_error(404)

    def do_POST(self) -> None:
        path, _, query = self.path.partition("?")
        body = self.rfile.read(int(self.headers.get("Content-Length", 0))).decode()
        if self.server.lost:
            self.connection.close()
        elif path == "/printer/gcode/script":
            try:
                for code in urllib.parse.parse_qs(query)["script"][0].split("\n"):
                    self.server.execute(code)
            except RefusedError as refused:
                self.send_error(400, str(refused))
            else:
                self._say('{"result": "ok"}')
        elif path == "/machine/code":
            self._say(self.server.execute(body))
        else:
            self.send_error(404)

    def _say(self, text: str) -> None:
        self.send_response(200)
        self.end_headers()
        self.wfile.write(text.encode())

    def log_message(self, *_: Any) -> None:
        """Nobody reads it."""


Printing = TypeVar("Printing", bound=Server)


@contextmanager
def serving(server: Printing) -> Iterator[Printing]:
    """Yield a printer that answers."""
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    yield server
    server.shutdown()
    server.server_close()
    thread.join()


@pytest.fixture
def printer() -> Iterator[Server]:
    with serving(Server()) as server:
        yield server


def opened(kind: str, server: Server) -> Any:
    return open_source(f"{kind}:127.0.0.1:{server.server_address[1]}", SIMULATOR)


SIMULATOR = Simulator(load_machine("printer-gantry"), ())


def request(x: float, y: float, side: tuple[int, int] = (0, 0), up: float = 1.0) -> Request:
    machine = load_machine("printer-gantry")
    direction, still = (1.0 - up, 0.0, up), (0.0,) * 4
    setup = Setup("bed", "probe", direction, (1, 2), still[:3], 1e-5, (), 60, 1, 5, still[:3], "both")
    place = {"X": x / 1e3, "Y": y / 1e3, "Z": 0.0}
    come = {"X": side[0], "Y": side[1], "Z": 0}
    names = [axis.name for axis in machine.axes]
    return Request(1, setup, machine.axes, tuple(place[n] for n in names), tuple(come[n] for n in names))


@pytest.mark.parametrize("alone", [False, True])
def test_the_bed_is_probed_where_it_was_planned(printer: Server, alone: bool) -> None:
    """Where the bed is high the tool is too low: a reading is minus the height."""
    printer.alone = alone
    source = opened("duet", printer)
    for x, y in ((10.0, 20.0), (250.5, 130.25)):
        answer = source.read(request(x, y))
        assert isinstance(answer, Answer)
        assert answer.value == pytest.approx(-bed(x, y) * 1e-3, abs=1e-9)
        assert answer.live
    source.close()
    lifted = [code for code in printer.told if code.startswith("G1 Z5.000")]
    assert len(lifted) == 4  # over the bed before it goes across, and off what it has met
    assert printer.told[-2:] == [lifted[-1], "M400"]


def test_a_side_is_come_from(printer: Server) -> None:
    """Over the overrun for which the plan has left room within the travel."""
    opened("moonraker", printer).read(request(100.0, 50.0, (1, -1)))
    moves = [code for code in printer.told if code.startswith("G1 X")]
    assert moves == ["G1 X79.000 Y56.000 F3000", "G1 X80.000 Y55.000 F3000"]  # less the offset of the probe


NOT_READY = [
    ("moonraker", ("webhooks", "state"), "shutdown", "not ready"),
    ("moonraker", ("print_stats", "state"), "printing", "prints"),
    ("moonraker", ("toolhead", "homed_axes"), "xy", "is not homed"),
    ("moonraker", ("bed_mesh", "profile_name"), "default", "has a bed mesh in force"),
    ("moonraker", ("axiscal", "active"), True, "has its whole correction in force"),
    ("moonraker", ("gcode_move", "gcode_position"), [0.0, 2.0, 5.0, 0.0], "has its coordinates shifted"),
    ("moonraker", ("toolhead", "position"), [1.001, 2.0, 5.0, 9.0], "has a skew in force"),
    ("duet", ("state", "status"), "processing", "not idle"),
    ("duet", ("move", "axes"), [{"homed": True}, {"homed": False}, {"homed": True}], "is not homed"),
    ("duet", ("move", "axes"), [{"homed": True, "workplaceOffsets": [0, 1.5]}] * 3, "has its coordinates shifted"),
    ("duet", ("move", "compensation"), {"type": "mesh"}, "has a height map in force"),
]


@pytest.mark.parametrize(("kind", "keys", "value", "message"), NOT_READY)
def test_a_printer_that_is_not_ready_is_not_moved(
    printer: Server, kind: str, keys: tuple[str, str], value: object, message: str
) -> None:
    known = printer.klipper if kind == "moonraker" else printer.duet
    known[keys[0]] = known[keys[0]] | {keys[1]: value}
    with pytest.raises(SourceError, match=message):
        opened(kind, printer)
    assert printer.told == []


NO_HEIGHT = [
    *(
        ("moonraker", last, "where the height of the bed was expected")
        for last in (None, "0.1", float("nan"), True, [1])
    ),
    ("moonraker", 7.5, r"7\.500 mm off the bed's zero"),
    ("duet", "Error: G30: probe already triggered", "probe already triggered"),
]


@pytest.mark.parametrize(("kind", "said", "message"), NO_HEIGHT)
def test_a_height_that_is_none_ends_the_run(
    printer: Server, kind: str, said: object, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = opened(kind, printer)
    printer.last = said
    monkeypatch.setattr(printer, "execute", lambda code: said)
    with pytest.raises(SourceError, match=message):
        source.read(request(10, 10))


class RefusedError(Exception):
    """A line that Klipper does not execute."""


OUT_OF_RANGE = {
    "moonraker": "Move out of range: 10.000 10.000 5.000 [0.000]",
    "duet": "Error: G0/G1: target position outside machine limits\n",
}


@pytest.mark.parametrize(("kind", "alone"), [("moonraker", False), ("duet", False), ("duet", True)])
def test_a_point_that_a_printer_does_not_reach_is_skipped(
    printer: Server, monkeypatch: pytest.MonkeyPatch, kind: str, alone: bool
) -> None:
    printer.alone = alone
    source = opened(kind, printer)
    told, execute = list[str](), printer.execute

    def refusing(code: str) -> str:
        told.append(code)
        if not code.startswith("G1 X"):
            return execute(code)
        if kind == "moonraker":
            raise RefusedError(OUT_OF_RANGE[kind])
        return OUT_OF_RANGE[kind]

    monkeypatch.setattr(printer, "execute", refusing)
    answer = source.read(request(10, 10))
    assert isinstance(answer, Skip)
    assert "out of range" in answer.reason or "outside machine limits" in answer.reason
    assert not {"G30 S-1", "PROBE"} & set(told)


@pytest.mark.parametrize("kind", ["moonraker", "duet"])
def test_an_answer_of_a_byte_now_and_then_is_not_waited_for(
    printer: Server, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    """Each byte comes in time; all of them would take an hour."""
    monkeypatch.setattr("axiscal.ports.printers.printer.TIMEOUT", 0.2)
    gone = threading.Event()

    def dripping(handler: Handler, text: str) -> None:
        handler.send_response(200)
        handler.end_headers()
        for byte in text.encode() * 1000:
            if gone.wait(0.05):
                return
            with suppress(OSError):
                handler.wfile.write(bytes([byte]))

    monkeypatch.setattr(Handler, "_say", dripping)
    with pytest.raises(SourceError, match=r"has not come within 0\.2 s"):
        opened(kind, printer)
    gone.set()


def test_a_probe_that_never_touches_is_said_without_a_traceback(
    printer: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = opened("moonraker", printer)
    said = {"code": 400, "message": "No trigger on probe after full movement", "traceback": "File app.py"}

    def refused(handler: Handler) -> None:
        handler.send_response(400)
        handler.end_headers()
        handler.wfile.write(json.dumps({"error": said}).encode())

    monkeypatch.setattr(Handler, "do_POST", refused)
    with pytest.raises(
        SourceError, match=r"refused /printer/gcode/script \(400\): No trigger .* movement\. Mend"
    ) as caught:
        source.read(request(10, 10))
    assert "File app.py" not in str(caught.value)


@pytest.mark.parametrize("kind", ["moonraker", "duet"])
def test_a_lost_connection_is_said(printer: Server, kind: str) -> None:
    source = opened(kind, printer)
    printer.lost = True
    with pytest.raises(SourceError, match="does not answer"):
        source.read(request(10, 10))


def test_other_readings_are_not_a_printers(printer: Server) -> None:
    source = opened("moonraker", printer)
    with pytest.raises(SourceError, match="cannot take the readings"):
        source.read(request(10, 10, up=0.0))
    assert printer.told == []


def test_a_probe_that_stands_elsewhere_than_stated_is_refused(printer: Server) -> None:
    source, asked = opened("moonraker", printer), request(10, 10)
    for offset in (None, (0.02, -0.005, 0.0)):
        source.read(replace(asked, setup=replace(asked.setup, offset=offset)))
    with pytest.raises(SourceError, match="stands 20 -5 mm beside the nozzle along x and y, and not 20 5 mm"):
        source.read(replace(asked, setup=replace(asked.setup, offset=(0.02, 0.005, 0.0))))
    printer.klipper["configfile"]["settings"]["axis_twist_compensation"] = {"z_compensations": [0.0, 0.1]}
    opened("moonraker", printer).read(replace(asked, setup=replace(asked.setup, offset=(0.0, 0.0, 0.0))))


def test_as_left_the_exported_mesh_has_to_be_in_force_and_what_it_adds_is_taken_off(printer: Server) -> None:
    exported = Exported("#*# points =\n#*# \t  0.100000, 0.200000\n", None, {})
    control = Moonraker(f"127.0.0.1:{printer.server_address[1]}", exported)
    for held in ([[0.1, 0.3]], [[0.1, 0.2]]):
        with pytest.raises(SourceError, match="does not have the exported mesh in force"):
            PrinterSource(control, SIMULATOR.machine)
        printer.klipper["bed_mesh"] = {"profile_name": "axiscal", "probed_matrix": held}
    printer.klipper["toolhead"] |= {"position": [1.0, 2.0, 5.15]}
    answer = PrinterSource(control, SIMULATOR.machine).read(request(10.0, 20.0))
    assert isinstance(answer, Answer)
    assert answer.value == pytest.approx(-(bed(10.0, 20.0) - 0.15) * 1e-3, abs=1e-9)


FRAME = """
machine = "printer-gantry"
controls = ["klipper"]
[[artefacts]]
name = "frame"
balls = { one = ["-60 mm", "-60 mm", "12 mm"], two = ["60 mm", "-60 mm", "12 mm"], three = ["0 mm", "60 mm", "20 mm"] }
calibrated = "0.3 mm"
diameter = "12 mm"
[[setups]]
name = "turned"
instrument = "sphere"
artefact = "frame"
at = ["150 mm", "150 mm", "-40 mm"]
turn = "90 deg"
"""
OFF = (0.3, -0.2, 0.1)
"""mm from where a ball is stated to where it stands."""


class Framed(Server):
    """A printer with balls on its bed."""

    balls: Array

    def height(self, x: float, y: float) -> float:
        """How high the probe meets a ball, or the bed, mm."""
        left = 7.0**2 - np.sum((self.balls[:, :2] - [x, y]) ** 2, axis=1)
        return float(max([bed(x, y), *(self.balls[:, 2] + np.sqrt(np.maximum(left, 0.0)))[left > 0]]))


@pytest.mark.parametrize("answer", ["\n", "stop\n"])
def test_a_ball_is_probed_from_above(monkeypatch: pytest.MonkeyPatch, answer: str) -> None:
    text = (
        (files("axiscal.machine") / "library" / "printer-gantry.toml")
        .read_text(encoding="utf-8")
        .replace('length = "40 mm"', 'length = "40 mm"\nstylus = "2 mm"')
    )
    campaign = campaign_from_texts(FRAME, "campaign.toml", text, "printer.toml")
    (setup,) = campaign.setups
    assert setup.artefact is not None
    monkeypatch.setattr("sys.stdin", StringIO(answer))
    with serving(Framed()) as printer:
        printer.balls = 1e3 * setup.artefact.points + [0.0, 0.0, 40.0] + OFF
        source = moonraker(f"127.0.0.1:{printer.server_address[1]}", campaign.machine, active=False)
        for pose in spread(campaign.machine, (setup,), 3).poses:
            asked = Request(1, setup, campaign.machine.axes, tuple(pose.tolist()), (0, 0, 0))
            if answer.strip():
                with pytest.raises(SourceError, match="the run was ended by 'stop'"):
                    source.read(asked)
                assert printer.told == ["G21", "G90", "G1 Z32.000 F600", "M400"]
                return
            read = source.read(asked)
            assert isinstance(read, Answer)
            assert 1e3 * np.array([read.value, *read.others]) == pytest.approx(-np.array(OFF), abs=1e-4)
        assert printer.told.count("PROBE") == 18
