"""What is remembered of an object goes with it."""

import gc
from functools import partial
from weakref import ref

from axiscal.numerics.remembered import Memo, remembered


class Model:
    """Something large."""


def test_a_question_is_answered_once_for_each_object_and_number() -> None:
    asked = []

    @remembered
    def answer(of: Model, number: int) -> int:
        asked.append((of, number))
        return number + 1

    one, other = Model(), Model()
    assert [answer(one, 1), answer(one, 1), answer(one, 2), answer(other, 1)] == [2, 2, 3, 2]
    assert asked == [(one, 1), (one, 2), (other, 1)]


def test_an_answer_does_not_keep_its_object_alive() -> None:
    @remembered
    def answer(of: Model, number: int) -> list[int]:
        return [number]

    model = Model()
    answer(model, 1)
    left = ref(model)
    del model
    gc.collect()
    assert left() is None


def test_the_last_few_are_kept() -> None:
    memo, asked = Memo(4), list[int]()

    def found(number: int) -> int:
        asked.append(number)
        return 10 * number

    numbers = (0, 1, 2, 3, 0, 4, 0, 1)
    assert [memo.answer(number, partial(found, number)) for number in numbers] == [10 * number for number in numbers]
    assert asked == [0, 1, 2, 3, 4, 1]
