"""Pages that are made from the code say what the code says."""

from __future__ import annotations

import json
from pathlib import Path

from axiscal.present.result_document import result_json
from tests.docs import api, result
from tests.present.test_result import SUMMARY

ROOT = Path(__file__).resolve().parents[2]


def test_every_public_name_is_on_its_page() -> None:
    assert api.page() == api.PAGE.read_text(encoding="utf-8"), "run `make docs`"


def test_the_fields_of_a_result_are_on_their_page() -> None:
    assert result.page() == result.PAGE.read_text(encoding="utf-8"), "run `make docs`"
    assert result.schema() == json.loads(result.SCHEMA.read_text(encoding="utf-8")), "run `make docs`"


def test_a_result_has_the_fields_of_the_page_and_no_other() -> None:
    document = json.loads(json.dumps(result_json(SUMMARY)))
    result.Result.model_validate(document)


def test_the_page_of_the_package_stands_alone() -> None:
    """A package index shows it beside no other page of ours, so links to them would lead nowhere."""
    text = (ROOT / "docs" / "package.md").read_text(encoding="utf-8")
    prose = text.split("```")[::2]
    assert [part for part in prose if "](" in part] == []
