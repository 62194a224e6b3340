"""Types of virtual mills: what all machines of one share, how they differ together, and what is read of each.

A curve is a lead or a sag and a random curve of the stated smoothness, half of the variance each, so that no type is
drawn from the form that is learnt. Readings are first order, with their noise and a fresh rest.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.errors.term import Term
from axiscal.estimation.case import Case
from axiscal.estimation.data_equation import DataEquation, data_equation
from axiscal.machine import load_machine
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.ports.fleet.hierarchy import PriorUnits, prior_units
from axiscal_core.eigen import unique_root

NAME = "three-axis-mill"
_SETUP = """[[setups]]
name = "{kind} {axis}"
instrument = "{instrument}"
direction = "{axis}"
moves = ["X", "Y", "Z"]
noise = "{noise}"
approach = "both"
"""
_KINDS = ("length", "interferometer", "1 um"), ("angle", "level", "2 urad")
_DIRECTIONS, _LOAD = 3, 0.4
"""Directions in which sisters differ together, and how far: as in the trials of the method."""


@dataclass(frozen=True, slots=True)
class Form:
    """What a type is like.

    size : of its machines, as a factor on the stated std; common : share of the variance that all of them have
    """

    name: str
    size: float
    common: float


class Bench:
    """The machine as it is stated, six set-ups, and places that may be read, as rows.

    rows : (m, n) over errors and unknowns of set-ups; variances : (m,) noise and rest; owner : (m,) set-up of each
    root : (r, n) V of the volume, J = tr(V C Vᵀ)
    """

    def __init__(self, target: str) -> None:
        setups = "".join(
            _SETUP.format(kind=kind, axis=axis, instrument=instrument, noise=noise)
            for kind, instrument, noise in _KINDS
            for axis in "xyz"
        )
        text = f'machine = "{NAME}"\n[target]\nrms = "{target}"\n{setups}'
        self.case = Case(campaign_from_texts(text, "campaign.toml", load_machine(NAME).text, NAME))
        parts = [(index, *self.case.lattice.in_setup(index)) for index in range(len(self.case.description.setups))]
        seen = [self.case.observation.rows(*part) for part in parts]
        self.rows = np.concatenate([each.rows for each in seen])
        self.variances = np.concatenate([each.variances for each in seen])
        self.owner = np.concatenate([np.full(len(poses), index) for index, poses, _ in parts])
        whole = np.zeros((self.size, 1))  # one yardstick for every belief: all is seen, and no constant shift counts
        self.yardstick = replace(self.case.yardstick, zeroed=(True, True, True), unseen=whole)
        root = self.yardstick.root.matrix
        self.root = np.hstack([root, np.zeros((len(root), self.rows.shape[1] - self.size))])
        self._poses, self._sides = (np.concatenate([part[k] for part in parts]) for k in (1, 2))

    @property
    def size(self) -> int:
        """Number of unknowns of the machine."""
        return self.case.errors.size

    @cached_property
    def units(self) -> PriorUnits:
        """The units in which a type is learnt."""
        return prior_units(self.case.errors)

    def unknowns(self, errors: Array, rng: np.random.Generator) -> Array:
        """Return all unknowns of a campaign: the errors, and freshly mounted set-ups.  errors : (size,)"""
        own = np.sqrt(np.diagonal(self.case.prior.covariance)[self.size :])
        return np.concatenate([errors, own * rng.standard_normal(len(own))])

    def read(self, place: int, unknowns: Array, rng: np.random.Generator) -> float:
        """Return what is read at a place."""
        return float(self.rows[place] @ unknowns + np.sqrt(self.variances[place]) * rng.standard_normal())

    def equation(self, places: list[int], errors: Array, rng: np.random.Generator) -> DataEquation:
        """Return what the record of a machine says that was read at places.  errors : (size,)"""
        unknowns = self.unknowns(errors, rng)
        readings = [
            Reading(
                self.case.description.setups[self.owner[place]].name,
                tuple(self._poses[place].tolist()),
                tuple(int(side) for side in self._sides[place]),
                self.read(place, unknowns, rng),
            )
            for place in places
        ]
        return data_equation(self.case.observation, readings).in_units(self.units.root)


class VirtualType:
    """One type: the same for the same seed and, but for sizes and shares, in every form."""

    def __init__(self, bench: Bench, form: Form, seed: int) -> None:
        rng = np.random.default_rng((20, seed))
        self._seed, self._size = seed, bench.size
        self._factor = np.hstack([_factor(term, bench.size, rng) for term in bench.case.errors.terms])
        count = self._factor.shape[1]
        self.mean = form.size * np.sqrt(form.common) * self._factor @ rng.standard_normal(count)
        together = _LOAD * rng.standard_normal((count, _DIRECTIONS))
        spread = form.size * np.sqrt(1 - form.common) / np.sqrt(1 + np.sum(together**2, axis=1))
        self._own = self._factor @ (spread[:, None] * np.hstack([np.eye(count), together]))

    @property
    def own(self) -> Array:
        """Covariance of what its machines do not have in common, (size, size)."""
        covariance: Array = self._own @ self._own.T
        return covariance

    def machine(self, number: int) -> Array:
        """Return the errors of one of its machines, (size,)."""
        rng = np.random.default_rng((20, self._seed, number))
        errors: Array = self.mean + self._own @ rng.standard_normal(self._own.shape[1])
        return errors


def _factor(term: Term, size: int, rng: np.random.Generator) -> Array:
    """Return F (size, k) with the stated variance of an error: of a curve half is a lead or a sag, half is random."""
    free = unique_root(term.covariance)
    if term.kind != "motion":
        return _placed(free, term, size)
    along = np.linspace(-1, 1, len(free))
    shape = along if rng.random() < 0.5 else along**2 - np.mean(along**2)
    shape = shape * np.sqrt(np.trace(term.covariance) / np.sum(shape**2))
    return _placed(np.sqrt(0.5) * np.column_stack([shape, free]), term, size)


def _placed(block: Array, term: Term, size: int) -> Array:
    factor = np.zeros((size, block.shape[1]))
    factor[term.columns] = block
    return factor
