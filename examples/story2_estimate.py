"""A file of readings to curves with bands.

Every error of the machine becomes a curve with its band; the deviation of the tool point and the tables follow.
`ac.report(known, folder)` writes report.pdf, `known.save("known.json")` keeps all of it.
"""

import csv
import tempfile

import axiscal as ac

with open("examples/readings.csv", encoding="utf-8") as file:
    rows = [*csv.DictReader(file)]
poses = [[f"{row['X_mm']} mm", "200 mm", "200 mm"] for row in rows]
sides = [[1.0 if row["approach"] == "X+" else -1.0, 0.0, 0.0] for row in rows]
readings = ac.Readings(ac.Places("laser", poses, sides), [f"{row['value_um']} um" for row in rows])
known = ac.Case(ac.load_machine("three-axis-mill"), [ac.Laser("laser", "X")]).estimate(readings)
found = known["EXX"]([0.1, 0.3, 0.5])
print(f"EXX at 100, 300 and 500 mm: {1e6 * found.mean} ± {1e6 * found.std} um")
point = known.deviation([["300 mm", "100 mm", "100 mm"]])
print(f"the tool point there: {1e6 * point.mean[0]} ± {1e6 * point.std[0]} um")
files = ac.export(known, "linuxcnc", tempfile.mkdtemp())
print("tables:", ", ".join(file.name for file in files))
picture = ac.plot(known)
