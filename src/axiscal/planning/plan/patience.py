"""How long a search may go on: by the work that it has done, never by the clock.

A clock would make another plan on a slower or a loaded machine.
"""

from __future__ import annotations

PATIENCE = 4e11
"""Operations that climbing off the lattice may take unless said otherwise: a minute or two."""
_LOOKS = 400
"""Places at which a climb looks, roughly: stencils around five places, then lines."""
_CALLS = 2e7
"""Operations that a climb's calls into numpy are worth, however few unknowns there are."""


class Patience:
    """How much work is left, in floating point operations."""

    def __init__(self, work: float) -> None:
        self._left = work

    @property
    def spent(self) -> bool:
        """Whether there is none left."""
        return self._left <= 0

    def take(self, work: float) -> None:
        """Take off what has been done."""
        self._left -= work


def work_of_climb(size: int, seen: int) -> float:
    """Return the operations that one climb takes, roughly: rows (size,) times [F, C Vᵀ] of `seen` columns."""
    return _CALLS + 2.0 * _LOOKS * size * seen
