"""Errors of two axes in machine.toml: what can be written, and what is refused with a line and a remedy."""

from __future__ import annotations

import pytest

from axiscal.exceptions import InputError
from axiscal.machine import machine_from_text
from axiscal.machine.questions import questions

HEAD = (
    'chain = "w-C\'-b-X-Y-t"\n[axes.X]\ntravel = ["0 mm", "300 mm"]\n[axes.Y]\ntravel = ["0 mm", "200 mm"]\n'
    '[axes.C]\ntravel = ["0 deg", "360 deg"]\n[errors]\n'
)


def test_a_plane_says_its_knots_and_lengths_along_both_axes() -> None:
    (plane,) = machine_from_text(
        f'{HEAD}EZXY = {{ std = "10 um", knots = [9, 7], length = ["150 mm", "100 mm"], rest = "1 um" }}'
    ).planes
    assert (plane.name, plane.axes, plane.component, plane.std, plane.rest) == ("EZXY", ("X", "Y"), 2, 10e-6, 1e-6)
    assert [(side.knots, side.length) for side in plane.sides] == [(9, 0.15), (7, 0.1)]


def test_one_value_counts_along_both_axes_and_the_order_of_the_name_counts() -> None:
    (plane,) = machine_from_text(f'{HEAD}EYCX = {{ band = "40 um", knots = 8 }}').planes
    assert plane.axes == ("C", "X")
    assert plane.std == pytest.approx(10e-6)
    (other,) = machine_from_text(f'{HEAD}EYXC = {{ std = "1 um", length = ["100 mm", "60 deg"] }}').planes
    assert [side.length for side in other.sides] == pytest.approx([0.1, 1.0471975512])


def test_a_rest_alone_needs_no_size() -> None:
    machine = machine_from_text(f'{HEAD}EZXY = {{ std = "0 um", knots = 5, rest = "2 um" }}')
    assert (machine.planes[0].std, machine.planes[0].first_rest) == (0.0, 2e-6)


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ('EZXZ = { std = "1 um" }', "no axis"),
        ('EZXX = { std = "1 um" }', "named twice"),
        ('EZXY = { std = "1 urad" }', "not a length"),
        ('EAXY = { std = "1 um" }', "not an angle"),
        ("EZXY = { knots = 5 }", "neither std nor band"),
        ('EZXY = { std = "0 um" }', "zero"),
        ('EZXY = { std = "1 um", knots = [5] }', "wrong number of entries"),
        ('EZXY = { std = "1 um", knots = [5, "6"] }', "whole number"),
        ('EZXY = { std = "1 um", knots = [5, 1] }', "not possible"),
        ('EZXY = { std = "1 um", length = ["10 mm", 3] }', "no unit"),
        ('EZXC = { std = "1 um", length = "10 mm" }', "not an angle"),
        ('EZXY = { std = "1 um", knots = 9, spacing = "10 mm" }', "both knots and spacing"),
        ('EZXY = { std = "1 um", knots = 50 }', "too many"),
        ('EZXY = { std = "1 um", period = "5 mm" }', "period"),
        ('EZXY = { std = "1 um" }\nEZYX = { std = "1 um" }', "there already in line 9"),
        ('EZX = { std = "1 um", knots = [5, 6] }', "an error of one axis"),
        ('EZX = { std = "1 um", length = ["5 mm", "6 mm"] }', "an error of one axis"),
    ],
)
def test_what_cannot_be_is_refused_with_its_line(entry: str, words: str) -> None:
    with pytest.raises(InputError) as refused:
        machine_from_text(HEAD + entry)
    assert words in str(refused.value)
    assert refused.value.line in (9, 10)


def test_a_plane_of_millimetres_is_asked_about() -> None:
    asked = questions(machine_from_text(f'{HEAD}EZXY = {{ std = "10 mm" }}\nEAXY = {{ std = "20 urad" }}'))
    assert [text for text in asked if "EZXY" in text]
    assert not [text for text in asked if "EAXY" in text]
