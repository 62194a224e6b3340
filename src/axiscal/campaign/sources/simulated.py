"""`sim[:SEED]` and `truth:FILE`: a virtual machine, with errors drawn from the prior or given as curves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from axiscal.campaign.sources.source import Answer, Request

if TYPE_CHECKING:
    from axiscal.measurement.simulation import VirtualMachine


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
