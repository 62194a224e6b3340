"""Every numbered equation of the paper has a function and a test, and the page says which."""

from __future__ import annotations

import pytest

from tests.docs.equations import LAST, PAGE, citations, cited, page, table

FUNCTIONS, TESTS = citations("src/axiscal", tests=False), citations("tests", tests=True)


@pytest.mark.parametrize("number", range(1, LAST + 1))
def test_every_equation_is_computed_and_checked(number: int) -> None:
    assert FUNCTIONS[number], f"no function cites B&H eq. {number}"
    assert TESTS[number], f"no test cites B&H eq. {number}"


def test_the_page_is_made_from_the_docstrings() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert page(text) == text, "run `make docs`"


def test_the_page_speaks_of_every_formula_that_a_test_contradicts() -> None:
    contradicted = [number for number, found in TESTS.items() if any("printed" in c.says for c in found)]
    text = PAGE.read_text(encoding="utf-8").replace(table(), "")
    assert contradicted == [5, 8, 9]
    assert [number for number in contradicted if f"({number})" not in text] == []


def test_citations_are_read_as_written() -> None:
    text = "x (B&H eq. 4, 8), (B&H eq. 24-26; several joints B&H eq. 34-36) and B&H eq. 2 alone; eq. 7 of another."
    assert cited(text) == {2, 4, 8, 24, 25, 26, 34, 35, 36}
    assert cited("B&H eq.\n    13-14") == {13, 14}
