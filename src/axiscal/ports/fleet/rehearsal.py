"""A type rehearsed: virtual sisters with the stated share in common, measured as a campaign plans, each in a record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription
from axiscal.errors.model import ErrorModel
from axiscal.estimation.case import Case
from axiscal.exceptions import RecordError, TargetError
from axiscal.language.stages import staged
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.numerics import Array
from axiscal.planning.next_readings import placed
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal.ports.fleet.sisters.hierarchy import prior_units

_DIRECTIONS, _LOAD = 3, 0.4
"""Directions in which virtual sisters differ together, and how far: as in the trials of the method."""


@dataclass(frozen=True, slots=True)
class Imagined:
    """A type as it is imagined.

    size : of the machines, as a factor on the stated std; common : share of the variance that all of them have
    """

    size: float = 1.0
    common: float = 2 / 3


class VirtualType:
    """Draws machines of one imagined type: the same type for the same seed."""

    def __init__(self, described: CampaignDescription, imagined: Imagined, seed: int) -> None:
        self._described, self._imagined, self._seed = described, imagined, seed
        self._units = prior_units(ErrorModel(described.machine))
        rng = np.random.default_rng((seed, 4))
        count = self._units.root.shape[1]
        self._common = imagined.size * np.sqrt(imagined.common) * rng.standard_normal(count)
        self._together = _LOAD * rng.standard_normal((count, _DIRECTIONS))

    def machine(self, number: int) -> tuple[VirtualMachine, Array]:
        """Return one of its machines, and the control values of its errors, (n,)."""
        rng = np.random.default_rng((self._seed, 5, number))
        along = self._together @ rng.standard_normal(_DIRECTIONS)
        free = rng.standard_normal(len(self._common))
        own = (along + free) / np.sqrt(1 + np.sum(self._together**2, axis=1))
        scale = self._imagined.size * np.sqrt(1 - self._imagined.common)
        errors: Array = self._units.root @ (self._common + scale * own)
        simulator = Simulator(self._described.machine, self._described.setups)
        return simulator.with_coefficients(errors, self._seed * 1000 + number), errors


def planned_places(described: CampaignDescription) -> tuple[Place, ...]:
    """Return where a campaign reads by its stated prior; raises TargetError where nothing ends it, PlanError."""
    case, target = Case(replace(described, prior_text="", sisters=None)), described.target
    if target.empty:
        raise TargetError("nothing would ever end this plan", 'Give the campaign a target, such as rms = "4 um"')
    return placed(case, proposed(case, Limits.of(target)).plan)


def measured(
    virtual: VirtualMachine, described: CampaignDescription, places: Sequence[Place], seed: int
) -> list[Reading]:
    """Return what is read of a virtual machine at places, one after another, as its zeros wander meanwhile."""
    rng, found = np.random.default_rng((seed, 6)), list[Reading]()
    ends = np.cumsum(Case(described).seconds_along(None, places)).tolist()
    for place, seconds in zip(places, ends, strict=True):
        value, *others = virtual.read_all(described.setup(place.setup), place.pose, place.approach, rng, seconds)
        found.append(Reading(place.setup, place.pose, place.approach, value, others=tuple(others), time=seconds))
    return found


def rehearsed(
    described: CampaignDescription,
    imagined: Imagined,
    count: int,
    folder: Path,
    seed: int,
) -> list[Path]:
    """Write the records of so many virtual sisters into a folder, and return them; raises RecordError, TargetError."""
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / f"sister-{number:02}.axiscal" for number in range(1, count + 1)]
    if there := [file for file in files if file.exists()]:
        raise RecordError("This record exists already", "Name another folder, or remove it", there[0])
    virtual, places = VirtualType(described, imagined, seed), planned_places(described)
    for number, file in enumerate(staged("sisters", files, count), start=1):
        machine, _ = virtual.machine(number)
        with Campaign.create(file, described) as campaign:
            campaign.adopt(tuple(measured(machine, described, places, seed * 1000 + number)))
            campaign.finish("rehearsed")
    return files
