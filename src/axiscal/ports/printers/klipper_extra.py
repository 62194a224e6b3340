"""Klipper: positioning, straightness, squareness and the bed of a machine, all taken away at once as it moves.

Put this file into klippy/extras as axiscal.py and the file axiscal.vcomp beside printer.cfg, write [axiscal] into that,
and start Klipper again. For each axis of the chain, from the tool to the workpiece, at t along e, with its errors d of
displacement and r of rotation, the tilt v of its travel, and its side s (1 tool, -1 workpiece):

    off += s (d + r x lever) + v x (t e)

The lever is the tool vector with the travels passed before, and with this one where s = -1. What is added is minus
that, the same once more at the place to which it leads, and the height of the bed.
"""

from __future__ import annotations

import os
from bisect import bisect_right
from collections.abc import Iterator
from typing import Any

FADE = 5.0
"""mm beyond the calibrated travel over which the slope of a curve fades to nothing."""
ROUNDS = 3
"""From where the motors are to the place that was commanded; each is a thousandth of the one before."""


class Lines:
    """The lines of a file, one after the other; raises ValueError where one is not what is expected."""

    def __init__(self, text: str) -> None:
        body, _, end = text.rpartition("end ")
        seen = 2166136261
        for byte in body.encode():
            seen = (seen ^ byte) * 16777619 & 0xFFFFFFFF
        if end != f"{seen:08x}\n":
            raise ValueError("the checksum is wrong: it was changed, or copied in part")
        self.rest: Iterator[list[str]] = (line.split() for line in body.splitlines() if line[:1] != "#")

    def after(self, key: str) -> list[str]:
        """Return the words behind the key of the next line."""
        words = next(self.rest, [""])
        if words[0] != key:
            raise ValueError(f"a line {key} is expected, and there is {words[0]!r}")
        return words[1:]

    def numbers(self, key: str = "") -> list[float]:
        """Return the numbers of the next line."""
        return [float(word) for word in (self.after(key) if key else next(self.rest, []))]


class Carriage:
    """One linear axis: where it points, on which side it is, and its errors as cubics from knot to knot."""

    def __init__(self, lines: Lines) -> None:
        words = lines.after("axis")
        if words[0] not in "XYZ" or words[3] != "0" or words[7] != "1":
            raise ValueError(f"the axis {words[0]} is none of a printer")
        self.along, self.side = "xyz".index(words[1]), int(words[5])
        lines.after("origin")
        self.shift, self.tilt = lines.numbers("location"), lines.numbers("travel-tilt")
        words = lines.after("knots")
        if words[4] != "0":
            raise ValueError("a reversal is for another control")
        self.knots: list[float] = []
        self.curves: list[list[list[float]]] = []
        for left in reversed(range(int(words[0]))):
            self.knots += lines.numbers("knot")
            self.curves += [[lines.numbers() for _ in range(6)]] if left else []

    def off(self, t: float) -> list[float]:
        """Return displacement and rotation at t, mm and rad."""
        inside = min(max(t, self.knots[0]), self.knots[-1])
        n = min(bisect_right(self.knots, inside), len(self.knots) - 1) - 1
        x, far = inside - self.knots[n], min(abs(t - inside), FADE)
        beyond = (far - far * far / (2 * FADE)) * (1 if t > inside else -1)
        return [
            e + a + x * (b + x * (c + x * d)) + beyond * (b + x * (2 * c + 3 * x * d))
            for e, (a, b, c, d) in zip(self.shift, self.curves[n])
        ]


class Correction:
    """What a file says is to be added at a place; raises ValueError for a file that is none, or of another machine."""

    def __init__(self, text: str) -> None:
        lines = Lines(text)
        if lines.after("axiscal-vcomp") != ["1"]:
            raise ValueError("it has another form")
        self.campaign, self.checksum = lines.after("campaign")[0], text.split()[-1]
        if lines.after("units") != ["mm"]:
            raise ValueError("a printer counts in mm")
        self.limit, self.tool = lines.numbers("limits")[0], lines.numbers("tool")
        count = int(lines.after("axes")[0])
        self.axes = [Carriage(lines) for _ in range(count)]
        if sorted(axis.along for axis in self.axes) != [0, 1, 2]:
            raise ValueError("its axes are not X, Y and Z")
        deep = int(lines.after("bed")[1])
        self.x, self.y = lines.numbers(), lines.numbers()
        self.bed = [lines.numbers() for _ in range(deep)]

    def at(self, place: list[float]) -> list[float]:
        """Return what is added at x, y, z, mm."""
        first = self._once(place)
        x, y, z = self._once([t + further for t, further in zip(place, first)])
        return [x, y, z + self._height(place[0], place[1])]

    def _once(self, place: list[float]) -> list[float]:
        lever, off = list(self.tool), [0.0, 0.0, 0.0]
        for axis in reversed(self.axes):
            k, t, side = axis.along, place[axis.along], axis.side
            found = axis.off(t)
            if side < 0:
                lever[k] += t
            way = [t if i == k else 0.0 for i in range(3)]
            turned, tilted = crossed(found[3:], lever), crossed(axis.tilt, way)
            off = [o + side * (d + r) + v for o, d, r, v in zip(off, found, turned, tilted)]
            if side > 0:
                lever[k] += t
        return [-each for each in off]

    def _height(self, x: float, y: float) -> float:
        i, u = cell(self.x, x)
        j, v = cell(self.y, y)
        low, high = ((1 - u) * row[i] + u * row[i + 1] for row in self.bed[j : j + 2])
        return (1 - v) * low + v * high


def cell(places: list[float], at: float) -> tuple[int, float]:
    """Return the number of the cell, and where in it, 0 to 1; outside the nearest place counts."""
    n = min(max(bisect_right(places, at) - 1, 0), len(places) - 2)
    return n, min(max((at - places[n]) / (places[n + 1] - places[n]), 0.0), 1.0)


def crossed(a: list[float], b: list[float]) -> list[float]:
    """Return the cross product."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


class Axiscal:
    """The move transform, as bed_mesh is one."""

    def __init__(self, config: Any) -> None:
        self.printer, self.enabled = config.get_printer(), True
        self.next: Any = None  # what moves the motors, from klippy:connect on
        beside = os.path.dirname(self.printer.get_start_args()["config_file"])
        name = os.path.join(beside, os.path.expanduser(config.get("file", "axiscal.vcomp")))
        self.segment = config.getfloat("segment", 5.0, minval=0.5)
        try:
            with open(name, encoding="ascii") as file:
                self.correction = Correction(file.read())
        except (OSError, ValueError, LookupError) as fault:
            raise config.error(f"axiscal: {name} cannot be used: {fault}. Copy it whole.") from fault
        self.last = [0.0] * 4
        self.printer.register_event_handler("klippy:connect", self._connected)
        words = {"desc": "Switch the correction of axiscal on or off: AXISCAL ENABLE=0"}
        self.printer.lookup_object("gcode").register_command("AXISCAL", self._switched, **words)

    def get_status(self, eventtime: float) -> dict[str, Any]:
        """Return what macros and Moonraker see."""
        held = self.correction
        return {"active": self.enabled, "campaign": held.campaign, "checksum": held.checksum, "limit": held.limit}

    def get_position(self) -> list[float]:
        """Return the commanded place whose correction leads to where the motors are."""
        motors = self.next.get_position()
        place = list(motors)
        for _ in range(ROUNDS if self.enabled else 0):
            place[:3] = [at - added for at, added in zip(motors, self.correction.at(place[:3]))]
        self.last = place
        return list(place)

    def move(self, to: list[float], speed: float) -> None:
        """Go there in straight pieces, each corrected at its end."""
        if not self.enabled:
            self.next.move(to, speed)
        else:
            self._refuse_others()
            way = [b - a for a, b in zip(self.last, to)]
            pieces = max(1, int(sum(each * each for each in way[:3]) ** 0.5 / self.segment + 0.999))
            for n in range(1, pieces + 1):
                self.next.move(self._corrected([b - each * (pieces - n) / pieces for b, each in zip(to, way)]), speed)
        self.last = list(to)

    def _corrected(self, place: list[float]) -> list[float]:
        added = self.correction.at(place[:3])
        if max(map(abs, added)) > self.correction.limit:
            raise self.printer.command_error(f"axiscal: more than {self.correction.limit:g} mm would be added here")
        return [a + b for a, b in zip(place, added)] + place[3:]

    def _refuse_others(self) -> None:
        mesh, skew = (self.printer.lookup_object(name, None) for name in ("bed_mesh", "skew_correction"))
        if mesh is not None and mesh.get_mesh() is not None:
            what = "a bed mesh is active too: send BED_MESH_CLEAR, and load no profile"
        elif skew is not None and (skew.xy_factor or skew.xz_factor or skew.yz_factor):
            what = "a skew is active too: send SET_SKEW CLEAR=1, and load no profile"
        else:
            return
        raise self.printer.command_error(f"axiscal corrects the machine already, and {what}; or AXISCAL ENABLE=0.")

    def _connected(self) -> None:
        self.next = self.printer.lookup_object("gcode_move").set_move_transform(self, force=True)

    def _switched(self, command: Any) -> None:
        self.enabled = bool(command.get_int("ENABLE", int(self.enabled), minval=0, maxval=1))
        self.printer.lookup_object("gcode_move").reset_last_position()
        command.respond_info(f"axiscal is {'on' if self.enabled else 'off'}, campaign {self.correction.campaign}")


def load_config(config: Any) -> Axiscal:
    """Return what Klipper loads for the section [axiscal]."""
    return Axiscal(config)
