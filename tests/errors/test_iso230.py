"""The words for ISO 230-1 names."""

import itertools

from axiscal.errors.iso230 import words


def test_every_error_of_a_five_axis_machine_has_words_of_its_own() -> None:
    names = [f"E{d}{a}" for d, a in itertools.product("XYZABC", "XYZBC")]
    spoken = [words(name) for name in names]
    assert len(set(spoken)) == len(names)
    assert not set(spoken) & set(names)
