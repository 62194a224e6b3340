"""A set-up that has to be mounted before the next reading: what to mount, where to park and go, what to zero."""

from __future__ import annotations

from axiscal.guide.question import Question, way_text


def mount_sentence(question: Question) -> str:
    """Return what to mount and what it will read."""
    moves = f"; it reads while {question.go.split(' = ')[0]} moves" if question.go.count("=") == 1 else ""
    return f"mount the {question.setup.instrument}, reading {way_text(question.setup)}{moves}"


def mount_steps(question: Question) -> tuple[tuple[str, str], ...]:
    """Return the steps, each as a short name and what to do."""
    zeroed = any(unknown.name.startswith("zero") for unknown in question.setup.unknowns)
    steps = (
        ("park", question.parked),
        ("go to", question.go),
        ("then", "set its display to zero there; the zero need not be exact" if zeroed else ""),
    )
    return tuple(step for step in steps if step[1])
