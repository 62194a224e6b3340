"""Whose an unknown is: that of one set-up, or of an artefact, a bar or a tool which several set-ups share.

What has an owner is one quantity wherever it is met: all set-ups that read the same ball share the column of its place.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.artefact import Artefact
from axiscal.measurement.setup import Setup, Unknown

Key = tuple[str, str]
"""Owner and name; the owner of what belongs to one set-up is that set-up."""


@dataclass(frozen=True, eq=False, slots=True)
class Owned:
    """The unknowns beside the machine's errors.

    unknowns : each of them once, in the order in which set-ups name them; columns : per set-up, where its own stand
    """

    unknowns: tuple[Unknown, ...]
    columns: tuple[NDArray[np.intp], ...]

    @classmethod
    def by(cls, setups: Sequence[Setup]) -> Owned:
        """Return the unknowns of all set-ups, shared ones once."""
        found: dict[Key, tuple[int, Unknown]] = {}
        columns = []
        for number, setup in enumerate(setups):
            keys = [key_of(number, unknown) for unknown in setup.unknowns]
            for key, unknown in zip(keys, setup.unknowns, strict=True):
                found.setdefault(key, (len(found), unknown))
            columns.append(np.array([found[key][0] for key in keys], dtype=np.intp))
        return cls(tuple(unknown for _, unknown in found.values()), tuple(columns))


def key_of(number: int, unknown: Unknown) -> Key:
    """Return what an unknown of the number-th set-up is known by."""
    return unknown.owner or f"set-up {number}", unknown.name


def unknowns_at(artefact: Artefact, balls: tuple[int, ...]) -> tuple[Unknown, ...]:
    """Return what set-ups at some balls of an artefact leave open of where these are."""
    each = [(artefact.balls[i].name, axis) for i in balls for axis in "xyz"]
    if artefact.calibrated is None:
        return tuple(Unknown(f"{ball}_{axis}", artefact.placed, artefact.standing) for ball, axis in each)
    whole = [Unknown(f"place_{axis}", artefact.placed, artefact.standing) for axis in "xyz"]
    whole += [Unknown(f"turn_{axis}", artefact.turned, artefact.standing) for axis in "xyz"]
    whole += [Unknown("scale", artefact.scale, artefact.name)] if artefact.scale > 0 else []
    return (*whole, *(Unknown(f"{ball}_{axis}", artefact.calibrated, artefact.name) for ball, axis in each))
