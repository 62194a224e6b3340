"""A set-up that has to be mounted before the next reading: what to mount, where to park and go, what to zero."""

from __future__ import annotations

from axiscal.guide.question import Question
from axiscal.guide.sign import reads_text


def mount_sentence(question: Question) -> str:
    """Return what to mount and what it will read."""
    moves = f", while {question.go.split(' = ')[0]} moves" if question.go.count("=") == 1 else ""
    setup = question.setup
    what = f"set up {setup.artefact.name}, and mount" if setup.artefact is not None else "mount"
    return f"{what} the {setup.instrument}, which reads {reads_text(setup)}{moves}"


def mount_steps(question: Question) -> tuple[tuple[str, str], ...]:
    """Return the steps, each as a short name and what to do."""
    zeroed = any(unknown.name.startswith("zero") for unknown in question.setup.unknowns)
    steps = (
        ("park", question.parked),
        ("go to", question.go),
        ("then", "set its display to zero there; the zero need not be exact" if zeroed else ""),
    )
    return tuple(step for step in steps if step[1])
