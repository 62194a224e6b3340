"""Who takes part, in the order of the table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Manner = Literal["one at a time", "of 2,000", "together"]


@dataclass(frozen=True, slots=True)
class Rival:
    """A library and what it is asked for.

    module, entry : the adapter and its function; environment : the folder in .venv-peers, ours if empty
    distributions : the packages whose versions are stated
    """

    key: str
    label: str
    manner: Manner
    module: str
    environment: str
    distributions: tuple[str, ...]
    entry: str = "picker"

    @property
    def together(self) -> bool:
        """Whether all readings are found in one call."""
        return self.entry == "planner"

    @property
    def ours(self) -> bool:
        """Whether it is axiscal."""
        return self.module == "ours"


_TRIESTE = ("trieste", "tensorflow", "gpflow")

FIELD = (
    Rival("axiscal", "axiscal", "one at a time", "ours", "", ("axiscal",)),
    Rival("trieste", "Trieste, integrated variance", "one at a time", "trieste", "trieste", _TRIESTE),
    Rival("trieste-fewest", "Trieste, over fewest places", "one at a time", "trieste", "trieste", (), "fewest_picker"),
    Rival("botorch", "BoTorch, integrated variance", "one at a time", "botorch", "torch", ("botorch", "torch")),
    Rival("emukit", "Emukit, integrated variance", "one at a time", "emukit", "others", ("emukit", "GPy")),
    Rival("numpy", "NumPy, 100,000 random candidates", "one at a time", "random_candidates", "", ("numpy",)),
    Rival("axiscal-candidates", "axiscal", "of 2,000", "ours", "", (), "candidate_picker"),
    Rival("pyapprox", "pyapprox, integrated variance", "of 2,000", "pyapprox", "torch", ("pyapprox",)),
    Rival("axiscal-together", "axiscal", "together", "ours", "", (), "planner"),
    Rival("trieste-together", "Trieste, a joint batch", "together", "trieste", "trieste", (), "planner"),
    Rival("pyoptex", "pyoptex, coordinate exchange", "together", "pyoptex", "others", ("pyoptex",), "planner"),
    Rival("figaroh", "FIGAROH, D-optimal exchange", "together", "figaroh", "others", ("figaroh",), "planner"),
)


def rival_of(key: str) -> Rival:
    """Return who takes part under a key."""
    return next(rival for rival in FIELD if rival.key == key)
