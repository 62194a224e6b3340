"""A reading that is asked for of a small machine, and the machine that sources simulate."""

import math

from axiscal.campaign.sources.source import Request
from axiscal.machine.axis import iso_axis
from axiscal.measurement.instruments.displacement import Interferometer
from axiscal.measurement.simulation import Simulator
from axiscal_core.errors import Error
from axiscal_core.machine import Machine

AXES = (iso_axis("X", True, (0.0, 0.6)), iso_axis("C", True, (0.0, math.tau)))
MACHINE = Machine(AXES, (Error("EXX", 1e-5, knots=4),), 0.0, name="table")
SETUP = Interferometer("laser along X", MACHINE, (1, 0, 0), (0,), (0.3, 0), 1e-6, (), 60, 1, 3, (0, 0), "both")
REQUEST = Request(7, SETUP, AXES, (0.12, math.radians(30)), (1, 0))
SIMULATOR = Simulator(MACHINE, (SETUP,))
