"""Places of readings, and their values.

>>> places = Places("laser", [["0 mm"], ["300 mm"]])
>>> len(places), places.poses.ravel()
(2, array([0. , 0.3]))
>>> Readings(places, [1.2e-6, "3.4 um"]).values
array([1.2e-06, 3.4e-06])
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, cast

import numpy as np

from axiscal_core.instrument import Instrument
from axiscal_core.normal import Normal
from axiscal_core.refusals import Array, InputError, finite, named, one, sided, whole
from axiscal_core.units import SECONDS, Poses, Quantity, as_given, quantities


class Showing(Protocol):
    """What says what a machine would show: a case."""

    @property
    def prior(self) -> Normal:
        """What is known of the unknowns before any reading."""

    def shows(self, places: Places, x: Array) -> Normal:
        """Return what readings show of unknowns x, with noise and rests."""


class Places:
    """Places of readings, in their order.

    instrument : its name, or itself; of each place where they differ
    poses : (m, q), in the order of the machine's axes; given : as they were, texts of which the case knows the axes
    sides : (m, q) from where each axis comes: +1, -1, 0 where it does not matter or nobody knows
    """

    def __init__(
        self, instrument: str | Instrument | Sequence[str | Instrument], poses: Poses, sides: Poses | None = None
    ) -> None:
        self.poses = quantities(poses, "Places", "poses", (None, None), posed=True)
        self.given = as_given(poses, self.poses)
        several = isinstance(instrument, Sequence) and not isinstance(instrument, str)
        each = [*cast("Sequence[str | Instrument]", instrument)] if several else [instrument] * len(self.poses)
        if len(each) != len(self.poses):
            what = f"has {len(each)} for {len(self.poses)} poses"
            raise InputError("Places", "instrument", what, "Give one, or one each")
        names = [who.name if isinstance(who, Instrument) else who for who in each]
        self.instruments = tuple(named("Places", "instrument", name) for name in names)
        self.sides = np.zeros_like(self.poses) if sides is None else sided("Places", sides, self.poses.shape)

    def __len__(self) -> int:
        return len(self.poses)

    def at(self, which: Sequence[int] | np.ndarray) -> Places:
        """Return some of them."""
        try:
            chosen = np.arange(len(self))[which if isinstance(which, np.ndarray) else [*which]]
        except (IndexError, TypeError):
            raise InputError("Places.at", "which", f"= {which!r} are not there", f"There are {len(self)}") from None
        return Places([self.instruments[i] for i in chosen], self.given[chosen], self.sides[chosen])

    def __add__(self, other: Places) -> Places:
        """Return these places, then others."""
        one("Places", "+", other, Places, "Places(instrument, poses)")
        finite("Places", "+", other.poses, (None, self.poses.shape[1]))
        both = (*self.instruments, *other.instruments)
        return Places(both, *(np.concatenate(pair) for pair in ((self.given, other.given), (self.sides, other.sides))))

    def __repr__(self) -> str:
        counts = ", ".join(f"{self.instruments.count(name)} of {name}" for name in dict.fromkeys(self.instruments))
        return f"<Places: {counts}>"


class Readings:
    """What was read.

    places : where; values : (n,) all numbers in their order, or (m, k); in m or rad, or texts
    std : (m,) noise of each reading where its own is known; time : (m,) s, when; one after another where not given
    """

    def __init__(
        self, places: Places, values: Sequence[Quantity] | Sequence[Sequence[Quantity]] | Array,
        std: Sequence[Quantity] | Array | None = None, time: Sequence[Quantity] | Array | None = None,
    ) -> None:  # fmt: skip
        one("Readings", "places", places, Places, "Places(instrument, poses)")
        shape = (len(places), None) if np.ndim(np.array(values, dtype=object)) == 2 else (None,)
        self.places, self.values = places, quantities(values, "Readings", "values", shape, posed=True).ravel()
        self.std = None if std is None else quantities(std, "Readings", "std", (len(places),), posed=True)
        self.given = as_given(values, self.values)
        self.given_std = None if self.std is None else as_given(std, self.std)
        if self.std is not None and (self.std <= 0).any():
            raise InputError("Readings", "std", "is not above zero", "Give m or rad", int(np.argmin(self.std)))
        each = (len(places),)
        self.time = None if time is None else quantities(time, "Readings", "time", each, [SECONDS], posed=True)

    @classmethod
    def simulated(cls, case: Showing, places: Places, seed: int, truth: Array | None = None) -> Readings:
        """Return what a machine would show that is drawn as the case believes machines to be.

        truth : (n,) the unknowns, where they are to be these
        """
        if not hasattr(case, "shows"):
            raise InputError("Readings.simulated", "case", f"= {case!r} is none", "Give Case(machine, instruments)")
        generator = np.random.default_rng(whole("Readings.simulated", "seed", seed, 0))
        like = case.prior.sample(1, seed)[0]
        x = like if truth is None else finite("Readings.simulated", "truth", truth, like.shape)
        shown = case.shows(places, x)
        root = np.linalg.cholesky(shown.covariance)
        return cls(places, shown.mean + root @ generator.standard_normal(len(root)))

    def __len__(self) -> int:
        return len(self.places)

    def __add__(self, other: Readings) -> Readings:
        """Return these readings, then others; both state std and time, or neither does."""
        one("Readings", "+", other, Readings, "Readings(places, values)")
        parts = []
        pairs = {"std": (self.given_std, other.given_std), "time": (self.time, other.time)}
        for what, (first, second) in pairs.items():
            if (first is None) != (second is None):
                raise InputError("Readings", what, "is stated of some and not of others", "State it of all, or of none")
            parts.append(None if first is None else np.concatenate([first, second]))
        return Readings(self.places + other.places, np.concatenate([self.given, other.given]), *parts)

    def __repr__(self) -> str:
        return f"<Readings: {len(self.values)} numbers at {self.places!r}>"
