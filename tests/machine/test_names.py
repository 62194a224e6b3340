"""Names and chains in the manner of ISO 230-1 and ISO 10791-6 and errors of two axes."""

import pytest

from axiscal.machine import machine_from_text
from axiscal.machine.error_names import error_named, reference_in
from axiscal.machine.machine_schema import parse_chain
from axiscal_core.errors import Kind

NAMES: list[tuple[str, str, str, Kind, int]] = [
    ("EXX", "EXX", "X", "motion", 0),
    ("EZX", "EZX", "X", "motion", 2),
    ("EAX", "EAX", "X", "motion", 3),
    ("ECX", "ECX", "X", "motion", 5),
    ("ECC", "ECC", "C", "motion", 5),
    ("EZU2", "EZU2", "U2", "motion", 2),
    ("EXX_reversal", "EXX_reversal", "X", "reversal", 0),
    ("EYX1_reversal", "EYX1_reversal", "X1", "reversal", 1),
    ("C0Y", "C0Y", "Y", "location", 5),
    ("EC0Y", "C0Y", "Y", "location", 5),
    ("COY", "C0Y", "Y", "location", 5),
    ("C(0X)Y", "C0Y", "Y", "location", 5),
    ("EC(0X)Y", "C0Y", "Y", "location", 5),
    ("EC(OX)Y", "C0Y", "Y", "location", 5),
    ("A0Z", "A0Z", "Z", "location", 3),
    ("X0C", "X0C", "C", "location", 0),
    ("Z0B2", "Z0B2", "B2", "location", 2),
]


@pytest.mark.parametrize(("text", "canonical", "axis", "kind", "component"), NAMES)
def test_a_name_is_taken_apart(text: str, canonical: str, axis: str, kind: Kind, component: int) -> None:
    found = error_named(text)
    assert (found.name, found.axis, found.kind, found.component) == (canonical, axis, kind, component)
    assert reference_in(text) == ("X" if "(" in text else None)
    assert error_named(canonical).name == canonical


CHAINS: list[tuple[str, list[str]]] = [
    ("[w C' A' X' b Y Z (C) t]", ["C'", "A'", "X'", "Y", "Z"]),
    ("w-X’-b-Y-t", ["X'", "Y"]),
    (" w - X' - b - Z - (C1) - t ", ["X'", "Z"]),
]


@pytest.mark.parametrize(("text", "axes"), CHAINS)
def test_the_axes_come_in_order_with_their_side(text: str, axes: list[str]) -> None:
    assert [link.name + "'" * link.workpiece_side for link in parse_chain(text)] == axes


HEAD = (
    'chain = "w-C\'-b-X-Y-t"\n[axes.X]\ntravel = ["0 mm", "300 mm"]\n[axes.Y]\ntravel = ["0 mm", "200 mm"]\n'
    '[axes.C]\ntravel = ["0 deg", "360 deg"]\n[errors]\n'
)


def test_one_value_counts_along_both_axes_and_the_order_of_the_name_counts() -> None:
    (plane,) = machine_from_text(f'{HEAD}EYCX = {{ band = "40 um", knots = 8 }}').stated
    assert plane.axes == ("C", "X")
    assert plane.std == pytest.approx(10e-6)
    (other,) = machine_from_text(f'{HEAD}EYXC = {{ std = "1 um", length = ["100 mm", "60 deg"] }}').stated
    assert [side.length for side in other.sides] == pytest.approx([0.1, 1.0471975512])
