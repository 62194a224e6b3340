"""A headless LinuxCNC that runs programs, homes joints anew, and is sampled in every servo cycle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.linuxcnc.lab import Ending, Joint, Session
from tests.linuxcnc.running import ControlError


class WatchedSession(Session):
    """A LinuxCNC that also takes `run PROGRAM` and `home JOINT` among its lines."""

    driver = Path(__file__).with_name("watched_driver.py")

    def sample(self, codes: Sequence[str]) -> tuple[tuple[float, ...], ...]:
        """Execute lines and return what the loaded `sampler` took meanwhile, one row for each servo cycle."""
        result = self._ask({"sample": list(codes)})
        if result["overruns"]:
            raise ControlError(f"{result['overruns']} samples were lost", "Give sampler more depth")
        return tuple(tuple(row) for row in result["samples"])

    def written(self, name: str) -> str:
        """Return a file that LinuxCNC has written into the folder from which it was started."""
        return (self._work / name).read_text(encoding="utf-8")

    @property
    def process_id(self) -> int:
        """That of the first process of the run, in whose namespaces, or its child's, LinuxCNC is."""
        return self._process.pid


@dataclass(frozen=True, slots=True)
class Run:
    """A whole job: motor commands after homing, each move's end, and the messages to the operator."""

    start: tuple[float, ...]
    steps: tuple[Ending, ...]
    errors: tuple[str, ...]


def run(joints: Sequence[Joint], moves: Sequence[str], timeout: float = 60.0) -> Run:
    """Start LinuxCNC, make the moves (G-code lines), stop it; raises ControlError."""
    with Session(joints, timeout=timeout) as session:
        steps = session.move(moves)
        return Run(session.start, steps, session.errors)
