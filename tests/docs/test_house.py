"""The house as built agrees with the house as drawn."""

import ast
import re
import subprocess
import tomllib
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

import pytest

import axiscal
from axiscal.document.ports import names, one_of, part
from tests.docs.sources import PACKAGE, nodes

ROOT = Path(__file__).resolve().parents[2]
LINES = 400
WORDS = {"README.md": 450, "CHANGELOG.md": 1500}
"""What somebody reads before deciding to stay, and before deciding to update."""
FOR_USERS, OF_EVIDENCE = 24_000, 5_000
"""Words of all pages in docs: those beside the evidence, and the evidence."""

# Spelt in halves, so that this file does not contain what it looks for.
REGISTRIES = [
    "files.python" + "hosted",
    "py" + "pi.org",
    "registry.npm" + "js",
    "deb.deb" + "ian.org",
    "--index" + "-url",
]
WORKPLACE = [r"(?<![\w.~-])/wo" + r"rk/", "/opt/" + "wheels", "/opt/py" + "pi", "/root" + "/", r"/home" + r"/\w+"]
CLASSES_THAT_MAY = {
    "Case": "what is measured: as the stages take it, and as `ac.Case` is made in Python",
}
FILES_THAT_MAY = {
    "campaign.py": "a campaign as it is described, and as it runs",
}
FORBIDDEN = re.compile("|".join([re.escape(name) for name in REGISTRIES] + WORKPLACE))


def _rooms() -> list[str]:
    """Return the names of the modules and packages directly in the package."""
    modules = [path.stem for path in PACKAGE.glob("*.py") if path.stem not in {"__init__", "__main__"}]
    packages = [path.parent.name for path in PACKAGE.glob("*/__init__.py")]
    return sorted(modules + packages)


def _more_than_once(homes: dict[str, list[str]], may: set[str]) -> dict[str, list[str]]:
    return {name: places for name, places in homes.items() if len(places) > 1 and name not in may}


def _committed() -> list[Path]:
    """Return the files under version control, or every text source where there is no git."""
    try:
        listing = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True).stdout
    except (OSError, subprocess.CalledProcessError):
        places = ("src", "tests", "docs", "requirements", "benchmarks", "examples")
        return [path for place in places for path in (ROOT / place).rglob("*") if path.is_file()]
    return [path for name in listing.decode().split("\0") if name and (path := ROOT / name).is_file()]


def _text(path: Path) -> str:
    """Return the text of a file; empty for a binary one."""
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return ""


@pytest.mark.parametrize("room", _rooms())
def test_every_room_is_drawn(room: str) -> None:
    assert f"`{room}`" in (ROOT / "docs" / "architecture.md").read_text()


def test_the_drawn_order_is_the_order_that_is_held() -> None:
    picture = (ROOT / "docs" / "architecture.md").read_text()
    drawn = re.findall(r"^ {4,}([a-z_]+(?: \| [a-z_]+)*)$", picture, flags=re.MULTILINE)
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    layers = next(contract["layers"] for contract in contracts if contract["type"] == "layers")
    assert drawn == [re.sub(r"[()]", "", layer) for layer in layers]


def test_a_class_has_a_name_of_its_own() -> None:
    homes = defaultdict(list)
    for file, node in nodes(ast.ClassDef):
        homes[node.name].append(file)
    assert _more_than_once(homes, set(CLASSES_THAT_MAY)) == {}


def test_no_room_hides_a_public_name() -> None:
    """Once a package is imported it is an attribute of its parent, and the function of that name is gone."""
    assert {each.stem for each in PACKAGE.iterdir()} & set(axiscal.__all__) == set()


def test_a_file_has_a_name_of_its_own() -> None:
    homes = defaultdict(list)
    for path in sorted(PACKAGE.rglob("*.py")):
        file, name = path.relative_to(PACKAGE).as_posix(), path.name
        if not name.startswith("__") and not file.startswith("cli/"):  # a command is called as what it shows
            homes[name].append(file)
    assert _more_than_once(homes, set(FILES_THAT_MAY)) == {}
    assert [name for name in FILES_THAT_MAY if len(homes[name]) < 2] == []


def test_what_other_rooms_ask_for_is_brought_by_a_port() -> None:
    """No import says so: the rooms do not know the ports."""
    texts = [path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")]
    asked = {name for text in texts for name in re.findall(r'\bpart\("([\w-]+)"\)', text)}
    assert asked == set(names("axiscal.parts"))
    assert all(part(name) is not None for name in asked)
    brought = [one_of(group, name) for group in ("axiscal.exporters", "axiscal.running") for name in names(group)]
    assert len(brought) > 10
    assert [text for text in texts if re.search(r'"[\w.]*ports\.\w+[.:]', text)] == []


def test_a_cache_is_asked_with_numbers_and_texts_only() -> None:
    """What else is asked with is kept alive by the cache, a model of a machine with all its readings: `remembered`."""
    asked = [
        (file, function.name, ast.unparse(argument.annotation or ast.Constant(None)))
        for file, function in nodes(ast.FunctionDef)
        if any(re.search(r"\b(lru_)?cache\b", ast.unparse(each)) for each in function.decorator_list)
        for argument in function.args.args
    ]
    assert asked
    assert [each for each in asked if each[2] not in {"int", "float", "str"}] == []


def test_numpy_reads_no_pickled_objects() -> None:
    """The linter forbids what pickles by itself."""
    allowing = re.compile(r"allow_pickle" + "=(?!False)")
    assert [path.name for path in _committed() if path.suffix == ".py" and allowing.search(_text(path))] == []


def test_files_stay_small() -> None:
    lengths = {path.relative_to(ROOT): len(_text(path).splitlines()) for path in PACKAGE.rglob("*.py")}
    assert {path: length for path, length in lengths.items() if length > LINES} == {}


@pytest.mark.parametrize("page", WORDS)
def test_first_pages_stay_short(page: str) -> None:
    assert len((ROOT / page).read_text(encoding="utf-8").split()) <= WORDS[page]


def test_nothing_names_a_registry_or_a_workplace() -> None:
    found = [
        f"{path.relative_to(ROOT)}:{number}: {match.group()}"
        for path in _committed()
        for number, line in enumerate(_text(path).splitlines(), start=1)
        if (match := FORBIDDEN.search(line))
    ]
    assert found == []


def test_forbidden_names_would_be_found() -> None:
    examples = ["https://py" + "pi.org/simple", "see /wo" + "rk/main", "-f /opt/" + "wheels", "a,/home" + "/someone/x"]
    assert all(FORBIDDEN.search(example) for example in examples)
    assert not FORBIDDEN.search("src/frame" + "/wo" + "rk/x")


def test_both_locks_agree() -> None:
    pins = [
        dict(re.findall(r"^([a-z0-9-]+)==(\S+)", (ROOT / "requirements" / name).read_text(), flags=re.MULTILINE))
        for name in ("run.txt", "dev.txt")
    ]
    assert pins[0].items() <= pins[1].items()


def test_every_dependency_has_its_reason_on_the_page_of_decisions() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    page = (ROOT / "docs" / "decisions" / "index.md").read_text(encoding="utf-8")
    extras = project["optional-dependencies"]
    needed = [*project["dependencies"], *extras["app"]]
    names = [re.split(r"[<>=]", each)[0] for each in needed]
    assert [name for name in names if f"**{name}**" not in page] == []


def _words(pages: Iterable[Path]) -> int:
    """Return the words of pages, as `wc -w` counts them."""
    return sum(len(page.read_text(encoding="utf-8").split()) for page in pages)


def test_the_documentation_stays_short() -> None:
    """Pages for users and those of evidence have budgets: who looks something up reads what is there."""
    docs, evidence = ROOT / "docs", ROOT / "docs" / "evidence"
    assert _words(page for page in docs.rglob("*.md") if not page.is_relative_to(evidence)) <= FOR_USERS
    assert _words(evidence.rglob("*.md")) <= OF_EVIDENCE


def test_files_that_pages_name_are_there() -> None:
    named = {
        name
        for page in [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
        for name in re.findall(r"`((?:[a-z_]+/)+[a-z_]+\.py)`", page.read_text(encoding="utf-8"))
    }
    assert "estimation/estimate.py" in named
    assert [name for name in named if not any((ROOT / where / name).exists() for where in ("", "src/axiscal"))] == []
