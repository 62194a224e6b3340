"""Height maps put into a printer over the network, in force when it is done, and read back.

Written from what Moonraker and RepRapFirmware document, tried against small servers that speak that, never on a
printer. What is there under the same name is kept beside it.
"""

from __future__ import annotations

import json
import time
import urllib.parse
import zlib
from collections.abc import Callable, Mapping

import numpy as np

from axiscal.campaign.sources.printer import Duet, Moonraker, found_at
from axiscal.compensation.controllers.klipper import plain_profile
from axiscal.exceptions import SourceError, TableError

_CONFIG = "axiscal_mesh.cfg"
_MAP = "0:/sys/heightmap.csv"
_BEFORE = "0:/sys/heightmap_before_axiscal.csv"
_RESTART = 60.0
"""s for Klipper to read its files again."""
_POLL = 0.2
"""s between two looks whether it has."""
_SAME = 1e-6
"""mm: rounding of a height that is written with six decimals."""
_BOUNDARY = "axiscal-8f2c61"
"""Between the parts of what is sent; in no file of ours."""


def load(where: str, files: Mapping[str, str], name: str) -> str:
    """Put the files of an export into a printer and return in a sentence what was done.

    where : moonraker:HOST or duet:HOST; name : of the profile
    Raises TableError where the files are not for it, SourceError where the printer does not take them.
    """
    kind, _, host = where.partition(":")
    if kind not in _LOADERS:
        raise TableError(f"{where[:60]!r} is no printer", "Write --load moonraker:voron.local or duet:192.168.1.7")
    made, controller, file = _LOADERS[kind]
    if file not in files:
        raise TableError(f"{kind} takes {file}, which this export does not hold", f"Export with --to {controller}")
    return made(host.strip()).load(files[file], name)


class MoonrakerLoader(Moonraker):
    """Klipper reads a profile from a file that printer.cfg includes, when it is started again."""

    def load(self, mesh: str, name: str) -> str:
        """Write the profile, start Klipper again, load the profile and compare; raises SourceError."""
        self.refuse_busy()
        self._upload(_CONFIG, plain_profile(mesh))
        if f"[include {_CONFIG}]" not in self._ask("/server/files/config/printer.cfg").decode(errors="replace"):
            what = f"has {_CONFIG} now, and its printer.cfg does not read it"
            raise self._not_ready(what, f"Write the line [include {_CONFIG}] at the top of printer.cfg, then again")
        self._ask("/printer/restart", body="")
        self._wait_until_ready()
        self._script(f"BED_MESH_PROFILE LOAD={name}")
        found = self._status("bed_mesh")
        if found_at(found, "bed_mesh", "profile_name") != name or not _alike(
            found_at(found, "bed_mesh", "probed_matrix"), mesh
        ):
            raise self._not_ready(f"does not hold the profile {name} as it was sent", "Look at its console")
        return f"{_CONFIG} is in the printer, and its profile {name} is in force. It has to be homed again."

    def _upload(self, file: str, text: str) -> None:
        parts = [("root", None, "config"), ("file", file, text)]
        lines = list[str]()
        for field, named, content in parts:
            more = f'; filename="{named}"' if named else ""
            lines += [f"--{_BOUNDARY}", f'Content-Disposition: form-data; name="{field}"{more}', "", content]
        body = "\r\n".join([*lines, f"--{_BOUNDARY}--", ""])
        self._ask("/server/files/upload", body=body, kind=f"multipart/form-data; boundary={_BOUNDARY}")

    def _wait_until_ready(self) -> None:
        end = time.monotonic() + _RESTART
        while (state := found_at(self._document("/printer/info"), "result", "state")) != "ready":
            if state in ("error", "shutdown") or time.monotonic() > end:
                what = f"is {state!r} after it was started again"
                raise self._not_ready(what, f"Take [include {_CONFIG}] out of printer.cfg, and look at its log")
            time.sleep(_POLL)


class DuetLoader(Duet):
    """RepRapFirmware reads `0:/sys/heightmap.csv` at G29 S1."""

    def load(self, mesh: str, name: str) -> str:
        """Keep the map that is there, write the new one, load it and compare; raises SourceError."""
        self.refuse_busy()
        if (old := self._kept()) is not None:
            self._put(_BEFORE, old)
        self._put(_MAP, mesh)
        if self._kept() != mesh:
            raise self._not_ready(f"does not hold {_MAP} as it was sent", "Look at its card")
        self._run("G29 S1", wait=True)
        if (kind := self.compensation()) != "mesh":
            raise self._not_ready(f"says its compensation is {kind!r} after G29 S1", "Look at its console")
        beside = "" if old is None else f"; the one that was there is {_BEFORE}"
        return f"{_MAP} is in the printer and in force{beside}."

    def _kept(self) -> str | None:
        """Return the map that is there, None where there is none."""
        path = f"/machine/file/{urllib.parse.quote(_MAP, safe='')}"
        try:
            data = self._ask("/rr_download", {"name": _MAP}) if self._alone else self._ask(path)
        except SourceError:
            return None
        return data.decode("ascii", errors="replace")

    def _put(self, file: str, text: str) -> None:
        if not self._alone:
            self._ask(f"/machine/file/{urllib.parse.quote(file, safe='')}", body=text, method="PUT")
            return
        query = {"name": file, "crc32": f"{zlib.crc32(text.encode('ascii')):08x}"}
        said = self._ask("/rr_upload", query, body=text)
        if found_at(_document(said), "err") != 0:
            raise self._not_ready(f"did not take {file}", "Look at its card")


def _document(data: bytes) -> object:
    try:
        return json.loads(data)
    except ValueError:
        return None


def _alike(held: object, mesh: str) -> bool:
    """Whether a printer's matrix has the heights of a profile as it was written."""
    rows = [line.partition("\t")[2] for line in mesh.splitlines() if "\t" in line]
    wanted = np.array([[float(each) for each in row.split(",")] for row in rows])
    try:
        matrix = np.array(held, dtype=float)
    except (TypeError, ValueError):
        return False
    return matrix.shape == wanted.shape and bool(np.all(np.abs(matrix - wanted) <= _SAME))


_LOADERS: Mapping[str, tuple[Callable[[str], MoonrakerLoader | DuetLoader], str, str]] = {
    "moonraker": (MoonrakerLoader, "klipper", "bed_mesh.cfg"),
    "duet": (DuetLoader, "reprapfirmware", "heightmap.csv"),
}
"""By kind: what loads, for which exports, which of their files."""
