"""ISO 230-1 names and the spellings that stand for them."""

from __future__ import annotations

import pytest

from axiscal.exceptions import DescriptionError
from axiscal.machine.names import ErrorName, Kind, parse_error_name

NAMES: list[tuple[str, str, str, Kind, int]] = [
    ("EXX", "EXX", "X", "motion", 0),
    ("EYX", "EYX", "X", "motion", 1),
    ("EZX", "EZX", "X", "motion", 2),
    ("EAX", "EAX", "X", "motion", 3),
    ("EBX", "EBX", "X", "motion", 4),
    ("ECX", "ECX", "X", "motion", 5),
    ("ECC", "ECC", "C", "motion", 5),
    ("EXC", "EXC", "C", "motion", 0),
    ("EZU2", "EZU2", "U2", "motion", 2),
    ("EXX_reversal", "EXX_reversal", "X", "reversal", 0),
    ("ECC_reversal", "ECC_reversal", "C", "reversal", 5),
    ("EYX1_reversal", "EYX1_reversal", "X1", "reversal", 1),
    ("C0Y", "C0Y", "Y", "location", 5),
    ("EC0Y", "C0Y", "Y", "location", 5),
    ("COY", "C0Y", "Y", "location", 5),
    ("ECOY", "C0Y", "Y", "location", 5),
    ("C(0X)Y", "C0Y", "Y", "location", 5),
    ("EC(0X)Y", "C0Y", "Y", "location", 5),
    ("EC(OX)Y", "C0Y", "Y", "location", 5),
    ("A0Z", "A0Z", "Z", "location", 3),
    ("X0C", "X0C", "C", "location", 0),
    ("C0C", "C0C", "C", "location", 5),
    ("Z0B2", "Z0B2", "B2", "location", 2),
]


@pytest.mark.parametrize(("text", "canonical", "axis", "kind", "component"), NAMES)
def test_a_name_is_taken_apart(text: str, canonical: str, axis: str, kind: Kind, component: int) -> None:
    reference = "X" if "(" in text else None
    assert parse_error_name(text) == ErrorName(canonical, axis, kind, component, reference)
    assert parse_error_name(canonical).canonical == canonical


def test_displacements_and_angles_are_told_apart() -> None:
    assert [parse_error_name(f"E{c}X").angular for c in "XYZABC"] == [False] * 3 + [True] * 3


@pytest.mark.parametrize(
    ("text", "fragment"),
    [
        ("exx", "Perhaps EXX is meant"),
        ("c0y", "Perhaps C0Y is meant"),
        ("EXX_Reversal", "Perhaps EXX_reversal is meant"),
        ("E X X", "Perhaps EXX is meant"),
        ("C0Y_reversal", "constant"),
        ("EUX", "Component errors are named like"),
        ("EXD", "Component errors are named like"),
        ("EXX0", "Component errors are named like"),
        ("XX", "Component errors are named like"),
        ("C(0X)", "Component errors are named like"),
        ("C(XY)", "Component errors are named like"),
        ("U0Y", "Component errors are named like"),
        ("", "Component errors are named like"),
        ("EXX\n", "Perhaps EXX is meant"),
        ("EXX" * 100, "Component errors are named like"),
    ],
)
def test_what_is_no_name_is_refused(text: str, fragment: str) -> None:
    with pytest.raises(DescriptionError) as failure:
        parse_error_name(text)
    assert fragment in str(failure.value)
    assert (text if len(text) < 50 and text.isprintable() else "EXX") in failure.value.what
