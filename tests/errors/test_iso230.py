"""The words for ISO 230-1 names."""

from __future__ import annotations

import itertools

import pytest

from axiscal.errors.iso230 import words

LINEAR = {
    "X": ("EXX", "EYX", "EZX", "EAX", "EBX", "ECX"),
    "Y": ("EYY", "EXY", "EZY", "EBY", "EAY", "ECY"),
    "Z": ("EZZ", "EXZ", "EYZ", "ECZ", "EAZ", "EBZ"),
}


@pytest.mark.parametrize("axis", LINEAR)
def test_linear_axes_follow_the_table_of_iso_230_1(axis: str) -> None:
    positioning, first, second, roll, pitch, yaw = LINEAR[axis]
    assert words(positioning) == f"positioning of {axis}"
    assert {words(first), words(second)} == {f"straightness of {axis} in {n[1].lower()}" for n in (first, second)}
    assert [words(n) for n in (roll, pitch, yaw)] == [f"roll of {axis}", f"pitch of {axis}", f"yaw of {axis}"]


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("EXC", "radial error of C in x"),
        ("EZC", "axial error of C"),
        ("EAC", "tilt of C about x"),
        ("ECC", "positioning of C"),
        ("EYB", "axial error of B"),
        ("EXA", "axial error of A"),
        ("ECA", "tilt of A about z"),
        ("C0Y", "squareness of Y to X"),
        ("B0Z", "squareness of Z to X"),
        ("A0Z", "squareness of Z to Y"),
        ("X0C", "offset of the C line in x"),
        ("A0C", "tilt of the C line about x"),
        ("Z0C", "offset of C along its line"),
        ("C0C", "zero of C"),
        ("EXU", "positioning of U"),
        ("EYU", "straightness of U in y"),
        ("EXX_reversal", "reversal of X"),
        ("EYX_reversal", "reversal in the straightness of X in y"),
        ("laser along X: zero", "laser along X: zero"),
        ("C0Y_reversal", "C0Y_reversal"),
        ("", ""),
    ],
)
def test_words(name: str, expected: str) -> None:
    assert words(name) == expected


def test_numbered_axis_keeps_its_number() -> None:
    assert words("EXX2") == "positioning of X2"
    assert words("X0C1") == "offset of the C1 line in x"


def test_every_error_of_a_five_axis_machine_has_words_of_its_own() -> None:
    names = [f"E{d}{a}" for d, a in itertools.product("XYZABC", "XYZBC")]
    spoken = [words(name) for name in names]
    assert len(set(spoken)) == len(names)
    assert not set(spoken) & set(names)
