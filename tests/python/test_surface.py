"""The names that outsiders rely on: few, each where it says, loaded when it is used."""

import ast
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType

import jedi
import pytest

import axiscal as ac
import axiscal_core


def test_every_name_is_there() -> None:
    own = [name for name in ac.__all__ if name not in axiscal_core.__all__]
    assert len(own) <= 12
    for name in ac.__all__:
        assert getattr(ac, name) is not None
        assert name in dir(ac)
    assert [name for name in own if f"`{name}`" not in (ac.__doc__ or "")] == []


def test_names_of_the_core_are_the_same_objects() -> None:
    assert [name for name in axiscal_core.__all__ if getattr(ac, name) is not getattr(axiscal_core, name)] == []
    assert isinstance(ac.load_machine("three-axis-mill"), ac.Machine)


@pytest.mark.parametrize("package", [ac, axiscal_core])
@pytest.mark.parametrize(
    ("before", "complete"),
    [
        ("", set()),
        ("case", {"names", "plan", "evaluate", "next", "estimate", "known", "prior", "shows"}),
        ("plan", {"places", "minutes", "rms", "J", "U"}),
        ("known", {"mean", "covariance", "names", "sample", "read", "deviation", "table", "U", "save", "load"}),
        ("ac.Curve", {"next"}),
    ],
)
def test_an_editor_completes_the_names(package: ModuleType, before: str, complete: set[str]) -> None:
    text = f"import {package.__name__} as ac\ncase = ac.Case(ac.Machine(), [])\nplan = case.plan(readings=6)\n"
    text += "known = case.estimate([])\n"
    looked_at = jedi.Script(f"{text}{before or 'ac'}.", environment=jedi.InterpreterEnvironment())
    assert {each.name for each in looked_at.complete()} >= (complete or {*package.__all__})


def test_type_checkers_see_what_there_is() -> None:
    """The stub names the same objects, each from where it lives."""
    stub = ast.parse(Path(ac.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    said = [(each.module, name.name) for each in stub.body if isinstance(each, ast.ImportFrom) for name in each.names]
    own = [(str(home), name) for home, name in said if name != "*"]
    assert [name for home, name in own if getattr(import_module(home), name) is not getattr(ac, name)] == []
    assert sorted([*(name for _, name in own), *axiscal_core.__all__]) == sorted(ac.__all__)


def test_nothing_is_loaded_before_it_is_used() -> None:
    program = "import sys, axiscal; print(sorted(m for m in sys.modules if m.startswith('axiscal.') or m == 'numpy'))"
    loaded = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True).stdout
    assert loaded.strip() == "[]"


@pytest.mark.parametrize(
    ("name", "instead"),
    [
        ("Belief", "ac.Normal"),
        ("Estimated", "ac.Known"),
        ("Knowledge", "ac.Known"),
        ("Observation", "case.shows"),
        ("PlanResult", "ac.Plan"),
        ("Setup", "ac.Laser"),
        ("best_step", "case.next"),
        ("estimate", "case.estimate"),
        ("setup", "ac.Laser"),
    ],
)
def test_a_name_that_is_gone_says_what_to_use_instead(name: str, instead: str) -> None:
    with pytest.raises(AttributeError, match=rf"^axiscal\.{name} is gone: .*{instead}.*\.$"):
        getattr(ac, name)
    assert name not in dir(ac)


def test_a_name_that_is_not_there() -> None:
    with pytest.raises(AttributeError, match="no attribute 'Spline'"):
        _ = ac.Spline  # type: ignore[attr-defined]
