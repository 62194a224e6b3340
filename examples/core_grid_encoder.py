"""A grid encoder, two lengths in the plane of a plate, on a table of two axes: how well ten readings know it."""

import axiscal_core as ac


class Grid(ac.Instrument):
    names, units, noise = ("dx", "dy"), ("m", "m"), "0.1 um"
    unknowns = {"zero_x": "1 mm", "zero_y": "1 mm", "turn": "1 mrad"}

    def sees(self, at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
        x, y, _ = (at.tcp + at.moved).T
        return [at.moved[:, 0] + u["zero_x"] - u["turn"] * y, at.moved[:, 1] + u["zero_y"] + u["turn"] * x]


axes = [ac.Axis.linear(name, name.lower(), (0, "400 mm")) for name in "XY"]
errors = [ac.Error(f"E{c}{name}", "8 um", length="150 mm") for name in "XY" for c in "XY"]
case = ac.Case(ac.Machine(axes, [*errors, ac.Error("C0Y", "50 urad")]), [Grid("grid", "XY")])
print(f"{1e6 * case.plan(readings=10).rms:.2f} um")
