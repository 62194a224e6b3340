"""Golden campaigns as cases of the core, with instruments that a stranger wrote.

What two axes usually do together has a size of its own in the product and is left out of both.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

import axiscal_core as ac
from axiscal.description.campaign import CampaignDescription, read_campaign
from axiscal.description.placed_readings import placed_readings
from axiscal.estimation.case import Case, timed
from axiscal.estimation.estimate import posed
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal_core.machine import Machine
from axiscal_core.numbers import Numbers
from axiscal_core.theta import Sizes
from axiscal_core.usual import ROUGH
from tests.core.strangers import Arm, Autocollimator, Bar, Interferometer, Probe, Straightedge

CAMPAIGNS = Path(__file__).parents[1] / "golden" / "campaigns"
READ = {
    "ball_bar": "readings.csv", "drift": "readings.csv", "learnt": "equally-spaced.csv", "nonlinear": "readings.csv",
    "outlier": "readings.csv", "rotary": "readings.csv", "tracker": "readings.csv", "vcomp": "readings.csv",
    "xyzac": "readings.csv",
}  # fmt: skip
"""Campaigns of which readings are kept, in which file."""
CLASSES: dict[str, type[ac.Instrument]] = {
    "interferometer": Interferometer, "indicator": Probe, "probe": Probe, "straightedge": Straightedge,
    "autocollimator": Autocollimator, "level": Autocollimator, "ballbar": Bar, "tracer": Bar, "tracker": Arm,
}  # fmt: skip


def described(name: str) -> CampaignDescription:
    """Return a golden campaign without what two axes usually do together."""
    found = read_campaign(CAMPAIGNS / name / "campaign.toml")
    stated = tuple(each for each in found.machine.stated if not each.usual)
    return replace(found, machine=replace(found.machine, errors=stated))


@dataclass(frozen=True)
class Beside:
    """One case in the product and in the core."""

    description: CampaignDescription

    @cached_property
    def product(self) -> Case:
        """Of the product."""
        return Case(self.description)

    @cached_property
    def core(self) -> ac.Case:
        """Of the core."""
        found = self.description
        instruments = [instrument_of(setup, found.machine) for setup in found.setups]
        return ac.Case(machine_of(found.machine), instruments, sure=found.sure)

    def readings(self, file: str) -> list[Reading]:
        """Return readings that are kept, with the time of each."""
        machine, setups = self.description.machine, self.description.setups
        raw = read_any(CAMPAIGNS / file, machine.axes, setups)
        return [*timed(self.product, placed_readings(raw, self.description, CAMPAIGNS / file)).readings]

    def places(self, readings: Sequence[Reading]) -> ac.Places:
        """Return where readings were taken, for the core."""
        names, poses, sides = zip(*((r.setup, r.pose, r.approach) for r in readings), strict=True)
        return ac.Places(names, np.array(poses), np.array(sides, dtype=float))

    def own(self, readings: Sequence[Reading]) -> ac.Readings:
        """Return readings for the core."""
        values = np.concatenate([reading.values for reading in readings])
        return ac.Readings(self.places(readings), values, time=[float(r.time or 0.0) for r in readings])

    def drawn(self, count: int, setup: Setup, seed: int = 0) -> list[Reading]:
        """Return readings of zero at random places of a set-up."""
        generator, found = np.random.default_rng(seed), []
        axes = self.description.machine.axes
        for i in range(count):
            pose = [float(generator.uniform(*axis.travel)) for axis in axes]
            side = [int(each) for each in generator.choice([-1, 1], len(axes))]
            others = (0.0,) * (len(CLASSES[setup.instrument].names) - 1)
            found.append(Reading(setup.name, tuple(pose), tuple(side), 0.0, others=others, time=12.0 * i))
        return found

    def space(self, readings: Sequence[Reading]) -> Numbers:
        """Return readings in the product's room of numbers."""
        return Numbers(posed(self.product, readings))

    def theta(self, mine: Array) -> Array:
        """Return the core's θ in the order of the product's sizes.  mine : (k,)"""
        theirs: Sizes = self.product.sizes
        at: dict[tuple[str, tuple[str, ...]], int] = {
            (size.kind, size.owners): i for i, size in enumerate(self.core.sizes.of)
        }
        assert set(at) == {(size.kind, size.owners) for size in theirs.of}
        return np.array([mine[at[size.kind, size.owners]] for size in theirs.of])


def machine_of(machine: ac.Machine) -> ac.Machine:
    """Return a machine for a case of the core, without the rough part of a rest, which the core adds itself."""
    return replace(machine, errors=tuple(_bare(each) for each in machine.stated))


def _bare(error: ac.Error) -> ac.Error:
    if error.rest is None or error.sides or error.kind != "motion" or error.repeats or error.count < 2:
        return error
    return replace(error, rest=float(np.sqrt(max(error.rest**2 - (ROUGH.size * error.std) ** 2, 0.0))))


def instrument_of(setup: Setup, machine: Machine) -> ac.Instrument:
    """Return a set-up as a stranger's instrument."""
    axes = machine.axes
    park = {axes[k].name: place for k, place in enumerate(setup.park) if k not in setup.moves}
    made = CLASSES[setup.instrument](
        setup.name, [axes[k].name for k in setup.moves], noise=setup.noise, park=park, approach=setup.approach,
        unknowns={unknown.name: unknown.std for unknown in setup.unknowns}, drift=setup.drift,
    )  # fmt: skip
    match made:
        case Interferometer() | Probe():
            made.along = setup.direction
        case Straightedge():
            made.along, made.axis = setup.direction, setup.moves[0]
            made.middle = sum(axes[setup.moves[0]].travel) / 2
        case Autocollimator():
            made.about = setup.direction
        case Bar() | Arm():
            made.station = setup.station
    return made
