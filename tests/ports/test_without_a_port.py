"""Each port can be taken out, with what it brings: all that does not need it works, and what does says so."""

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import axiscal
import axiscal_core

PACKAGE, CORE = Path(axiscal.__file__).parent, Path(axiscal_core.__file__).parent
PROJECT = PACKAGE.parents[1] / "pyproject.toml"
WORK = (
    'init job --machine one-axis --instrument laser --target "20 um"',
    "plan job/campaign.toml",
    "step run job/campaign.toml --source sim:3 --out run",
    "step status run/campaign.axiscal",
    "export run/campaign.axiscal --to csv --out tables",
    "report run/campaign.axiscal --out report.pdf",
    "--help",
)
NEEDS = {  # and what it says without
    "grblhal": ("export run/campaign.axiscal --to grblhal", '"grblhal" is not a controller'),
    "linuxcnc": ("step run job/campaign.toml --source linuxcnc-live --out other", "is not a source"),
    "printers": ("export run/campaign.axiscal --to klipper", '"klipper" is not a controller'),
}
RUN = "import shlex, sys; from axiscal.cli.app import run; print([run(shlex.split(each)) for each in sys.argv[1:]])"


def without(port: str, folder: Path) -> None:
    """Install the package into a folder without a port, with the entry points that are left."""
    shutil.copytree(CORE, folder / "axiscal_core", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(PACKAGE, folder / "axiscal", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.rmtree(folder / "axiscal" / "ports" / port)
    groups = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]["entry-points"]
    lines = list[str]()
    for group, points in groups.items():
        lines += [f"[{group}]", *(f"{k} = {v}" for k, v in points.items() if f".ports.{port}" not in v)]
    notes = folder / "axiscal-0.dist-info"
    notes.mkdir()
    (notes / "METADATA").write_text("Metadata-Version: 2.1\nName: axiscal\nVersion: 0\n", encoding="utf-8")
    (notes / "entry_points.txt").write_text("\n".join(lines), encoding="utf-8")


def test_every_port_is_tried() -> None:
    assert set(NEEDS) == {path.parent.name for path in (PACKAGE / "ports").glob("*/__init__.py")}


@pytest.mark.long
@pytest.mark.parametrize("port", NEEDS)
def test_the_rest_works_without_a_port(port: str, tmp_path: Path) -> None:
    without(port, tmp_path / "site")
    needs, words = NEEDS[port]
    environment = os.environ | {"PYTHONPATH": str(tmp_path / "site"), "XDG_CACHE_HOME": str(tmp_path)}
    command = [sys.executable, "-c", RUN, *WORK, needs]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.stdout.splitlines()[-1] == str([0] * len(WORK) + [1]), done.stdout + done.stderr
    assert words in " ".join(done.stderr.split())
    assert "defect" not in done.stderr
