"""docs/examples.md: every example with its text and its picture.

`python -m tests.docs.examples` writes the page, the pictures, and the golden numbers of the tests.
"""

import ast
import json
import runpy
from pathlib import Path
from typing import Any

from tests.docs.pictures import svg

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "examples.md"
PICTURES = ROOT / "docs" / "examples"
GOLDEN = ROOT / "tests" / "golden" / "examples.json"
EXAMPLES = sorted((ROOT / "examples").glob("ex*.py"))

_HEAD = """\
# Examples

Each is a file in [examples/](../examples) that runs by itself; its picture leads there. `make docs` makes the page.
"""


def found(path: Path) -> dict[str, Any]:
    """Return what the example in a file finds, its picture included."""
    result: dict[str, Any] = runpy.run_path(str(path))["main"]()
    return result


def numbers(result: dict[str, Any]) -> dict[str, Any]:
    """Return the findings without the picture."""
    return {name: value for name, value in result.items() if name != "picture"}


def section(path: Path) -> str:
    """Return the part of the page about one example."""
    source = path.read_text(encoding="utf-8")
    title, _, text = (ast.get_docstring(ast.parse(source)) or "").partition("\n")
    number, picture = path.stem[2:4].lstrip("0"), f"![{path.name}](examples/{path.stem}.svg)"
    return f"## {number}. {title.rstrip('.')}\n{text.strip()}\n\n[{picture}](../examples/{path.name})\n"


def page() -> str:
    """Return the whole page."""
    return "\n".join([_HEAD, *(section(path) for path in EXAMPLES)])


def write() -> None:
    """Run every example and write page, pictures and golden numbers."""
    results = {path: found(path) for path in EXAMPLES}
    PICTURES.mkdir(exist_ok=True)
    for path, result in results.items():
        (PICTURES / f"{path.stem}.svg").write_text(svg(result["picture"]), encoding="utf-8")
    PAGE.write_text(page(), encoding="utf-8")
    golden = {path.stem: numbers(result) for path, result in results.items()}
    GOLDEN.write_text(json.dumps(golden, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write()
