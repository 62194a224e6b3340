"""`axiscal machine list / show / check`."""

from __future__ import annotations

from pathlib import Path

from axiscal.cli.printing import say, say_either
from axiscal.errors.gauge import machine_check, undescribed
from axiscal.language.spoken import said
from axiscal.machine import builtin_names, load_machine
from axiscal.machine.axis import travel_text
from axiscal.machine.questions import which_way


def list_machines() -> None:
    """List the built-in machines."""
    machines = {name: load_machine(name) for name in builtin_names()}
    rows = [{"name": key, "title": machine.name, "chain": machine.chain} for key, machine in machines.items()]
    lines = (f"{key:20} {machine.chain:24} {machine.name}" for key, machine in machines.items())
    say_either("axiscal-machines/1", {"machines": rows}, lines)


def show(name: str) -> None:
    """Print a built-in description, to be copied and changed."""
    say(load_machine(name).text.rstrip("\n"))


def check(file: Path) -> None:
    """Check a description of a machine."""
    machine = load_machine(str(file))
    hidden, absent = machine_check(machine), undescribed(machine)
    open_ones = which_way(machine)
    document = {
        "name": machine.name,
        "axes": [axis.name for axis in machine.axes],
        "errors": [each.name for each in machine.stated],
        "observability": [*hidden, *([absent] if absent else [])],
        "questions": list(open_ones),
    }
    carries = {True: said("carries the workpiece"), False: said("carries the tool")}
    all_seen = "Readings of the tool point can see every error."
    lines = [
        f"{machine.name}: {machine.chain}, " + said("errors described: {count}.", count=len(machine.stated)),
        *(f"  {axis.name:3} {travel_text(axis)}, {carries[axis.workpiece_side]}" for axis in machine.axes),
        *(said("Mind: {sentence}", sentence=question) for question in open_ones),
        said("What no reading of the tool point can see:" if hidden else all_seen),
        *(f"- {sentence}" for sentence in hidden),
        *([absent] if absent else []),
    ]
    say_either("axiscal-machine/1", document, lines)
