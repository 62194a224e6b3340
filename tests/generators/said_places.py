"""What the text of a campaign says of where each set-up is read, checked by matrices of the tests' own.

Read from the TOML itself: nothing of how the program reads it, and nothing of its charts, is used here.
"""

import math
import tomllib
from collections.abc import Mapping
from typing import Any

import numpy as np

from axiscal.measurement.reading import Place
from axiscal.numerics import Array
from tests.generators.kinematics import Chain, in_travel, pose_with_tip, stem, tip
from tests.generators.printed_machine import number

_NEAR = 1e-9
_WAYS = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}
_PLANES = {"xy": "z", "yz": "x", "zx": "y"}


def spot(texts: list[str]) -> Array:
    return np.array([number(text) for text in texts])


def way(value: Any) -> Array:
    if isinstance(value, str):
        return (-1.0 if value.startswith("-") else 1.0) * np.array(_WAYS[value.lstrip("+-")], dtype=float)
    given = np.array(value, dtype=np.float64)
    return np.asarray(given / np.linalg.norm(given), dtype=np.float64)


class Said:
    """What a campaign says.  Its machine is of the kind whose axes count as ISO 841 says."""

    def __init__(self, text: str, machine: Chain) -> None:
        self.machine = machine
        campaign = tomllib.loads(text)
        with_balls = (table for table in campaign.get("artefacts", []) if table.keys() & {"balls", "grid"})
        self.artefacts = {table["name"]: table for table in with_balls}
        self.setups = {table["name"]: dict(table) for table in campaign["setups"]}
        for table in self.setups.values():
            if table.get("artefact") not in self.artefacts:
                table.pop("artefact", None)  # a leg of a square: read where its axes are

    def holds(self, place: Place) -> str:
        """Assert that a reading can be taken where it is asked for; return by which rule it is held."""
        table, pose = self.setups[place.setup], np.array(place.pose)
        assert in_travel(self.machine, pose), place
        self._sides(place, pose)
        self._reach(table, pose)
        for key, rule in (
            ("along", self._line),
            ("length", self._bar),
            ("artefact", self._ball),
            ("range", self._seen),
        ):
            if key in table:
                rule(table, pose)
                return key
        self._parked(table, pose)
        return "axes"

    def _sides(self, place: Place, pose: Array) -> None:
        """Room to come from the planned side, of every axis that has one of its own."""
        if "artefact" in self.setups[place.setup] or self.setups[place.setup].keys() & {"along", "length"}:
            return  # linear axes follow: the ways there are looked at as a whole
        for axis, at, side in zip(self.machine.axes, pose, place.approach, strict=True):
            assert side == 0 or axis.travel[0] - _NEAR <= at - side * axis.overrun <= axis.travel[1] + _NEAR, place

    def _reach(self, table: Mapping[str, Any], pose: Array) -> None:
        half = number(table["base"]) / 2 if "base" in table else 0.0
        for name in table.get("moves", []) if half else []:
            axis = self.machine.axis(name)
            at = pose[self.machine.index(name)]
            assert axis.travel[0] - _NEAR <= at - half <= at + half <= axis.travel[1] + _NEAR, table["name"]
        for name, (low, high) in table.get("reach", {}).items():
            assert number(low) - _NEAR <= pose[self.machine.index(name)] <= number(high) + _NEAR, table["name"]
        for name, step in table.get("raster", {}).items():
            if name in {axis.name for axis in self.machine.axes}:
                at = pose[self.machine.index(name)] / number(step)
                assert abs(at - round(at)) < 1e-6, (table["name"], name, at)

    def _line(self, table: Mapping[str, Any], pose: Array) -> None:
        first, last = (spot(end) for end in table["along"])
        off, along = tip(self.machine, pose) - first, (last - first) / np.linalg.norm(last - first)
        assert np.linalg.norm(off - (off @ along) * along) < _NEAR
        assert -_NEAR <= off @ along <= np.linalg.norm(last - first) + _NEAR

    def _bar(self, table: Mapping[str, Any], pose: Array) -> None:
        bar = tip(self.machine, pose) - self.centre(table)
        assert abs(np.linalg.norm(bar) - number(table["length"])) < _NEAR
        plane = table.get("plane")
        if plane is not None:
            normal = way(_PLANES[plane]) if isinstance(plane, str) else np.cross(way(plane[0]), way(plane[1]))
            assert abs(bar @ normal) < _NEAR
        self._within_cone(table, pose, bar / np.linalg.norm(bar))

    def centre(self, table: Mapping[str, Any]) -> Array:
        """Return the middle of a bar."""
        return spot(table["station"]) if "station" in table else next(iter(self.balls(table).values()))

    def balls(self, table: Mapping[str, Any]) -> dict[str, Array]:
        """Return the balls that a set-up names, or all of its artefact."""
        artefact = self.artefacts[table["artefact"]]
        if "grid" in artefact:
            return _plate(artefact["grid"])
        chosen = table.get("ball", list(artefact["balls"]))
        chosen = [chosen] if isinstance(chosen, str) else chosen
        return {name: spot(artefact["balls"][name]) for name in chosen}

    def _ball(self, table: Mapping[str, Any], pose: Array) -> None:
        at = tip(self.machine, pose)
        assert min(float(np.linalg.norm(at - ball)) for ball in self.balls(table).values()) < _NEAR
        self._within_cone(table, pose, way(self.artefacts[table["artefact"]].get("free", "z")))
        if table["instrument"] != "rtest":  # it comes from 50 mm off
            back = number(table.get("retract", "50 mm"))
            lifted = pose_with_tip(self.machine, pose, at + back * stem(self.machine, pose))
            assert in_travel(self.machine, lifted)

    def _within_cone(self, table: Mapping[str, Any], pose: Array, free: Array) -> None:
        cone = number(self.artefacts.get(table.get("artefact", ""), {}).get("cone", "100 deg"))
        assert math.acos(float(np.clip(stem(self.machine, pose) @ free, -1, 1))) <= cone + 1e-6

    def _seen(self, table: Mapping[str, Any], pose: Array) -> None:
        far = float(np.linalg.norm(spot(table["station"]) - tip(self.machine, pose)))
        near, most = (number(text) for text in table["range"])
        assert near - _NEAR <= far <= most + _NEAR

    def _parked(self, table: Mapping[str, Any], pose: Array) -> None:
        moves = table.get("moves", [axis.name for axis in self.machine.axes])
        for axis, at in zip(self.machine.axes, pose, strict=True):
            if axis.name not in moves:
                stated = table.get("park", {}).get(axis.name)
                wanted = sum(axis.travel) / 2 if stated is None else number(stated)
                assert at == wanted or abs(at - wanted) < _NEAR


def _plate(grid: Mapping[str, Any]) -> dict[str, Array]:
    (rows, columns), (first, second) = grid["count"], (number(each) for each in grid["pitch"])
    down, across = (way(each) for each in grid["along"])
    places = {(i, j): i * first * down + j * second * across for i in range(rows) for j in range(columns)}
    return {f"{i} {j}": spot(grid["origin"]) + place for (i, j), place in places.items()}
