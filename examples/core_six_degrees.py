"""A six-degree laser: each shot gives displacement, two straightnesses, pitch, yaw and roll. It finds a pitch error."""

import axiscal_core as ac

ZEROS = ("zx", "zy", "zz", "za", "zb", "zc")


class SixDegrees(ac.Instrument):
    names, units = ("x", "y", "z", "a", "b", "c"), ("m",) * 3 + ("rad",) * 3
    noise, unknowns = ("0.5 um",) * 3 + ("1 urad",) * 3, dict.fromkeys(ZEROS, 1e-3)

    def sees(self, at: ac.At, u: ac.Unknowns) -> list[ac.Array]:
        return [part + u[zero] for part, zero in zip([*at.moved.T, *at.turned.T], ZEROS, strict=True)]


errors = [ac.Error(f"E{c}X", "10 um" if c in "XYZ" else "20 urad", length="200 mm") for c in "XYZABC"]
case = ac.Case(ac.Machine([ac.Axis.linear("X", "x", (0, "1 m"))], errors), [SixDegrees("laser", "X")])
known = case.estimate(ac.Readings.simulated(case, case.plan(readings=6).places, seed=4))
pitch = known["EBX"]([0.2, 0.8]).mean
print(f"pitch changes by {1e6 * (pitch[1] - pitch[0]):.1f} urad")
