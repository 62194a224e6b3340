"""The protocol of a source: it answers questions for one reading at a time, or says why it cannot.

`sim[:SEED]` and `truth:FILE`: a virtual machine, with errors drawn from the prior or given as curves.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from axiscal.exceptions import SourceError
from axiscal.machine import Axis
from axiscal.measurement.reading import shown_approach, shown_pose
from axiscal.measurement.setup import Setup

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


@dataclass(frozen=True, slots=True)
class Request:
    """A reading that is wanted.

    reading : its number from 1; axes : of the machine, in chain order
    pose : (n_axes,) m or rad; approach : (n_axes,) +1, -1, or 0 where it does not matter
    seconds : of machine time since the campaign began, where somebody counts them
    """

    reading: int
    setup: Setup
    axes: tuple[Axis, ...]
    pose: tuple[float, ...]
    approach: tuple[int, ...]
    seconds: float = 0.0

    def message(self) -> dict[str, object]:
        """Return the request as the document that is sent to an `exec:` command: positions in mm and deg."""
        return {
            "reading": self.reading,
            "setup": self.setup.name,
            "instrument": self.setup.instrument,
            "direction": list(self.setup.direction),
            "position": shown_pose(self.axes, self.pose),
            "approach": shown_approach(self.axes, self.approach),
            "units": {axis.name: axis.unit for axis in self.axes},
        }


@dataclass(frozen=True, slots=True)
class Answer:
    """The reading: value in m or rad; its standard deviation likewise, or None for the set-up's noise.

    others : the values along y and z where an instrument reads three directions
    live : it was taken just now, so that the clock tells when; else the seconds of the plan do
    """

    value: float
    std: float | None = None
    others: tuple[float, ...] = ()
    live: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True)
class Skip:
    """The reading cannot be taken, and why."""

    reason: str


class Source(Protocol):
    """Something that takes readings. `read` raises SourceError when it cannot go on at all."""

    def read(self, request: Request) -> Answer | Skip:
        """Return the reading asked for."""

    def close(self) -> None:
        """Let go of whatever it holds; may be called twice."""


def at_the_terminal(text: str) -> str:
    """Ask on a line of its own and return what is typed; raises SourceError where nobody can answer."""
    sys.stderr.write("\n" * sys.stderr.isatty() + text)  # the line before shows how far the run is
    sys.stderr.flush()
    line = sys.stdin.readline()
    if not line:
        what = "the machine waits for a person, and nobody is there to answer"
        raise SourceError(what, "Give the command in a terminal, beside the machine")
    return line
