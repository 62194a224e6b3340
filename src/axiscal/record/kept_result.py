"""What a campaign came to, as its last event keeps it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class KeptResult:
    """What the readings of a campaign came to.

    rms, expanded : RMS standard uncertainty over the volume and U, m, None where none is promised
    agreement : whether the readings "agree" or "contradict" each other; "" where nobody has said
    """

    rms: float | None = None
    expanded: float | None = None
    agreement: str = ""


NOT_SAID = KeptResult()
