"""A camera on a printer sees a plate of known corners: how well six photographs know the squareness of X and Y."""

import numpy as np

import axiscal_core as ac


class Board(ac.Instrument):
    names, units, noise = ("px", "py"), ("m", "m"), "8 um"
    unknowns = {"x": "1 mm", "y": "1 mm", "turn": "2 mrad", "scale": "100 um/m"}

    def sees(self, at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
        x, y, _ = (at.tcp + at.moved).T
        return [(1 + u["scale"]) * x + u["turn"] * y + u["x"], (1 + u["scale"]) * y - u["turn"] * x + u["y"]]


axes = [ac.Axis.linear("Y", "y", (0, "0.3 m"), on_workpiece=True), ac.Axis.linear("X", "x", (0, "0.3 m"))]
errors = [ac.Error("EXX", "60 um"), ac.Error("EYY", "60 um"), ac.Error("C0Y", "2 mrad")]
case = ac.Case(ac.Machine(axes, errors), [Board("camera", "XY")], aligned=False)
square = np.eye(case.size)[[case.names.index("C0Y[0]")]]  # what the plan is to make small
print(f"C0Y to {1e6 * case.plan(readings=6, criterion=square).J ** 0.5:.0f} urad")
