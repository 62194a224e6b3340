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
        curves: list[list[list[float]]] = []
        for left in reversed(range(int(words[0]))):
            self.knots += lines.numbers("knot")
            curves += [[lines.numbers() for _ in range(6)]] if left else []
        self.curves = [faded(curves[0], 0.0, -1), *curves, faded(curves[-1], self.knots[-1] - self.knots[-2], 1)]
        self.knots = [self.knots[0] - FADE, *self.knots, self.knots[-1] + FADE]
        self.pieces: list[tuple[float, ...]] = []
        self.turns, self.leans = False, [0.0] * 3

    def fold(self, tool: list[float], lever: bool) -> None:
        """Put tool, side and sign into the cubics, once for all.  lever : whether travels add to that of the tool"""
        for curves in self.curves:
            powers = [list(each) for each in zip(*curves)]
            powers[0] = [e + a for e, a in zip(self.shift, powers[0])]
            moved = [[d + r for d, r in zip(each[:3], crossed(each[3:], tool))] + each[3:] for each in powers]
            self.pieces.append(tuple(-self.side * each[k] for k in range(6) for each in moved))
        self.turns = lever and any(any(piece[12:]) for piece in self.pieces)
        self.leans = [-each for each in crossed(self.tilt, [float(k == self.along) for k in range(3)])]

    def added(self, t: float, lever: list[float]) -> tuple[float, float, float]:
        """Return what is added for the axis at t, mm.  lever : the travels between it and the tool"""
        knots = self.knots
        inside = min(max(t, knots[0]), knots[-1])
        n = bisect_right(knots, inside, 1, len(knots) - 1) - 1
        x, piece, (u, v, w) = inside - knots[n], self.pieces[n], self.leans
        a, b, c, d, e, f, g, h, i, j, k, m = piece[:12]
        u = u * t + a + x * (b + x * (c + x * d))
        v = v * t + e + x * (f + x * (g + x * h))
        w = w * t + i + x * (j + x * (k + x * m))
        if not self.turns:
            return u, v, w
        a, b, c, d, e, f, g, h, i, j, k, m = piece[12:]
        a += x * (b + x * (c + x * d))
        b = e + x * (f + x * (g + x * h))
        c = i + x * (j + x * (k + x * m))
        d, e, f = lever
        return u + b * f - c * e, v + c * d - a * f, w + a * e - b * d


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
        for number, axis in enumerate(reversed(self.axes)):
            axis.fold(self.tool, bool(number) or axis.side < 0)
        self.chain = self.axes[::-1]
        deep = int(lines.after("bed")[1])
        self.x, self.y = lines.numbers(), lines.numbers()
        self.bed = [lines.numbers() for _ in range(deep)]

    def at(self, place: list[float]) -> list[float]:
        """Return what is added at x, y, z, mm."""
        x, y, z = place
        u, v, w = self._once(place)
        u, v, w = self._once([x + u, y + v, z + w])
        return [u, v, w + self._height(x, y)]

    def _once(self, place: list[float]) -> tuple[float, float, float]:
        lever, x, y, z = [0.0, 0.0, 0.0], 0.0, 0.0, 0.0
        for axis in self.chain:
            k, side = axis.along, axis.side
            t = place[k]
            if side < 0:
                lever[k] += t
            u, v, w = axis.added(t, lever)
            x, y, z = x + u, y + v, z + w
            if side > 0:
                lever[k] += t
        return x, y, z

    def _height(self, x: float, y: float) -> float:
        i, u = cell(self.x, x)
        j, v = cell(self.y, y)
        low, high = self.bed[j], self.bed[j + 1]
        return (1 - v) * ((1 - u) * low[i] + u * low[i + 1]) + v * ((1 - u) * high[i] + u * high[i + 1])


def faded(curves: list[list[float]], x: float, way: int) -> list[list[float]]:
    """Return the cubics over FADE beyond an end, to which the slope there falls to nothing.

    curves : of the piece that ends or begins there, at x of it; way : 1 beyond the last knot, -1 before the first
    """
    found = []
    for a, b, c, d in curves:
        value, slope = a + x * (b + x * (c + x * d)), b + x * (2 * c + 3 * x * d)
        bent = slope / (2 * FADE)
        found.append([value, slope, -bent, 0.0] if way > 0 else [value - slope * FADE / 2, 0.0, bent, 0.0])
    return found


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
