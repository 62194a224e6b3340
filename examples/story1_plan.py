"""A five-axis plan from two instruments.

Instruments take noise, unknowns and times that are usual for their kind. A text carries its unit.
"""

import axiscal as ac

machine = ac.load_machine("dmu60")
tracker = ac.Tracker("tracker", "BCXYZ", station=["900 mm", "0 mm", "-300 mm"], setup_time="30 min")
table = ac.Level("polygon on the table", "C", about="z", setup_time="20 min")
case = ac.Case(machine, [tracker, table])
plan = case.plan(readings=6, candidates=100)
print(f"{len(plan)} readings, {plan.minutes:.0f} minutes: known to {1e6 * plan.rms:.3g} um")
print("first place:", plan.places.instruments[0], plan.places.poses[0].round(3))
known = case.estimate(ac.Readings.simulated(case, plan.places, seed=1))
print(f"on a machine that is made up they leave U = {1e6 * known.U:.3g} um")
picture = ac.plot(known)
