"""Places and readings of your own.

A case judges places that you name, and goes on after readings that are there. `plan(candidates=…)` takes your places
alone, `keep=…` reads them anyway, and `criterion=…` makes the variance of your own figures small. Readings are arrays
or a table such as a DataFrame. `case.known(mean, covariance)` makes curves and tables of a belief of your own.
"""

import numpy as np

import axiscal as ac

case = ac.Case(ac.load_machine("three-axis-mill"), [ac.Laser("laser", "X")])
line = ac.Places("laser", [[x, 0.2, 0.2] for x in np.linspace(0.05, 0.55, 6)])
print(f"six even places would leave {1e6 * case.evaluate(line).rms:.3g} um")
known = case.estimate(ac.Readings.simulated(case, line, seed=1))
more = case.plan(readings=4, after=known, keep=ac.Places("laser", [[0.3, 0.2, 0.2]]))
print(f"four more leave {1e6 * more.rms:.3g} um after {more.minutes:.1f} minutes")
print(f"the first stands at X = {1e3 * case.next(after=known).poses[0, 0]:.0f} mm")
known = known.read(ac.Readings.simulated(case, more.places, seed=1))
ends = known.deviation(line.poses[[0, -1]], joint=True).covariance
print(f"one end to the other: {1e6 * np.sqrt(ends[0, 0] + ends[3, 3] - 2 * ends[0, 3]):.3g} um")
middle = np.array([[float(name == "EXX[6]") for name in known.names]])
print(f"EXX[6] by a plan of its own: {1e6 * np.sqrt(case.plan(readings=4, criterion=middle).J):.3g} um")
picture = ac.plot(known)
