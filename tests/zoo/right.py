"""Machines as they are described, beside what an oracle knows of them, and foreign ones under perfect instruments."""

from __future__ import annotations

from tests.zoo.animals import Animal, Job
from tests.zoo.axes import LASER, PERFECT, everywhere, read
from tests.zoo.curves import Foreign
from tests.zoo.oracle import STRAIN, Right, right

TARGETS = 12
"""Of one way: 24 readings."""
PLACES = ("planned", "even", "even, three odd", "random")
CONDITIONS: dict[str, tuple[Job, float]] = {"20 degC": (LASER.job, STRAIN), "as read": (PERFECT, 0.0)}
"""What the answer refers to: the job that says so, and how far off scales are, um per mm."""


def machine(condition: str, places: str, seed: int) -> Right:
    """Return a machine, read at places of a kind."""
    job, strain = CONDITIONS[condition]
    return right(seed, everywhere(TARGETS, 1, job)[places], strain)


def as_described(condition: str, places: str) -> Animal:
    """Return it as an animal."""
    job, _ = CONDITIONS[condition]
    name = f"as described, {condition}: {places}"
    return Animal(name, job, lambda seed: machine(condition, places, seed).met)


def foreign(truth: Foreign, places: str) -> Animal:
    """Return a foreign truth that perfect instruments read."""
    where = everywhere(TARGETS, 1, PERFECT)[places]
    return Animal(f"{truth.kind}: {places}", PERFECT, read(truth.curve, LASER, where, truth.beside), truth.cause)
