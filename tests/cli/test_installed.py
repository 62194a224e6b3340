"""The program without a checkout: the wheel, installed in an environment of its own."""

import os
import re
import shutil
import subprocess
import sys
import sysconfig
import venv
import zipfile
from importlib.metadata import Distribution
from pathlib import Path

import pytest

import axiscal
from tests.web.served import Served

CHECKOUT = Path(__file__).parents[2]
WHEEL = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--quiet", "-w"]
LIBRARY_ALONE = """
import re, runpy, sys, tomllib
project = tomllib.load(open("{checkout}/pyproject.toml", "rb"))["project"]
for name in project["optional-dependencies"]["app"]:
    sys.modules[re.split("[<>=]", name)[0]] = None
{then}
"""
"""Python in which only what the library needs can be imported."""


def without_checkout(folder: Path) -> dict[str, str]:
    """Return surroundings in which no checkout is found."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONPATH"} | {
        "AXISCAL_LANGUAGE": "de",
        "XDG_DATA_HOME": str(folder / "data"),
    }


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The command of the wheel in an environment that has nothing else of the checkout, only what axiscal needs."""
    folder = tmp_path_factory.mktemp("wheel")
    source, surroundings = folder / "source", without_checkout(folder)
    shutil.copytree(CHECKOUT / "src", source / "src", ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
    for name in ("pyproject.toml", "LICENSE", "docs/package.md"):
        (source / name).parent.mkdir(exist_ok=True)
        shutil.copy(CHECKOUT / name, source / name)
    subprocess.run([*WHEEL, folder, source], env=surroundings, check=True)
    (wheel,) = folder.glob("axiscal-*.whl")
    with zipfile.ZipFile(wheel) as packed:
        held = set(packed.namelist())
    files = {path.relative_to(source / "src").as_posix() for path in (source / "src").rglob("*") if path.is_file()}
    made = {name for name in files if "build" in name or "egg-info" in name}
    assert files - held - made == {"axiscal_core/pyproject.toml"}
    venv.create(folder / "bare", with_pip=True)
    python = folder / "bare" / "bin" / "python"
    install = ["-m", "pip", "install", "--no-deps", "--no-index", "--quiet", str(wheel)]
    subprocess.run([python, *install], env=surroundings, check=True)
    (site,) = (folder / "bare" / "lib").glob("*/site-packages")
    # what it needs, without the hook by which the checkout is installed here: links of a path file are not followed
    (site / "needed.pth").write_text(sysconfig.get_path("purelib") + "\n")
    return folder / "bare" / "bin" / "axiscal"


@pytest.mark.long
def test_the_wheel_brings_the_program_its_page_and_its_languages(program: Path, tmp_path: Path) -> None:
    def said(*words: str) -> str:
        done = subprocess.run(
            [program, *words], cwd=tmp_path, env=without_checkout(tmp_path), capture_output=True, text=True, check=True
        )
        return done.stdout

    where = [str(program.with_name("python")), "-c", "import axiscal; print(axiscal.__file__)"]
    found = subprocess.run(where, cwd=tmp_path, env=without_checkout(tmp_path), capture_output=True, check=True)
    assert str(program.parents[1]) in found.stdout.decode()
    assert "lathe" in said("machine", "list")
    said("init", "mill", "--machine", "one-axis", "--instrument", "laser", "--target", "20 um")
    assert (tmp_path / "mill" / "campaign.toml").is_file()
    assert "MESSUNGEN" in said("plan", "mill/campaign.toml")
    serve = [str(program), "serve", "--start"]
    with subprocess.Popen(
        serve, cwd=tmp_path, env=without_checkout(tmp_path), stdout=subprocess.PIPE, text=True
    ) as page:
        try:
            assert page.stdout is not None
            address = next(word for word in page.stdout.readline().split() if word.startswith("http://"))
            served = Served(address, tmp_path, page.pid)
            for path in ("/", "/start.js", "/page.css", "/machine.svg?width=300&machine=lathe"):
                assert served.ask("GET", path, Authorization=f"Bearer {served.token}").status == 200, path
            words = served.ask("GET", "/words.json", Authorization=f"Bearer {served.token}").document
        finally:
            page.terminate()
    assert words["messages"]["Next"] == "Weiter"


def test_the_library_needs_nothing_of_the_program() -> None:
    then = f"runpy.run_path({str(CHECKOUT / 'examples' / 'story2_estimate.py')!r}, run_name='__main__')"
    done = subprocess.run(
        [sys.executable, "-c", LIBRARY_ALONE.format(checkout=CHECKOUT, then=then)],
        cwd=CHECKOUT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


def test_the_program_says_what_the_library_alone_lacks(tmp_path: Path) -> None:
    then = "from axiscal.cli import main; sys.argv[1:] = ['demo']; sys.exit(main())"
    done = subprocess.run(
        [sys.executable, "-c", LIBRARY_ALONE.format(checkout=CHECKOUT, then=then)],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 1
    assert done.stderr == (
        "axiscal: The library is installed without the program, which needs typer. "
        "Install it: pip install 'axiscal[app]'\n"
    )


@pytest.mark.long
def test_the_core_is_a_distribution_of_its_own(tmp_path: Path) -> None:
    source, alone = tmp_path / "axiscal_core", tmp_path / "alone"
    shutil.copytree(CHECKOUT / "src" / "axiscal_core", source, ignore=shutil.ignore_patterns("__pycache__"))
    subprocess.run([*WHEEL, tmp_path, source], check=True)
    (wheel,) = tmp_path.glob("axiscal_core-*.whl")
    with zipfile.ZipFile(wheel) as packed:
        packed.extractall(alone)
    (metadata,) = Distribution.discover(path=[str(alone)])
    needed = {re.split("[<>=]", each)[0] for each in metadata.requires or []}
    assert (metadata.version, needed) == (axiscal.__version__, {"numpy", "scipy", "threadpoolctl"})
    held = {path.name for path in (alone / "axiscal_core").iterdir()}
    assert held == {path.name for path in source.iterdir() if path.is_file()} - {"pyproject.toml"}
    example = CHECKOUT / "examples" / "core_camera.py"
    then = f"sys.modules['axiscal'] = None; runpy.run_path({str(example)!r}, run_name='__main__')"
    blocked = LIBRARY_ALONE.format(checkout=CHECKOUT, then=f"sys.path.insert(0, {str(alone)!r}); {then}")
    subprocess.run([sys.executable, "-c", blocked], cwd=tmp_path, check=True)
