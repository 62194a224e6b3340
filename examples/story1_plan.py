"""A five-axis plan from two set-ups made in Python.

The set-ups take noise, unknowns and times that are usual for their instruments.
"""

import axiscal as ac

machine = ac.load_machine("dmu60")
tracker = ac.setup("tracker", station=["900 mm", "0 mm", "-300 mm"])
table = ac.setup("autocollimator", "z", moves=["C"], name="polygon on the table")
plan = ac.Case(machine, [tracker, table]).plan(readings=6, candidates=100)
print(f"{len(plan)} readings, {plan.minutes:.0f} minutes: known to {1e6 * plan.rms:.3g} um")
print("no plan of as many readings can beat this (m):", plan.bound)
print("first place:", plan.places[0])
picture = plan.plot()
