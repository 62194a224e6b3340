"""A file of readings to curves with bands.

Every error of the machine becomes a curve with its band; the deviation of the tool point and the tables follow.
`known.report(folder)` writes report.pdf.
"""

import tempfile

import axiscal as ac

machine = ac.load_machine("three-axis-mill")
case = ac.Case(machine, [ac.setup("interferometer", "x", moves=["X"], name="laser along X", approach="both")])
known = ac.estimate(case, "examples/readings.csv")
mean, std = known["EXX"]([0.1, 0.3, 0.5])
print(f"EXX at 100, 300 and 500 mm: {1e6 * mean} ± {1e6 * std} um")
mean, std = known.deviation({"X": "300 mm", "Y": "100 mm", "Z": "100 mm"})
print(f"the tool point there: {1e6 * mean[0]} ± {1e6 * std[0]} um")
files = known.export("linuxcnc", tempfile.mkdtemp())
print("tables:", ", ".join(file.name for file in files))
picture = known.plot()
