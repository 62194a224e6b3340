"""`sim[:SEED]` and `truth:FILE`: a virtual machine, with errors drawn from the prior or given as curves."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from axiscal.campaign.sources.source import Answer, Request
from axiscal.measurement.setup import Setup

if TYPE_CHECKING:
    import numpy as np


class VirtualMachine(Protocol):
    """A machine with a hidden truth."""

    def read_all(
        self,
        setup: Setup,
        pose: tuple[float, ...],
        approach: tuple[int, ...],
        rng: np.random.Generator,
        seconds: float = 0.0,
    ) -> tuple[float, ...]:
        """Return what the set-up would show, in m or rad: truth, the set-up's own unknowns, and noise from `rng`.

        seconds : since the campaign began
        """


class Simulator(Protocol):
    """Makes virtual machines for one campaign."""

    def drawn(self, seed: int) -> VirtualMachine:
        """Return a machine whose errors are drawn from the prior."""

    def from_curves(self, path: Path, seed: int) -> VirtualMachine:
        """Return a machine whose errors are the curves of a file; raises InputError for a file that has none."""


class SimulatedSource:
    """A virtual machine as a source.

    The noise of a reading depends on its number only, so that a run that is resumed is the same run.
    """

    def __init__(self, machine: VirtualMachine, seed: int) -> None:
        self._machine, self._seed = machine, seed

    def read(self, request: Request) -> Answer:
        """Return the simulated reading."""
        import numpy as np

        rng = np.random.default_rng((self._seed, request.reading))
        value, *others = self._machine.read_all(request.setup, request.pose, request.approach, rng, request.seconds)
        return Answer(value, others=tuple(others))

    def close(self) -> None:
        """Nothing is held."""
