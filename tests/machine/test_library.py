"""The built-in machines are what they say."""

from __future__ import annotations

import pytest

from axiscal.machine import Machine, builtin_names, load_machine


def sizes(machine: Machine) -> dict[str, int]:
    """Return the number of free control values of each error."""
    counts = {}
    for entry in machine.errors:
        axis = machine.axis(entry.axis)
        counts[entry.name] = entry.knot_count(axis) - (axis.cyclic and not entry.constant)
    return counts


def motions(axis: str) -> set[str]:
    """Return the six error motions of an axis and its reversal value."""
    return {f"E{component}{axis}" for component in "XYZABC"} | {f"E{axis}{axis}_reversal"}


def test_the_names() -> None:
    names = ("dmu60", "one-axis", "paper-three-stacked", "portal-mill", "printer-gantry", "three-axis-mill")
    assert builtin_names() == names


@pytest.mark.parametrize("name", builtin_names())
def test_a_built_in_machine_is_commented_and_has_its_own_name(name: str) -> None:
    machine = load_machine(name)
    assert machine.text.startswith("# ")
    assert machine.name not in ("", name)
    assert all(line.isprintable() for line in machine.text.splitlines())


def test_the_papers_machine_is_three_splines_of_seven_free_control_points() -> None:
    machine = load_machine("paper-three-stacked")
    assert sizes(machine) == {"EZX": 7, "EZU": 7, "EZP": 7}
    assert {entry.std for entry in machine.errors} == {1e-3}
    assert {entry.length for entry in machine.errors} == {None}
    assert {axis.direction for axis in machine.axes} == {(1.0, 0.0, 0.0)}
    assert {axis.travel for axis in machine.axes} == {(0.0, 0.01)}


@pytest.mark.parametrize("name", ["three-axis-mill", "portal-mill", "printer-gantry"])
def test_three_linear_axes_have_the_21_errors_of_iso_230_and_reversal(name: str) -> None:
    expected = motions("X") | motions("Y") | motions("Z") | {"C0Y", "B0Z", "A0Z"}
    assert set(sizes(load_machine(name))) == expected


def test_the_five_axis_machine_is_of_the_dmu_60_class() -> None:
    machine = load_machine("dmu60")
    assert [axis.name for axis in machine.axes] == ["C", "B", "Y", "X", "Z"]
    assert [axis.workpiece_side for axis in machine.axes] == [True, True, False, False, False]
    assert [machine.axis(name).length for name in "XYZ"] == pytest.approx([0.6, 0.5, 0.5])
    assert [machine.axis(name).cyclic for name in "BC"] == [False, True]
    counts = sizes(machine)
    linear = {"EXX_reversal", "EYY_reversal", "EZZ_reversal", "EBB_reversal", "ECC_reversal"}
    assert {name for name in counts if name.startswith("E")} == set().union(*map(motions, "XYZBC")) | linear
    assert sum(counts.values()) == 316
    assert all(entry.length for entry in machine.errors if not entry.constant)


@pytest.mark.parametrize("name", builtin_names())
def test_knots_are_fine_enough_for_the_correlation_length(name: str) -> None:
    machine = load_machine(name)
    for entry in machine.errors:
        if entry.length is not None:
            knots = entry.knot_positions(machine.axis(entry.axis))
            assert knots[1] - knots[0] <= 0.55 * entry.length
