"""What a campaign asks of the mathematics: believe a reading, say how well the machine is known, propose the next."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Protocol

from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.record.events import Gap

if TYPE_CHECKING:
    from axiscal.description.campaign import CampaignDescription


class Known(Protocol):
    """How well the machine is known: standard deviations of the TCP, m."""

    @property
    def rms(self) -> float:
        """RMS over the volume."""

    @property
    def worst(self) -> float:
        """The largest in the volume."""

    @property
    def seen(self) -> float:
        """RMS without what no allowed reading can see."""

    @property
    def worst_seen(self) -> float:
        """The largest without what no allowed reading can see."""

    def attainable(self, target: float) -> float:
        """Return the target that readings can be held to, whatever no spline follows."""


class Engine(Protocol):
    """The belief of one campaign and the planner that looks at it. It is fed the readings in their order."""

    def absorb(self, reading: Reading) -> None:
        """Take a reading into the belief."""

    def accuracy(self) -> Known:
        """Return how well the machine is known now."""

    def misfit(self) -> float:
        """Return how many times as much as the model says the readings scatter about their predictions."""

    def objection(self) -> str | None:
        """Return why the last reading cannot be, in words; None where it can."""

    def grounds(self) -> str:
        """Return what a plan made now rests on beside where the readings were taken, in words; empty for nothing.

        As long as it stays the same, readings that are taken where they were planned change nothing in the plan.
        """

    def plan(self, gaps: Sequence[Gap], taken: Sequence[Place], left: Sequence[Place]) -> Sequence[Place]:
        """Return the readings to come, none of the `gaps`, after those taken; none if nothing is left to measure.

        left : of an earlier plan, to begin with
        """

    def elapsed(self, taken: Sequence[Place]) -> float:
        """Return the seconds that readings at these places take in this order: mounting, travel, settling, reading."""


Build = Callable[["CampaignDescription"], Engine]
"""Makes the engine of a campaign, before its first reading."""
