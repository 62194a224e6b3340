"""Instruments as somebody would write them who has read the package's page and not its source: twelve lines at most."""

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


class Grid(ac.Instrument):
    names, units, noise = ("dx", "dy"), ("m", "m"), "0.1 um"
    unknowns = {"zero_x": "1 mm", "zero_y": "1 mm", "turn": "1 mrad"}

    def sees(self, at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
        x, y, _ = (at.tcp + at.moved).T
        return [at.moved[:, 0] + u["zero_x"] - u["turn"] * y, at.moved[:, 1] + u["zero_y"] + u["turn"] * x]


class Warm(ac.Laser):
    """A laser whose scale is warmer than anybody knows, by a kelvin or so."""

    type_b = {"warmer": 1.0}

    def sees(self, at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
        return [super().sees(at, u)[0] - 11.7e-6 * u["warmer"] * (at.poses[:, 0] - 0.2)]


def mill(**options: str) -> ac.Case:
    """Return two axes of 400 mm and a reversal, with two lasers and a level."""
    axes = [ac.Axis.linear(name, name.lower(), (0, "400 mm")) for name in "XY"]
    errors = [ac.Error(f"E{c}{name}", 8e-6, length="150 mm") for name in "XY" for c in "XYC"]
    errors += [ac.Error("C0Y", "30 urad"), ac.Error("EXX_reversal", "4 um")]
    lasers = [ac.Laser("x", "X", along="x"), ac.Laser("y", "Y", along="y"), ac.Level("c", "X", about="z")]
    return ac.Case(ac.Machine(axes, errors), lasers, **options)  # type: ignore[arg-type]
