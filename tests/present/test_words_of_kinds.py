"""Every kind that data may have has words: of sizes, of causes that no reading shows, of rows."""

from typing import get_args

import pytest

from axiscal.description import target
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.present import findings, row_words, sentences
from axiscal_core.theta import Kind


@pytest.mark.parametrize(
    ("words", "kinds"),
    [
        (findings._WORDS, get_args(Kind)),
        (sentences._CAUSES, [row.name for kind in INSTRUMENTS.values() for row in kind.type_b]),
        (row_words._KINDS, get_args(target.Kind)),
    ],
)
def test_every_kind_has_words(words: dict[str, str], kinds: list[str]) -> None:
    assert set(words) == set(kinds)
