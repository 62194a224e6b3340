"""The page on ports of one's own: its package is installed in a folder, its tests run, and people type its names."""

import importlib
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from axiscal.cli.app import run
from axiscal.exceptions import TableError
from axiscal.machine import load_machine
from axiscal.tables.registry import exporter
from axiscal.tables.round_trip import drawn_and_known, round_trip
from tests.commands import Command
from tests.docs.howtos import DOCS, files
from tests.generators.texts import campaign_text, setup_text

PAGE = DOCS / "howto" / "a-port-of-your-own.md"
CAMPAIGN = campaign_text(
    "one-axis",
    setup_text("x", "interferometer", direction="x", moves=["X"], approach="both", unknowns={"zero": "100 um"}),
    target={"readings": 12},
    usual="off",
    sure="exactly",
    compensation_active=False,
)


def installed(folder: Path, text: dict[str, str]) -> None:
    """Write the files of a package, and what an installer notes of its entry points."""
    for name, content in text.items():
        (folder / name).write_text(content, encoding="utf-8")
    groups = tomllib.loads(text["pyproject.toml"])["project"]["entry-points"]
    sections = [f"[{group}]\n" + "".join(f"{k} = {v}\n" for k, v in points.items()) for group, points in groups.items()]
    notes = folder / "axiscal_acme-1.0.dist-info"
    notes.mkdir()
    (notes / "METADATA").write_text("Metadata-Version: 2.1\nName: axiscal-acme\nVersion: 1.0\n")
    (notes / "entry_points.txt").write_text("\n".join(sections))


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The package of the page, as it is installed."""
    folder = tmp_path / "site"
    folder.mkdir()
    installed(folder, files(PAGE))
    monkeypatch.syspath_prepend(folder)
    yield folder
    for name in ("acme_control", "acme_gauge", "acme_source", "acme_words", "test_acme"):
        importlib.sys.modules.pop(name, None)  # type: ignore[attr-defined]


def test_its_own_tests_pass_and_no_file_is_long(package: Path, tmp_path: Path) -> None:
    assert all(len(text.splitlines()) <= 150 for text in files(PAGE).values())
    own = importlib.import_module("test_acme")
    own.test_the_files_correct_a_machine()
    own.test_the_files_of_the_gauge_are_read(tmp_path)


def test_people_type_its_names(package: Path, tmp_path: Path, command: Command) -> None:
    campaign, out, tables = tmp_path / "campaign.toml", tmp_path / "out", tmp_path / "tables"
    campaign.write_text(CAMPAIGN)
    assert run(["run", str(campaign), "--source", "acme:40", "--out", str(out)]) == 0
    assert run(["export", str(out / "campaign.axiscal"), "--to", "acme", "--out", str(tables)]) == 0
    rows = [line.split() for line in (tables / "X.ACM").read_text().splitlines()[1:]]
    slope = (float(rows[-1][1]) - float(rows[0][1])) / (float(rows[-1][0]) - float(rows[0][0]))
    assert slope == pytest.approx(40e-6, rel=0.1)
    assert run(["plan", str(campaign), "--readings", "2", "--gcode", "acme", "--out", str(tmp_path / "programs")]) == 0
    program = (tmp_path / "programs" / "AXISCAL_01_X.ACM").read_text().splitlines()
    assert program[-2:] == ["M5", "M30"]
    gauge = tmp_path / "gauge.txt"
    gauge.write_text("ACME GAUGE 2\nEXX\n" + "".join(f"{x} + {x / 100}\n" for x in range(0, 600, 50)))
    assert run(["estimate", str(campaign), str(gauge), "--out", str(tmp_path / "read")]) == 0
    assert "acme" in command("export", out / "campaign.axiscal", "--to", "list").printed.split()


def test_a_sign_that_is_wrong_is_seen(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (package / "acme_control.py").read_text().replace("axis.name, at, up, down", "axis.name, at, -up, -down")
    (package / "acme_control.py").write_text(text)
    with pytest.raises(TableError, match="more or less than they should"):
        round_trip(exporter("acme"), drawn_and_known(load_machine("three-axis-mill")))


BROKEN = {
    "no load": ("acme_control.py", "def load", "def lode", "acme = acme_control:Acme of axiscal.exporters cannot be"),
    "bytes": (
        "acme_control.py",
        "machine) for table",
        "machine).encode() for table",
        "A defect in acme_control, line ",
    ),
    "no end": ("acme_source.py", "def close", "def shut", "acme is a Slide, no Source"),
    "no reader": ("acme_gauge.py", "def knows", "def nose", "acme is a Gauge, no FileReader"),
}
"""What somebody may write in the files of the page, and what is said of it: who failed and where, not that we did."""


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("finished")
    (folder / "campaign.toml").write_text(CAMPAIGN)
    (folder / "gauge.txt").write_text("ACME GAUGE 2\nEXX\n0 + 0\n50 + 1\n")
    assert run(["run", str(folder / "campaign.toml"), "--source", "sim:1", "--out", str(folder / "out")]) == 0
    return folder


@pytest.mark.parametrize("slip", BROKEN)
def test_a_slip_of_its_author_is_his(
    slip: str, package: Path, finished: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, right, wrong, says = BROKEN[slip]
    text = (package / file).read_text()
    assert right in text
    (package / file).write_text(text.replace(right, wrong))
    campaign, out = str(finished / "campaign.toml"), ["--out", str(tmp_path / "out")]
    asked = {
        "acme_control.py": ["export", str(finished / "out" / "campaign.axiscal"), "--to", "acme"],
        "acme_source.py": ["run", campaign, "--source", "acme:40"],
        "acme_gauge.py": ["estimate", campaign, str(finished / "gauge.txt")],
    }
    assert run([*asked[file], *out]) == 1
    assert says in " ".join(capsys.readouterr().err.split())
    assert not [*tmp_path.glob("*.ACM")]
