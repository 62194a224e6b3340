"""A set-up that has to be mounted before the next reading: what to mount, where to park and go, what to zero."""

from __future__ import annotations

from axiscal.language.spoken import said
from axiscal.present.guide.question import Question
from axiscal.present.guide.sign import reads_text


def mount_sentence(question: Question) -> str:
    """Return what to mount and what it will read."""
    setup, reads = question.setup, reads_text(question.setup)
    if setup.artefact is not None:
        with_artefact = "set up {artefact}, and mount the instrument ({instrument}); it reads {reads}"
        mounted = said(with_artefact, artefact=setup.artefact.standing, instrument=said(setup.instrument), reads=reads)
    else:
        mounted = said(
            "mount the instrument ({instrument}); it reads {reads}", instrument=said(setup.instrument), reads=reads
        )
    if question.go.count("=") == 1:
        return said("{mounted}, while {axis} moves", mounted=mounted, axis=question.go.split(" = ")[0])
    return mounted


def mount_steps(question: Question) -> tuple[tuple[str, str], ...]:
    """Return the steps, each as a short name and what to do."""
    zeroed = any(unknown.name.startswith("zero") for unknown in question.setup.unknowns)
    steps = (
        (said("park"), question.parked),
        (said("go to"), question.go),
        (said("at"), question.touch),
        (said("then"), said("set its display to zero there; the zero need not be exact") if zeroed else ""),
    )
    return tuple(step for step in steps if step[1])
