"""The words for ISO 230-1 names."""

from __future__ import annotations

import itertools

import pytest

from axiscal.errors.iso230 import words


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("EXX", "positioning of X"),
        ("EYX", "straightness of X in y"),
        *((f"E{about}{axis}", f"{turn} of {axis}") for axis, three in (("X", "ABC"), ("Y", "BAC"), ("Z", "CAB"))
          for about, turn in zip(three, ("roll", "pitch", "yaw"), strict=True)),
        ("EXX2", "positioning of X2"),
        ("X0C1", "centre of C1 in x"),
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
        ("X0C", "centre of C in x"),
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
)  # fmt: skip
def test_words(name: str, expected: str) -> None:
    assert words(name) == expected


def test_every_error_of_a_five_axis_machine_has_words_of_its_own() -> None:
    names = [f"E{d}{a}" for d, a in itertools.product("XYZABC", "XYZBC")]
    spoken = [words(name) for name in names]
    assert len(set(spoken)) == len(names)
    assert not set(spoken) & set(names)
