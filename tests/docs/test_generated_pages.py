"""Pages made from the code say what the code says; every numbered equation has a function and a test."""

from pathlib import Path

import pytest
from jsonschema_rs import meta, validator_for

from tests.docs import api, result
from tests.docs.equations import LAST, PAGE, citations, page, table
from tests.generators.results import golden_result

ROOT = Path(__file__).resolve().parents[2]


def test_every_public_name_is_on_its_page() -> None:
    assert api.page() == api.PAGE.read_text(encoding="utf-8"), "run `make docs`"


def test_the_fields_of_a_result_are_on_their_page() -> None:
    assert result.page() == result.PAGE.read_text(encoding="utf-8"), "run `make docs`"
    assert result.written() == result.SCHEMA.read_text(encoding="utf-8"), "run `make docs`"
    meta.validate(result.schema())
    assert validator_for(result.schema()).is_valid(golden_result("mill/out").model_dump(mode="json", by_alias=True))


def test_the_page_of_the_package_stands_alone() -> None:
    """A package index shows it beside no other page of ours, so links to them would lead nowhere."""
    text = (ROOT / "docs" / "package.md").read_text(encoding="utf-8")
    prose = text.split("```")[::2]
    assert [part for part in prose if "](" in part] == []


FUNCTIONS, TESTS = citations("src", tests=False), citations("tests", tests=True)


@pytest.mark.parametrize("number", range(1, LAST + 1))
def test_every_equation_is_computed_and_checked(number: int) -> None:
    assert FUNCTIONS[number], f"no function cites B&H eq. {number}"
    assert TESTS[number], f"no test cites B&H eq. {number}"


def test_the_page_is_made_from_the_docstrings() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert page(text) == text, "run `make docs`"


def test_the_page_speaks_of_every_formula_that_a_test_contradicts() -> None:
    contradicted = [number for number, found in TESTS.items() if any("printed" in c.says for c in found)]
    text = PAGE.read_text(encoding="utf-8")
    text = text.replace(table(text), "")
    assert contradicted == [5, 8, 9]
    assert [number for number in contradicted if f"({number})" not in text] == []
