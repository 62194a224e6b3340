"""References that reach over all travel, for tests that are about something else than where readings can be taken."""

from axiscal.machine import machine_from_text
from axiscal.units import format_quantity
from axiscal_core.machine import Machine


def reach_of(machine: Machine | str) -> str:
    """Return the line of a set-up whose reference reaches over all travels.  machine : or its machine.toml as text"""
    built = machine_from_text(machine) if isinstance(machine, str) else machine
    spans = []
    for axis in built.axes:
        low, high = (format_quantity(end, axis.unit, 12) for end in axis.travel)
        spans.append(f'{axis.name} = ["{low}", "{high}"]')
    return f"reach = {{ {', '.join(spans)} }}\n"
