"""Virtual machines of one type, each measured as a campaign plans, to see beforehand what sisters teach.

python examples/virtual_sisters.py campaign.toml --machines 12 --size 0.5 --out records
axiscal shop type learn records --out virtual.type.json
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import repeat
from pathlib import Path

import numpy as np

import axiscal as ac
from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.case import Case, ends_along
from axiscal.exceptions import InputError, RecordError
from axiscal.measurement.simulation import VirtualMachine
from axiscal.numerics import Array
from axiscal.planning.next_readings import placed
from axiscal.ports.fleet.hierarchy import prior_units
from axiscal.ports.fleet.type_learning import planned

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
        self._units = prior_units(ac.ErrorModel(described.machine))
        rng = np.random.default_rng((seed, 4))
        count = self._units.root.shape[1]
        self._common = imagined.size * np.sqrt(imagined.common) * rng.standard_normal(count)
        self._together = _LOAD * rng.standard_normal((count, _DIRECTIONS))

    def drawn(self, number: int) -> tuple[VirtualMachine, Array]:
        """Return one of its machines, and the control values of its errors, (n,)."""
        rng = np.random.default_rng((self._seed, 5, number))
        along = self._together @ rng.standard_normal(_DIRECTIONS)
        free = rng.standard_normal(len(self._common))
        own = (along + free) / np.sqrt(1 + np.sum(self._together**2, axis=1))
        scale = self._imagined.size * np.sqrt(1 - self._imagined.common)
        errors: Array = self._units.root @ (self._common + scale * own)
        simulator = ac.Simulator(self._described.machine, self._described.setups)
        return simulator.with_coefficients(errors, self._seed * 1000 + number), errors


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
    virtual, case = VirtualType(described, imagined, seed), Case(replace(described, prior_text="", sisters=None))
    places = placed(case, planned(case))
    ends = ends_along(case, places)
    for number, file in enumerate(files, start=1):
        machine, _ = virtual.drawn(number)
        with ac.Campaign.create(file, described) as campaign:
            chance = repeat(np.random.default_rng((seed * 1000 + number, 6)))
            campaign.adopt(machine.measured(described.setups, places, ends, chance))
            campaign.finish("rehearsed")
    return files


def main(words: Sequence[str]) -> None:
    """Write the records."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("campaign", type=Path)
    parser.add_argument("--machines", type=int, default=12)
    parser.add_argument("--size", type=float, default=1.0, help="how large they are, times the stated std")
    parser.add_argument("--common", type=float, default=0.67, help="share of the variance that all have in common")
    parser.add_argument("--seed", type=int, default=1, help="another type for another seed")
    parser.add_argument("--out", type=Path, default=Path("records"))
    asked = parser.parse_args(words)
    imagined = Imagined(asked.size, asked.common)
    files = rehearsed(ac.read_campaign(asked.campaign), imagined, asked.machines, asked.out, asked.seed)
    print(f"{len(files)} records in {asked.out}. Learn from them: axiscal shop type learn {asked.out}")


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except InputError as wrong:
        sys.exit(str(wrong))
