"""A delta printer: towers and rods are an error of one's own, read by a probe in the nozzle on the bed."""

import numpy as np

import axiscal_core as ac


class Towers:
    name, frame, rod = "towers", "tool", 0.25  # carriages too high, rods too long, towers too far out, m
    out = np.array([[np.cos(a), np.sin(a)] for a in np.radians([210, 330, 90])])

    def rows(self, poses: ac.Array) -> ac.Array:
        away = poses[:, None, :2] - 0.12 * self.out  # from each tower to the nozzle
        up = np.sqrt(self.rod**2 - np.sum(away**2, axis=2))[:, :, None]
        moved = [-up * np.eye(3), self.rod * (0 * up + np.eye(3)), np.sum(away * self.out, axis=2)[:, :, None]]
        shift = np.linalg.solve(np.concatenate([away, -up], axis=2), np.concatenate(moved, axis=2))
        return np.concatenate([shift, np.zeros_like(shift)], axis=1)

    def covariance(self) -> ac.Array:
        return np.diag([1e-3] * 3 + [0.3e-3] * 3 + [0.5e-3]) ** 2


axes = [ac.Axis.linear(name, name.lower(), ("-80 mm", "80 mm")) for name in "XYZ"]
probe = ac.Laser("probe", "XY", along="z", noise="10 um", unknowns={"zero": 0.0}, park={"Z": "-80 mm"}, approach="+")
case = ac.Case(ac.Machine(axes, [Towers()]), [probe])
print(f"left over the volume: {1e6 * case.plan(readings=10, candidates=100).rms:.0f} um")
