"""Files of refusals: right texts by name; rows of what is wrong in one of them, or of a command, and what is said."""

import io
import json
import shlex
import tempfile
import tomllib
from collections.abc import Callable, Iterable, Mapping
from contextlib import chdir, redirect_stderr, redirect_stdout
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple, cast
from unittest.mock import patch

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.possible import beginning_of
from axiscal.campaign.sources import open_source
from axiscal.cli.app import run
from axiscal.description.campaign import read_campaign
from axiscal.description.first_files import of_file
from axiscal.description.ini_file import read_ini
from axiscal.description.ini_machine import machine_of
from axiscal.description.placed_readings import file_readings
from axiscal.evaluation.standards import positioning_test
from axiscal.exceptions import InputError
from axiscal.machine import load_machine, machine_from_text
from axiscal.machine.error_names import error_named
from axiscal.machine.machine_schema import parse_chain
from axiscal.measurement.readers.csv_readings import Around, read_poses
from axiscal.measurement.readers.files import read_any, recognised
from axiscal.measurement.readers.text_file import read_text
from axiscal.measurement.simulation import read_truth
from axiscal.ports.linuxcnc.configuring import export_into
from axiscal.present.guide.question import answer
from axiscal.record.lines import EventText
from axiscal.record.signing import rows_of
from axiscal.record.store import content_of
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import OldFile
from axiscal.tables.registry import export, exporter, loaded
from axiscal.tables.rewriting import rewrite
from axiscal.tables.round_trip import drawn_and_known
from axiscal.units import Dimension, parse_quantity
from tests.generators.begun import begun
from tests.generators.requests import REQUEST, SIMULATOR

FOLDER = Path(__file__).parent
BESIDE = ".toml", ".py", ".ini", ".json", ".axiscal"
"""How texts end that are files beside the others, and right."""


class Row(NamedTuple):
    """What is wrong.

    of : the name of the right text; of another name the text is `wrong` alone
    right, wrong : what is replaced, by what; where nothing is, `wrong` stands in lines behind the end
    says : class and text of the failure
    """

    of: str
    right: str
    wrong: str
    says: str


class Refusals(NamedTuple):
    """A file: right texts by their names, and its rows."""

    texts: Mapping[str, str]
    rows: tuple[Row, ...]

    def text(self, row: Row) -> str:
        """Return the wrong text."""
        if row.of not in self.texts:
            return row.wrong
        whole = self.texts[row.of]
        if not row.right:
            return f"{whole}{row.wrong}\n"
        assert whole.count(row.right) == 1, row.right
        return whole.replace(row.right, row.wrong)


def kinds() -> list[str]:
    """Return the names of the files."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


@cache
def refusals(kind: str) -> Refusals:
    """Return what a file holds."""
    found = tomllib.loads((FOLDER / f"{kind}.toml").read_text(encoding="utf-8"))
    return Refusals(found["texts"], tuple(Row(*row) for row in found["refused"]["rows"]))


def said(kind: str, of: str, text: str) -> str:
    """Return what a text gets in place of the right one; "" where it is taken."""
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        for name, right in refusals(kind).texts.items():
            if name.endswith(BESIDE):
                Path(name).write_text(right, encoding="utf-8")
        try:
            found = _READERS[kind](of, text)
        except InputError as failure:
            return f"{type(failure).__name__}: {failure}"
    return found if isinstance(found, str) else ""


def written(kind: str, rows: Iterable[Row]) -> None:
    """Write a file with these rows in place of its own."""
    path = FOLDER / f"{kind}.toml"
    head = path.read_text(encoding="utf-8").partition("rows = [")[0]
    lines = [f"  [{', '.join(map(_toml, row[:3]))},\n    {_toml(row.says)}],\n" for row in rows]
    path.write_text(f"{head}rows = [\n{''.join(lines)}]\n", encoding="utf-8")


def _toml(text: str) -> str:
    """Return a text as TOML has it, as it is wherever that can be."""
    if not all(letter.isprintable() or letter == "\n" for letter in text) or "'''" in text or text.endswith("'"):
        return json.dumps(text, ensure_ascii=False)
    if "'" in text or "\n" in text:
        return f"'''\n{text}'''" if "\n" in text else f"'''{text}'''"
    return f"'{text}'"


def _of_file(name: str, read: Callable[[Path], object]) -> Callable[[str, str], object]:
    def found(_: str, text: str) -> object:
        Path(name).write_text(text, encoding="utf-8")
        return read(Path(name))

    return found


def _old_table(of: str, text: str) -> object:
    """Read the text as a file of an old table.  of : its control and name"""
    (controller, name), texts = of.split(), refusals("old_table").texts
    options = ExportOptions(old_files=(OldFile(name, text),), template=texts[of] or None)
    return loaded(controller, machine_from_text(texts["machine.toml"]), options)


def _template(of: str, text: str) -> object:
    """Make files from a template of the control.  of : which"""
    known = drawn_and_known(machine_from_text(refusals("template").texts["machine.toml"]))
    return export(known, of, ExportOptions(template=text))


def _options(of: str, text: str) -> object:
    """Make files for a machine that is known.  of : the control and the machine; text : `ExportOptions` as TOML"""
    controller, machine = of.split()
    known = drawn_and_known(machine_from_text(refusals("options").texts[machine]))
    chosen: dict[str, Any] = tomllib.loads(text)
    numbers = {axis: tuple(joints) for axis, joints in chosen.get("numbers", {}).items()}
    old = tuple(OldFile(*each) for each in chosen.get("old_files", ()))
    return export(known, controller, ExportOptions(**{**chosen, "numbers": numbers, "old_files": old}))


def _owner(of: str, text: str) -> None:
    """Export into the LinuxCNC configuration of an owner.  of : which of his files the text is"""
    for name, each in {**refusals("owner").texts, of: text}.items():
        Path(name).write_text(each, encoding="utf-8")
    export_into(Path("mill.ini"), drawn_and_known(load_machine("machine.toml")), ExportOptions())


def _readings(of: str, text: str) -> object:
    """Place the readings of a file in a campaign.  of : the campaign and the file"""
    campaign, name = of.split()
    Path(name).write_text(text, encoding="utf-8")
    return file_readings(read_any(Path(name)), read_campaign(Path(campaign), target_needed=False, asking=False), name)


def _file(_: str, text: str) -> object:
    """Read a file of any kind beside a campaign that says where the nodes of maps lie."""
    Path("file.txt").write_text(text, encoding="utf-8")
    campaign = read_campaign(Path("campaign.toml"), target_needed=False, asking=False)
    return recognised(Path("file.txt"), Around(campaign.machine.axes, campaign.setups))


def _entry(of: str, text: str) -> object:
    """Open a campaign whose record has a reading and this entry behind it.  of : its kind; `created` is the first"""
    described = read_campaign(Path("campaign.toml"))
    rows = [*rows_of([beginning_of(described)]), EventText(_AT, "recorded", refusals("entry").texts["recorded"])]
    last = EventText(_AT, of.split()[0], text)
    Path("m.axiscal").write_bytes(content_of([last] if of == "created" else [*rows, last]))
    with Campaign.open(Path("m.axiscal")) as campaign:
        return campaign.state


def _typed(of: str, text: str) -> object:
    """Return what is understood of a line that is typed where a set-up is read.  of : the set-up"""
    return answer(text, read_campaign(Path("campaign.toml"), asking=False).setup(of))


def _rewritten(_: str, text: str) -> object:
    """Rewrite a program whose zero lies within the travels of the machine."""
    Path("part.ngc").write_text(text, encoding="utf-8")
    mill = drawn_and_known(load_machine("three-axis-mill"))
    return rewrite(read_text(Path("part.ngc")), "mm", mill, (0.25, 0.2, 0.15), 1e-6)


def _command(_: str, text: str) -> str:
    """Return what a command says that is refused, beside a campaign and its records; it changes none of them.

    `m.axiscal` has a reading, and one is asked for in `asked.axiscal`.
    """
    begun(Path(), {"c.toml": refusals("command").texts["c.toml"]}, *_BEGUN)
    before = {path: path.read_bytes() for path in Path().iterdir()}
    out, told = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(told), patch("sys.stdin", io.StringIO()):
        status = run(shlex.split(text))
    assert (status, out.getvalue()) == (1, "")
    assert {path: path.read_bytes() for path in Path().iterdir()} == before
    return " ".join(told.getvalue().split())


def _gone(of: str, text: str) -> object:
    """Use what is gone.  of : its table; keys and files are named in a campaign, as files are that lie beside it"""
    if of in ("commands", "options"):
        told = io.StringIO()
        with redirect_stderr(told):
            assert run(shlex.split(text)) == 2
        return " ".join(told.getvalue().split())
    if of == "sources":
        return open_source(text, SIMULATOR)
    if of == "controls":
        return exporter(text)
    if of == "readings":
        Path("file.txt").write_text(text, encoding="utf-8")
        return recognised("file.txt")
    Path("campaign.toml").write_text(text, encoding="utf-8")
    return read_campaign(Path("campaign.toml"))


_AT = "2026-03-01T08:00:00.000+00:00"
_BEGUN = (
    ("start", "c.toml", "m.axiscal"),
    ("record", "m.axiscal", "1 um", "--setup", "laser", "--at", "X=100 mm"),
    ("start", "c.toml", "asked.axiscal"),
    ("next", "asked.axiscal"),
)


def _answer(_: str, line: str) -> object:
    """Return what is understood of the line with which a command answers a request."""
    Path("answer").write_text(f"{line}\n", encoding="utf-8")
    source = open_source("exec:sh -c 'read asked; cat answer; cat > /dev/null'", SIMULATOR)
    try:
        return source.read(REQUEST)
    finally:
        source.close()


_READERS: Mapping[str, Callable[[str, str], object]] = {
    "answer": _answer,
    "campaign": _of_file("campaign.toml", read_campaign),
    "command": _command,
    "entry": _entry,
    "chain": lambda _, text: parse_chain(text),
    "files": _file,
    "gone": _gone,
    "error_name": lambda _, text: error_named(text),
    "ini": _of_file("machine.ini", lambda path: machine_of(read_ini(path))),
    "machine": lambda _, text: machine_from_text(text, "mill.toml"),
    "old_table": _old_table,
    "options": _options,
    "owner": _owner,
    "answers_in_a_table": _of_file("r.csv", lambda path: open_source(f"csv:{path}", SIMULATOR).read(REQUEST)),
    "poses": _of_file("poses.csv", read_poses),
    "positioning": _of_file("test.csv", lambda path: positioning_test(recognised(path))),
    "printer": _of_file("printer.cfg", lambda path: of_file(path, Path())),
    "quantity": lambda of, text: parse_quantity(text, cast("Dimension", of)),
    "readings": _readings,
    "rewritten": _rewritten,
    "source": lambda _, text: open_source(text, SIMULATOR),
    "template": _template,
    "truth": _of_file("truth.csv", read_truth),
    "typed": _typed,
}
