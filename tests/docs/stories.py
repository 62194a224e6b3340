"""docs/python.md and docs/python.ipynb: the stories of the library, the first with its code and what it prints.

`python -m tests.docs.stories` writes both; the files in examples/ are their source.
"""

import ast
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
STORIES = sorted((ROOT / "examples").glob("story*.py"))
PAGE, NOTEBOOK = ROOT / "docs" / "python.md", ROOT / "docs" / "python.ipynb"

_HEAD = """\
# axiscal from Python

Three stories of [examples/](../examples), also in [python.ipynb](python.ipynb). Numbers are metres, radians, seconds;
texts carry units. `sure` is `"well"` here, `"roughly"` in campaign.toml. All names: [api.md](api.md); instruments,
errors and machines of your own: [core.md](core.md). What prompt, page and records do is `ac.Campaign`.
"""


def told(path: Path) -> tuple[str, str, str]:
    """Return title, text and code of a story."""
    source = path.read_text(encoding="utf-8")
    title, _, text = (ast.get_docstring(ast.parse(source)) or "").partition("\n")
    return title.rstrip("."), text.strip(), source.partition('"""\n\n')[2].strip()


def printed(path: Path) -> str:
    """Return what a story prints when it runs by itself."""
    done = subprocess.run([sys.executable, str(path)], cwd=ROOT, check=True, capture_output=True, text=True)
    return done.stdout.strip()


def page() -> str:
    """Return the whole page."""
    return "\n".join([_HEAD, *map(_section, STORIES)])


def _section(path: Path) -> str:
    title, text, code = told(path)
    shown = f"```python\n{code}\n```\n\n```\n{printed(path)}\n```\n\n" if path == STORIES[0] else ""
    return f"## {title}\n{text}\n\n{shown}[{path.name}](../examples/{path.name})\n"


def notebook() -> dict[str, Any]:
    """Return the stories as a notebook without outputs; its pictures come when it runs."""
    cells = []
    for number, path in enumerate(STORIES):
        title, text, code = told(path)
        cells.append(_cell("markdown", f"{number}a", f"## {title}\n{text}"))
        cells.append(_cell("code", f"{number}b", f"{code}\npicture"))
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}


def _cell(kind: str, name: str, text: str) -> dict[str, Any]:
    cell: dict[str, Any] = {"cell_type": kind, "id": f"story-{name}", "metadata": {}, "source": text}
    return cell | ({"execution_count": None, "outputs": []} if kind == "code" else {})


def write() -> None:
    """Write page and notebook."""
    PAGE.write_text(page(), encoding="utf-8")
    NOTEBOOK.write_text(json.dumps(notebook(), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write()
