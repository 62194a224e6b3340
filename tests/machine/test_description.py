"""Axes and knots of a machine from its TOML text; the built-in machines are what they say."""

import numpy as np
import pytest

from axiscal.machine import builtin_names, load_machine, machine_from_text
from axiscal_core.machine import Machine


def test_knots_stand_twice_as_far_apart_where_there_would_be_many() -> None:
    """Twelve curves of 17 control values are 204, and stay at half their length; eleven are 187."""
    names = [f"E{component}{axis}" for axis in "XY" for component in "XYZABC"]
    head = 'chain = "w-b-X-Y-t"\n' + "".join(f'[axes.{axis}]\ntravel = ["0 mm", "400 mm"]\n' for axis in "XY")
    for count, knots in ((11, 17), (12, 9)):
        sizes = {name: "urad" if name[1] in "ABC" else "um" for name in names[:count]}
        lines = [f'{name} = {{ std = "10 {unit}", length = "100 mm" }}\n' for name, unit in sizes.items()]
        machine = machine_from_text(f'{head}[errors]\n{"".join(lines)}C0Y = {{ std = "30 urad" }}\n')
        assert {e.count for e in machine.stated if e.count > 1} == {knots}


@pytest.mark.parametrize(
    ("error", "said", "count"),
    [
        ("EXX", 'spacing = "100 mm"', 7),
        ("EXX", 'spacing = "99 mm"', 8),
        ("EXX", 'spacing = "99.9999999999 mm"', 7),
        ("EXX", 'spacing = "5 m"', 2),
        ("EXX", 'length = "5 m"', 5),
        ("EXX", 'length = "400 mm"', 7),
        ("EXX", "knots = 7", 7),
        ("EXX_reversal", 'spacing = "300 mm"', 3),
    ],
)
def test_spacing_and_length_give_equidistant_knots(error: str, said: str, count: int) -> None:
    head = 'chain = "w-b-X-t"\n[axes.X]\ntravel = ["100 mm", "700 mm"]\n[errors]\n'
    (term,) = machine_from_text(f'{head}{error} = {{ std = "1 um", {said} }}').terms
    assert term.spline.knots == pytest.approx(np.linspace(0.1, 0.7, count))


def sizes(machine: Machine) -> dict[str, int]:
    """Return the number of free control values of each error."""
    counts = {}
    for entry in machine.stated:
        counts[entry.name] = entry.count - (machine.axis(entry.axis).cyclic and entry.count > 1)
    return counts


@pytest.mark.parametrize("name", builtin_names())
def test_knots_are_fine_enough_for_the_correlation_length(name: str) -> None:
    machine = load_machine(name)
    for term in machine.curves:
        if term.length is not None:
            knots = term.spline.knots
            assert knots[1] - knots[0] <= 0.55 * term.length
