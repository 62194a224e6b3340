"""The stories of the library: the notebook runs as it stands, and page and notebook say what the files say."""

import json
from typing import Any

import pytest

from tests.docs.stories import NOTEBOOK, PAGE, ROOT, STORIES, notebook, told

CELLS = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]


def test_there_are_three_stories_of_at_most_fifteen_lines() -> None:
    assert len(STORIES) == 3
    for path in STORIES:
        lines = [line for line in told(path)[2].splitlines() if line and not line.startswith(("import", "print"))]
        assert len(lines) <= 15


def test_the_notebook_is_made_of_the_files() -> None:
    assert notebook()["cells"] == CELLS, "run `make docs`"


def test_the_page_has_every_story() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert [path for path in STORIES if told(path)[1] not in text or f"(../examples/{path.name})" not in text] == []
    assert told(STORIES[0])[2] in text, "run `make docs`"


@pytest.mark.long
@pytest.mark.parametrize("cell", [c for c in CELLS if c["cell_type"] == "code"], ids=lambda cell: str(cell["id"]))
def test_a_cell_runs_and_shows_its_picture(
    cell: dict[str, Any], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    names: dict[str, Any] = {}
    exec(compile(cell["source"], cell["id"], "exec"), names)
    assert capsys.readouterr().out.count("\n") >= 3
    assert all(len(svg.split("<path")) > 1 for svg in names["picture"].svg)
