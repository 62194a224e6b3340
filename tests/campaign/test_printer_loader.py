"""Height maps put into printers: a Duet, and what goes wrong, against small servers; Klipper is in tests/controls."""

from __future__ import annotations

import contextlib
import json
import re
import socket
import threading
import urllib.parse
import zlib
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from typing import Any

import pytest

from axiscal.cli.app import run
from axiscal.exceptions import SourceError, TableError
from axiscal.ports.printers.printer_source import loader_at
from tests.campaign.test_printer_source import Handler, Server, serving
from tests.tables.test_bed_round_trips import X, Y, bed, duet_map, estimated, klipper_file

INCLUDE = "[include axiscal_mesh.cfg]\n[printer]\nkinematics: cartesian\n"
MAP = "0:/sys/heightmap.csv"


class Keeping(Server):
    """A printer with files: Klipper's configuration, or the card of a Duet."""

    def __init__(self) -> None:
        super().__init__()
        self.RequestHandlerClass = Files
        self.files: dict[str, str] = {"printer.cfg": INCLUDE}
        self.info, self.spoils = "ready", False
        self.away, self.locked = 0, ""

    def execute(self, code: str) -> str:
        if code.startswith("BED_MESH_PROFILE LOAD="):
            held = [[0.1, 0.2]] if not self.spoils else [[0.2, 0.2]]
            self.klipper["bed_mesh"] = {"profile_name": code.partition("=")[2], "probed_matrix": held}
        if code == "G29 S2":
            self.duet["move"]["compensation"]["type"] = "none"
        if code == "G29 S1":
            duet_map(self.files[MAP])
            self.duet["move"]["compensation"]["type"] = "none" if self.spoils else "mesh"
        return super().execute(code)


class Files(Handler, BaseHTTPRequestHandler):
    server: Keeping

    def do_GET(self) -> None:
        path, _, query = self.path.partition("?")
        asked = dict(urllib.parse.parse_qsl(query))
        name = asked.get("name") or urllib.parse.unquote(path.removeprefix("/machine/file/"))
        if path == "/printer/info":
            self.server.away -= 1
            self.send_error(503) if self.server.away >= 0 else self._info()
        elif self.server.locked and self.server.locked in urllib.parse.unquote(self.path):
            self.send_error(500)
        elif path.startswith("/server/files/config/"):
            name = path.removeprefix("/server/files/config/")
            self._say(self.server.files[name]) if name in self.server.files else self.send_error(404)
        elif path == "/rr_download" or (path.startswith("/machine/file/") and not self.server.alone):
            self._say(self.server.files[name]) if name in self.server.files else self.send_error(404)
        else:
            super().do_GET()

    def do_PUT(self) -> None:
        self._kept(urllib.parse.unquote(self.path.removeprefix("/machine/file/")), self._body())
        self._say("")

    def do_POST(self) -> None:
        path, _, query = self.path.partition("?")
        if path == "/rr_upload":
            asked, body = dict(urllib.parse.parse_qsl(query)), self._body()
            right = f"{zlib.crc32(body.encode()):08x}" == asked["crc32"]
            self._kept(asked["name"], body)
            self._say(json.dumps({"err": int(not right)}))
        elif path == "/server/files/upload":
            found = re.search(r"boundary=(\S+)", self.headers["Content-Type"])
            assert found is not None
            parts = self._body().split(f"--{found[1]}")
            held = {re.search(r' name="(\w+)"', part)[1]: part for part in parts[1:-1]}  # type: ignore[index]
            assert held["root"].endswith("\r\n\r\nconfig\r\n")
            name = re.search(r'filename="([^"]+)"', held["file"])
            assert name is not None
            self._kept(name[1], held["file"].partition("\r\n\r\n")[2].removesuffix("\r\n"))
            self._say('{"action": "create_file"}')
        elif path == "/printer/restart":
            self._body()
            self._say('{"result": "ok"}')
        else:
            super().do_POST()

    def _info(self) -> None:
        self._say(json.dumps({"result": {"state": self.server.info}}))

    def _body(self) -> str:
        return self.rfile.read(int(self.headers.get("Content-Length", 0))).decode()

    def _kept(self, name: str, text: str) -> None:
        self.server.files[name] = text.replace("1", "2") if self.server.spoils else text


@pytest.fixture
def printer() -> Iterator[Keeping]:
    with serving(Keeping()) as server:
        yield server


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return estimated(tmp_path_factory.mktemp("bed"), klipper_file(X, Y, bed(X, Y)), "printer.cfg")


def at(kind: str, server: Keeping) -> str:
    return f"{kind}:127.0.0.1:{server.server_address[1]}"


@pytest.mark.parametrize("alone", [False, True])
def test_a_duet_holds_the_map_of_the_export_and_the_one_of_before(
    printer: Keeping, record: Path, tmp_path: Path, alone: bool
) -> None:
    printer.alone, printer.files[MAP] = alone, "the old one"
    words = ["export", str(record), "--to", "reprapfirmware", "--out", str(tmp_path / "d")]
    assert run([*words, "--load", at("duet", printer)]) == 0
    assert printer.files[MAP] == (tmp_path / "d" / "heightmap.csv").read_text()
    assert "the old one" in printer.files.values()
    assert printer.duet["move"]["compensation"]["type"] == "mesh"


HEIGHTS = (
    "RepRapFirmware height map file v2\n"
    "xmin,xmax,ymin,ymax,xspacing,yspacing,xnum,ynum\n0,1,0,1,1,1,2,2\n0.1,0.3\n0.4,0.5\n"
)
MESH = "#*# [bed_mesh axiscal]\n#*# points =\n#*# \t  0.100000, 0.200000\n"


KLIPPER, DUET = ("moonraker", "klipper", MESH), ("duet", "reprapfirmware", "a map 1")
"""What is asked, the control of its files, and one of them."""


@pytest.mark.parametrize(
    ("of", "spoil", "why"),
    [
        (KLIPPER, lambda p: p.klipper.update(print_stats={"state": "printing"}), "prints"),
        *(
            (KLIPPER, lambda p, line=line: p.files.update({"printer.cfg": line}), "does not read it")
            for line in ("[printer]\n", f"#{INCLUDE}", "[include conf.d/*.cfg]\n", "[include mesh*.cfg]\n")
        ),
        (KLIPPER, lambda p: setattr(p, "info", "error"), "after it was started again"),
        (KLIPPER, lambda p: setattr(p, "spoils", True), "does not hold the profile"),
        (DUET, lambda p: p.duet["state"].update(status="processing"), "not idle"),
        (DUET, lambda p: setattr(p, "spoils", True), "does not hold"),
    ],
)
def test_a_printer_that_does_not_take_it_is_a_sentence(
    printer: Keeping, of: tuple[str, str, str], spoil: Any, why: str
) -> None:
    spoil(printer)
    kind, to, text = of
    with pytest.raises(SourceError, match=why):
        loader_at(at(kind, printer), to).load(text, "axiscal")


@pytest.mark.parametrize("alone", [False, True])
def test_nothing_on_a_duet_is_overwritten_that_is_not_kept(printer: Keeping, alone: bool) -> None:
    printer.alone, printer.files[MAP] = alone, "of the owner, größer"
    printer.duet["move"]["compensation"]["type"] = "mesh"
    meshes = [HEIGHTS.replace("0.1", each) for each in ("0.1", "0.2", "0.2")]
    for mesh in meshes:
        said = loader_at(at("duet", printer), "reprapfirmware").load(mesh, "axiscal")
    assert {"of the owner, größer", *meshes} <= set(printer.files.values())
    assert "the one that was there" not in said


@pytest.mark.parametrize("alone", [False, True])
def test_a_map_that_cannot_be_read_is_not_overwritten(printer: Keeping, alone: bool) -> None:
    printer.alone, printer.files[MAP], printer.locked = alone, "of the owner", MAP
    with pytest.raises(SourceError, match=r"refused .*500.* give the command again"):
        loader_at(at("duet", printer), "reprapfirmware").load("a map 1", "axiscal")
    assert printer.files[MAP] == "of the owner"


def test_klipper_is_waited_for_while_moonraker_says_that_it_is_not_there(printer: Keeping) -> None:
    printer.away = 3
    assert "in force" in loader_at(at("moonraker", printer), "klipper").load(MESH, "axiscal")


@pytest.mark.parametrize(("kind", "to"), [("moonraker", "klipper"), ("duet", "reprapfirmware")])
def test_what_speaks_no_http_is_a_sentence(kind: str, to: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        threading.Thread(target=_greets, args=(server,), daemon=True).start()
        with pytest.raises(SourceError, match="does not answer"):
            loader_at(f"{kind}:127.0.0.1:{server.getsockname()[1]}", to).load(MESH, "axiscal")


def _greets(server: socket.socket) -> None:
    with contextlib.suppress(OSError):
        while True:
            with server.accept()[0] as line:
                line.recv(4096)
                line.sendall(b"SSH-2.0-OpenSSH_9.2\r\n")


def test_an_export_without_the_file_that_a_printer_takes_is_refused() -> None:
    with pytest.raises(TableError, match=r"takes bed_mesh\.cfg, which this export does not hold"):
        loader_at("moonraker:here", "klipper").accepted_text({"skew.gcode": ""})
