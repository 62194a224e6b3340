"""A six-axis robot by Denavit-Hartenberg parameters, read by a tracker: planned poses beside as many even ones."""

import numpy as np

import axiscal_core as ac

r = np.pi / 2
links = [(0.1, r, 0.4, 0), (0.7, 0, 0, r), (0.1, r, 0, 0), (0, -r, 0.7, 0), (0, r, 0, 0), (0, 0, 0.1, 0)]
std = {"a": "0.3 mm", "alpha": "0.3 mrad", "d": "0.3 mm", "theta": "1 mrad"}
robot = ac.Machine.from_dh(links, std, tool=("50 mm", "0 mm", "150 mm"))
own = dict(ac.Tracker.unknowns) | dict.fromkeys(("tool_x", "tool_y", "tool_z"), 0.0)  # the reflector is the tool
joints = [f"J{i}" for i in range(1, 7)]
tracker = ac.Tracker("tracker", joints, ("3 m", "0 m", "1 m"), noise="30 um", unknowns=own, approach="+")
case = ac.Case(robot, [tracker], usual="off", sure="exactly")
planned, even = case.plan(readings=10, candidates=200), case.evaluate(case.lattice(10))
print(f"left over the travel: {1e6 * planned.rms:.0f} um planned, {1e6 * even.rms:.0f} um even")
