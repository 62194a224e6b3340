"""Kinematic chains in the manner of ISO 10791-6."""

from __future__ import annotations

import pytest

from axiscal.exceptions import ChainError
from axiscal.machine.description import parse_chain

CHAINS: list[tuple[str, list[str]]] = [
    ("w-b-X-t", ["X"]),
    ("w-X'-b-t", ["X'"]),
    ("w-X'-Y'-b-Z-t", ["X'", "Y'", "Z"]),
    ("w-C'-B'-b-Y-X-Z-t", ["C'", "B'", "Y", "X", "Z"]),
    ("w-C'-A'-X'-b-Y-Z-(C)-t", ["C'", "A'", "X'", "Y", "Z"]),
    ("[w C' A' X' b Y Z (C) t]", ["C'", "A'", "X'", "Y", "Z"]),
    ("w-X’-b-Y-t", ["X'", "Y"]),
    (" w - X' - b - Z - (C1) - t ", ["X'", "Z"]),
    ("w-b-X-U-P-t", ["X", "U", "P"]),
    ("w-b-X1-X2-t", ["X1", "X2"]),
    ("w-A'-b-Z-Y-X-C-W-t", ["A'", "Z", "Y", "X", "C", "W"]),
]


@pytest.mark.parametrize(("text", "axes"), CHAINS)
def test_the_axes_come_in_order_with_their_side(text: str, axes: list[str]) -> None:
    assert [link.name + "'" * link.workpiece_side for link in parse_chain(text)] == axes


@pytest.mark.parametrize(
    ("text", "offender", "remedy"),
    [
        ("", '""', "Write the chain"),
        ("X", '"X"', "Write the chain"),
        ("X'-b-Z-t", "does not begin with w", "Write the chain"),
        ("w-X'-b-Z", "does not end with t", "Write the chain"),
        ("t-Z-b-X'-w", "does not begin with w", "Write the chain"),
        ("w-X'-Z-t", "has no bed b", "Write the chain"),
        ("w-X'-b-b-Z-t", "more than one bed", "Write the chain"),
        ("w-b-t", "has 0 axes", "One to 6"),
        ("w-b-X-Y-Z-U-V-W-A-t", "has 7 axes", "One to 6"),
        ("w-X'-b-X-t", "X stands twice", "X2"),
        ("w-b-Z-Y-Z-t", "Z stands twice", "Z2"),
        ("w-X-b-Z-t", "X in the chain", "write X'"),
        ("w-X'-b-Z'-t", "Z' in the chain", "write Z,"),
        ("w-b-x-t", '"x"', "capitals: X"),
        ("w-b-D-t", '"D"', "Axes are X Y Z"),
        ("w-b-X0-t", '"X0"', "one digit"),
        ("w-b-X12-t", '"X12"', "one digit"),
        ("w-b-XY-t", '"XY"', "one digit"),
        ("w-b--X-t", '""', "Axes are"),
        ("w-(C')-b-X-t", '"(C\')"', "A spindle in parentheses stands behind b"),
        ("w-b-(X)-t", '"(X)"', "Axes are"),
        ("w-X''-b-t", "\"X''\"", "Axes are"),
        ("w b X t", "does not begin", "Write the chain"),
        ("w-b-X\x00-t", "X\\x00", "Axes are"),
        ("w" + "-X" * 500, "1001 characters", "Write the chain"),
    ],
)
def test_a_wrong_chain_is_refused_with_its_offender(text: str, offender: str, remedy: str) -> None:
    with pytest.raises(ChainError) as failure:
        parse_chain(text)
    assert offender in failure.value.what
    assert remedy in failure.value.remedy
