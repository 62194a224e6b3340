"""What a person accepts puts right just what went wrong: the mistake made by hand, and then taken back."""

from dataclasses import replace

import pytest

from axiscal.measurement.reading import Reading
from axiscal.record.accepted import Accepted, put_right


def _reading(number: int, setup: str, value: float, std: float | None = None) -> Reading:
    return Reading(setup, (0.1 * number,), (1,), value, std, others=(value + 1.0, value + 2.0), number=number)


RIGHT = [
    _reading(3, "one", 5.0, 0.5), _reading(4, "two", 6.0), _reading(7, "one", 7.0), _reading(8, "two", 8.0, 0.25),
    _reading(9, "one", 9.0), _reading(12, "two", 1.0),
]  # fmt: skip
"""Readings of two set-ups in turn, of three values each; some numbers are of readings that were taken back."""


def _with(values: dict[int, Reading]) -> list[Reading]:
    """Return the readings with the values and noise of others, by number."""
    return [
        replace(each, value=of.value, others=of.others, std=of.std) if (of := values.get(each.number or 0)) else each
        for each in RIGHT
    ]


BY_NUMBER = {each.number: each for each in RIGHT}


def _times(factor: float, numbers: set[int]) -> list[Reading]:
    def scaled(one: Reading) -> Reading:
        value, *others = (factor * each for each in one.values)
        return replace(one, value=value, others=tuple(others), std=one.std and abs(factor) * one.std)

    return _with({number: scaled(BY_NUMBER[number]) for number in numbers})


def test_values_of_another_sign_or_unit_are_multiplied_back() -> None:
    assert put_right(_times(-1.0, {3, 7, 9}), Accepted("sign", ("one",), factor=-1.0)) == RIGHT
    assert put_right(_times(0.125, {4, 8, 12}), Accepted("unit", ("two",), factor=8.0)) == RIGHT
    assert put_right(_times(0.125, {7, 9}), Accepted("unit", ("one",), 7, 8.0)) == RIGHT
    unnumbered = [replace(each, number=None) for each in _times(0.125, {9})]
    assert put_right(unnumbered, Accepted("unit", ("one",), 5, 8.0)) == [replace(each, number=None) for each in RIGHT]


def test_sides_and_passes_of_a_stretch_are_turned_back() -> None:
    turned = [replace(each, approach=(-1 if each.number == 7 else 1,)) for each in RIGHT]
    assert put_right(turned, Accepted("sides", ("one",), 4, last=8)) == RIGHT
    assert put_right(_with({7: BY_NUMBER[9], 9: BY_NUMBER[7]}), Accepted("mirrored", ("one",), 4)) == RIGHT


def test_values_of_two_set_ups_are_exchanged_with_their_noise() -> None:
    pairs = [(3, 4), (7, 8), (9, 12)]
    swapped = _with({a: BY_NUMBER[b] for a, b in pairs} | {b: BY_NUMBER[a] for a, b in pairs})
    assert swapped[0].std is None
    assert put_right(swapped, Accepted("swapped", ("one", "two"))) == RIGHT
    with pytest.raises(ValueError, match="2 values of one set-up cannot be swapped with 3 of another"):
        put_right(RIGHT[1:], Accepted("swapped", ("one", "two")))
    single = [replace(each, others=()) if each.setup == "one" else each for each in RIGHT]
    with pytest.raises(ValueError, match="of one value and of three"):
        put_right(single, Accepted("swapped", ("one", "two")))


@pytest.mark.parametrize(("step", "wrong", "left_out"), [(1, {3: 7, 7: 9}, 3), (-1, {9: 7, 7: 3}, 9)])
def test_values_move_a_place_and_the_one_that_nobody_knows_is_left_out(
    step: int, wrong: dict[int, int], left_out: int
) -> None:
    """Step 1: at each place stands the value of the next one, and the value of the first is gone."""
    shifted = _with({number: BY_NUMBER[of] for number, of in wrong.items()})
    found = put_right(shifted, Accepted("shifted", ("one",), factor=float(step)))
    assert found == [each for each in RIGHT if each.number != left_out]


def test_those_before_a_jump_are_of_a_set_up_of_their_own() -> None:
    found = put_right(RIGHT, Accepted("jump", ("one",), 9, name="one, before"))
    assert [each.setup for each in found] == ["one, before", "two", "one, before", "two", "one", "two"]
    assert [replace(each, setup="") for each in found] == [replace(each, setup="") for each in RIGHT]
    with pytest.raises(ValueError, match="no zero jumped before reading 3"):
        put_right(RIGHT, Accepted("jump", ("one",), 3, name="it"))


def test_of_backlash_the_first_reading_behind_the_turn_counts_as_right() -> None:
    found = put_right(RIGHT, Accepted("backlash", ("one",), 7))
    assert [each.number for each in found if each.accepted] == [7]
    assert [replace(each, accepted=False) for each in found] == RIGHT
    with pytest.raises(ValueError, match="there is no reading 8 behind a turn"):
        put_right(RIGHT, Accepted("backlash", ("one",), 8))


def test_a_mistake_of_a_set_up_without_readings_is_none() -> None:
    with pytest.raises(ValueError, match="readings that there are not"):
        put_right(RIGHT, Accepted("sign", ("three",), factor=-1.0))
