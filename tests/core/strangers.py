"""Instruments as somebody would write them who has read the package's page and not its source: twelve lines at most."""

from __future__ import annotations

from typing import Any

import numpy as np

import axiscal_core as ac


class Interferometer(ac.Instrument):
    names, units, noise, unknowns = ("length",), ("m",), "0.3 um", {"zero": "1 mm"}
    along = (1.0, 0.0, 0.0)

    def sees(self, at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
        return [at.moved @ np.array(self.along) + u["zero"]]


class Straightedge(ac.Instrument):
    unknowns = {"zero": "1 mm", "slope": "1 mrad"}
    along, axis, middle = (0.0, 1.0, 0.0), 0, 0.0

    def sees(self, at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
        return [at.moved @ np.array(self.along) + u["zero"] + u["slope"] * (at.poses[:, self.axis] - self.middle)]


class Probe(ac.Instrument):
    along = (0.0, 0.0, 1.0)

    def sees(self, at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
        return [at.moved @ np.array(self.along) + u.get("zero", 0.0)]


class Autocollimator(ac.Instrument):
    names, units, noise, unknowns = ("angle",), ("rad",), "0.5 urad", {"zero": "1 mrad"}
    about = (0.0, 1.0, 0.0)

    def sees(self, at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
        return [at.turned @ np.array(self.about) + u.get("zero", 0.0)]


class Bar(ac.Instrument):
    names, units, noise = ("length",), ("m",), "0.5 um"
    station: Any = (0.0, 0.0, 0.0)

    def sees(self, at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
        line = at.tcp - np.array(self.station)
        tip = at.moved + sum(u.get(f"tool_{a}", 0.0) * at.tool[:, :, i] for i, a in enumerate("xyz"))
        off = np.array([u[f"station_{axis}"] for axis in "xyz"])
        return [ac.length(line + tip - off) - ac.length(line) + u["zero"]]


class Arm(ac.Instrument):
    names, units, noise = ("x", "y", "z"), ("m",) * 3, "10 um"
    station: Any = (0.0, 0.0, 0.0)

    def sees(self, at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
        line = at.tcp - np.array(self.station)
        off = line + at.moved + sum(u.get(f"tool_{a}", 0.0) * at.tool[:, :, i] for i, a in enumerate("xyz"))
        turn = np.array([u.get(f"turn_{a}", 0.0) for a in "xyz"]) + 0 * line
        return [part + u[f"zero_{a}"] for part, a in zip((off + ac.cross(turn, off) - line).T, "xyz", strict=True)]
