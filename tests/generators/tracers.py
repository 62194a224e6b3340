"""Stations that nobody knows: four tracers on a three-axis machine, stated as far off as the row says."""

import re

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator, VirtualMachine

STATIONS = (("-900", "-700", "-500"), ("900", "-600", "-100"), ("-200", "900", "-600"), ("100", "100", "700"))
_POINTS = 45


def tracers(std: str, dead_path: str) -> Case:
    """Return the three-axis mill with few knots, and four tracers.  std : of each coordinate of a station"""
    text = re.sub(r", rest = [^}]*", " ", re.sub(r"knots = \d+", "knots = 4", load_machine("three-axis-mill").text))
    setups = [
        f"""[[setups]]
name = "tracer {number}"
instrument = "tracer"
station = [{", ".join(f'"{each} mm"' for each in station)}]
approach = "both"
[setups.unknowns]
zero = "{dead_path}"
station_x = "{std}"
station_y = "{std}"
station_z = "{std}"
"""
        for number, station in enumerate(STATIONS, 1)
    ]
    head = 'machine = "m"\n[target]\nreadings = 1\n'
    return Case(campaign_from_texts(head + "".join(setups), "c.toml", text, "m"))


def at_once(std: str, dead_path: str) -> Case:
    """Return the same machine with all four tracers in one set-up."""
    places = ", ".join("[" + ", ".join(f'"{each} mm"' for each in station) + "]" for station in STATIONS)
    known = ", ".join(f'station_{axis} = "{std}"' for axis in "xyz")
    setup = f'[[setups]]\nname = "beams"\ninstrument = "tracer"\nstations = [{places}]\napproach = "both"\n'
    text = f'machine = "m"\n[target]\nreadings = 1\n{setup}unknowns = {{ zero = "{dead_path}", {known} }}\n'
    return Case(campaign_from_texts(text, "c.toml", tracers(std, dead_path).description.machine.text, "m"))


def read(case: Case, seed: int) -> tuple[VirtualMachine, list[Reading]]:
    """Return a machine with stations drawn from the prior, and readings at random poses."""
    rng = np.random.default_rng(seed)
    machine = Simulator(case.description.machine, case.description.setups).drawn(seed)
    low, high = np.array([axis.travel for axis in case.description.machine.axes]).T
    readings = []
    for setup in case.description.setups:
        for _ in range(_POINTS):
            pose, side = tuple(rng.uniform(low, high).tolist()), tuple(int(s) for s in rng.choice([-1, 1], len(low)))
            readings.append(Reading(setup.name, pose, side, machine.read_all(setup, pose, side, rng)[0], time=0.0))
    return machine, readings
