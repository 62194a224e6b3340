"""The examples run, each says one number, and they stand on the page."""

import ast
import re
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SAYS = {
    "core_grid_encoder": [1.06],
    "core_six_degrees": [36.4],
    "core_camera": [33.0],
    "core_delta": [27.0],
    "core_robot": [45.0, 69.0],
}
"""The numbers that each prints."""
SLOW = {"core_grid_encoder", "core_six_degrees", "core_delta", "core_robot"}
"""Those that take seconds."""
MOST = 15


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.long] if name in SLOW else []) for name in SAYS]
)
def test_an_example_says_its_number(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(ROOT / "examples" / f"{name}.py"))
    found = [float(number) for number in re.findall(r"(?<![\w.])-?\d+\.?\d*", capsys.readouterr().out)]
    assert found == pytest.approx(SAYS[name], rel=0.02)


@pytest.mark.parametrize("name", SAYS)
def test_an_example_is_short_and_stands_on_the_page(name: str) -> None:
    text = (ROOT / "examples" / f"{name}.py").read_text(encoding="utf-8")
    code = text.split('"""', 2)[2].strip()
    lines = [line for line in code.splitlines() if line.strip() and not line.startswith("import")]
    assert len(lines) <= MOST
    assert ast.parse(text)
    page = (ROOT / "docs" / "core.md").read_text(encoding="utf-8")
    assert code in page or f"(../examples/{name}.py)" in page


def test_every_example_of_the_core_is_run() -> None:
    assert {path.stem for path in (ROOT / "examples").glob("core_*.py")} == set(SAYS)
