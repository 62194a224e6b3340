"""The first files of a new calibration: a machine to begin with, the instruments there are, the target."""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import fields, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.description.first_campaign import OFFERED, UNSAID_OFFSET, Beginning, Purpose, first_campaign
from axiscal.description.ini_file import read_ini
from axiscal.description.ini_machine import IniMachine, machine_of
from axiscal.description.printer_file import is_printer_file, of_printer, stating
from axiscal.document import ports
from axiscal.document.durable import write_whole
from axiscal.document.quoting import shown, toml_value
from axiscal.exceptions import DescriptionError, InputError, RecordError
from axiscal.language.spoken import LANGUAGES, said, speaking
from axiscal.machine import builtin_names, load_machine, machine_from_text
from axiscal.machine.axis import letter_direction
from axiscal.measurement.instruments.written import PORTS
from axiscal.measurement.readers.files import title_of
from axiscal.measurement.readers.text_file import read_text
from axiscal.units import format_quantity, from_unit, parse_quantity, to_unit

_OF_LINUXCNC = re.compile(r"\s*\[(EMC|TRAJ|KINS|(AXIS|JOINT)_\w)\]")
"""A section that others do not have."""
_AND = re.compile(r",|\s(?:and|und)\s")


def offered_names(folder: Path | None = None) -> dict[str, str]:
    """Return how each instrument that is offered is called in the language that is spoken, by its name.

    folder : whose files of Python hold more of them
    """
    named = {name: said(offer.words).partition(",")[0] for name, offer in OFFERED.items()}
    own = [] if folder is None else _written_in(folder)
    return named | {name: name for name in (*ports.names(PORTS), *own)}


def _written_in(folder: Path) -> list[str]:
    """Return the instruments that somebody wrote into a folder, as a campaign names them; no file is run."""
    found = list[str]()
    for file in sorted(folder.glob("*.py")):
        with suppress(SyntaxError, ValueError):  # no Python, or no text
            classes = [each for each in ast.parse(file.read_bytes()).body if isinstance(each, ast.ClassDef)]
            pairs = [(each, {ast.unparse(base).rpartition(".")[2] for base in each.bases}) for each in classes]
            found += [f"{file.name}:{each.name}" for each, bases in pairs if "Instrument" in bases]
    return found


def instruments_of(text: str, folder: Path = Path()) -> list[str]:
    """Return the instruments that a person names; raises DescriptionError for a word that is none.

    They are of `OFFERED`, brought by packages, or files as in `grid.py:Grid`.
    folder : of the campaign, in which a file is sought that is not where the person is
    """
    names, found, brought = _by_word(), list[str](), ports.names(PORTS)
    for part in filter(None, map(str.strip, _AND.split(text))):
        own = part in brought or ".py:" in part
        name = _named_from(folder, part) if own else names.get(_unspaced(part))
        if name is None:
            what = "{name} is no instrument whose set-ups can be offered"
            remedy = "docs/campaign.md shows how others are written. Offered are {known}"
            raise DescriptionError(what, remedy, name=shown(part), known=", ".join(offered_names().values()))
        found.append(name)
    return list(dict.fromkeys(found))


def _named_from(folder: Path, instrument: str) -> str:
    """Return how a campaign in a folder names an instrument of a file, which is sought here, and then there."""
    file, _, made = instrument.rpartition(":")
    if not file or ((folder / file).is_file() and not Path(file).is_file()):
        return instrument
    return f"{Path(os.path.relpath(file, folder)).as_posix()}:{made}"


def _by_word() -> dict[str, str]:
    """Return the instrument of each word for it, in all of the languages, without blanks and hyphens."""
    found = {_unspaced(name): name for name in OFFERED}
    for language in LANGUAGES:
        with speaking(language):
            found |= {_unspaced(word): name for name, each in OFFERED.items() for word in said(each.words).split(",")}
    return found


def _unspaced(words: str) -> str:
    return words.casefold().replace(" ", "").replace("-", "")


def of_builtin(name: str) -> Beginning:
    """Return a built-in machine; raises DescriptionError for a name that is none."""
    if name not in builtin_names():
        what, remedy = "{name} is no built-in machine", "The built-in machines are {known}"
        raise DescriptionError(what, remedy, name=shown(name), known=", ".join(builtin_names()))
    return Beginning(load_machine(name).text)


def of_ini(found: IniMachine, file: Path, folder: Path, chain: str | None = None) -> Beginning:
    """Return the machine of an INI file of LinuxCNC.

    found : what the file says; folder : where the files will stand
    chain : how it is built, where the kinematics leave it open
    Raises DescriptionError for a chain that is none.
    """
    if chain is not None:
        found = replace(found, chain=chain, said=True)
    text = machine_text(found, file.name)
    machine_from_text(text, file)
    return Beginning(text, _active(found, file, folder), tuple(unread(found)))


def of_file(file: Path, folder: Path) -> Beginning:
    """Return the machine of a file of a control: the INI of a LinuxCNC, or a printer.cfg.

    folder : where the files will stand
    Raises ReadingError for no text, DescriptionError for another file, and with the line of what cannot be.
    """
    if is_printer_file(file):
        return of_printer(file)
    if not any(map(_OF_LINUXCNC.match, read_text(file).lines)):
        if kind := title_of(file):
            remedy = "Begin a campaign here; axiscal data estimate takes it with this file"
            raise DescriptionError("These are readings: {kind}", remedy, file, kind=said(kind))
        remedy = "Give the INI file of a LinuxCNC, or the printer.cfg of a Klipper"
        raise DescriptionError("This is no file of a control", remedy, file)
    return of_ini(machine_of(read_ini(file)), file, folder)


def of_text(text: str, name: str) -> Beginning:
    """Return the machine of the text of a file that stands elsewhere.  name : of the file; raises as `of_file`"""
    with _as_file(text, name) as file:
        try:
            return of_file(file, file.parent)
        except InputError as failure:
            raise failure.placed(name, failure.line) from failure


def readings_in(text: str, name: str) -> str:
    """Return what readings in the text of a file are called, "" where it is one of a control, or holds none."""
    with _as_file(text, name) as file, suppress(InputError):
        return "" if is_printer_file(file) or any(map(_OF_LINUXCNC.match, text.splitlines())) else title_of(file)
    return ""


@contextmanager
def _as_file(text: str, name: str) -> Iterator[Path]:
    with TemporaryDirectory() as folder:
        file = Path(folder) / name
        file.write_text(text, encoding="utf-8")
        yield file


def with_travels(begun: Beginning, lengths: Mapping[str, float]) -> Beginning:
    """Return a machine whose linear axes travel so far, mm: up to zero where they end there, else from below."""
    text = begun.text
    for axis in machine_from_text(begun.text).axes:
        if axis.name in lengths:
            low, high = (to_unit(end, "mm") for end in axis.travel)
            low, high = (-lengths[axis.name], 0.0) if high == 0 else (low, low + lengths[axis.name])
            text = stating(text, axis.name, "travel", f'["{low:g} mm", "{high:g} mm"]')
            if lengths[axis.name] < to_unit(axis.length, "mm"):  # the lengths of its errors are the usual ones then
                text = re.sub(rf'^(E[XYZABC]{axis.name} = .*), length = "[^"]*"', r"\1", text, flags=re.MULTILINE)
    return replace(begun, text=text)


SIZES = {"new": 0.5, "used": 1.0, "home-made": 3.0}
"""Sizes of errors beside those of a built-in machine; readings teach the sizes, so that a rough factor does."""


def with_errors_times(begun: Beginning, factor: float) -> Beginning:
    """Return a machine whose errors are so many times as large."""
    size = re.compile(r'\b(std|rest) = "([\d.]+) ')
    return replace(begun, text=size.sub(lambda found: f'{found[1]} = "{factor * float(found[2]):.3g} ', begun.text))


def with_carriers(begun: Beginning, switched: Collection[str]) -> Beginning:
    """Return a machine some axes of which carry the workpiece instead of the tool, or the other way round.

    switched : their names; each then moves next to the bed
    """
    axes = machine_from_text(begun.text).axes
    work, tool = ([axis.name for axis in axes if axis.workpiece_side is side] for side in (True, False))
    work, tool = (
        [name for name in work if name not in switched] + [name for name in tool if name in switched],
        [name for name in work if name in switched] + [name for name in tool if name not in switched],
    )
    chain = "-".join(["w", *(f"{name}'" for name in work), "b", *tool, "t"])
    return replace(begun, text=re.sub(r'chain = "[^"]*"', lambda _: f'chain = "{chain}"', begun.text, count=1))


def linear_travels(begun: Beginning) -> dict[str, float]:
    """Return how far each linear axis travels, mm."""
    axes = machine_from_text(begun.text).axes
    lengths = {axis.name: to_unit(axis.length, "mm") for axis in axes if not axis.rotary}
    return dict(sorted(lengths.items()))


def _active(found: IniMachine, file: Path, folder: Path) -> str:
    """Return the line of campaign.toml on what LinuxCNC corrects while it is measured."""
    if not found.compensated:
        return "compensation_active = false      # the INI file has no COMP_FILE and no BACKLASH"
    joints = ", ".join(map(str, found.compensated))
    path = toml_value(os.path.relpath(file, folder))
    return f"compensation_active = [{path}]   # tables or backlash of joint {joints}: new tables go on top of them"


def first_described(begun: Beginning, instruments: Sequence[str], purpose: Purpose) -> CampaignDescription:
    """Return the campaign of a new calibration.

    instruments : of OFFERED
    Raises DescriptionError where there is none, UnitError for a target that is no length.
    """
    if not instruments:
        raise DescriptionError(
            "No instrument was named", "Name one or more of {known}", known=", ".join(offered_names().values())
        )
    if purpose.target:
        parse_quantity(purpose.target, "length")
    machine = f"{_with_sizes(begun.text, instruments).rstrip()}\n"
    text = first_campaign(machine_from_text(machine), instruments, purpose, begun.active)
    if begun.beside is not None:
        x, y = (format_quantity(each, "mm", 6) for each in begun.beside)
        text = text.replace(UNSAID_OFFSET, f'offset = ["{x}", "{y}", "0 mm"]', 1)
    if begun.mesh:
        ends = ", ".join(f'{axis} = ["{low:g} mm", "{high:g} mm"]' for axis, (low, high) in begun.mesh.items())
        text = _REACHED.sub(f"reach = {{ {ends} }}", text, count=1)
    if "probe" in instruments:
        text += begun.screws
    try:
        return campaign_from_texts(text, str(begun.folder / "campaign.toml"), machine, "machine.toml", anew=True)
    except InputError as fault:  # it stands in a file that nobody has
        what = "What is usual of {instruments} cannot be read on this machine: {fault}"
        raise DescriptionError(what, fault.remedy, instruments=", ".join(instruments), fault=fault.what) from None


_REACHED = re.compile(r"reach = \{.*\}(?=   # CHECK: where the probe reaches)")


_HEAD = 'head = ["130 mm", "130 mm"]    # CHECK: diameter and height of the spindle nose with what carries it'
_STYLUS = """stylus = "6 mm"                # CHECK: diameter of the ball of the stylus
reach = "50 mm"                # CHECK: how far the stylus stands free below the body of the probe"""


def _with_sizes(machine: str, instruments: Sequence[str]) -> str:
    """Return the text of a machine with stylus and spindle nose, where it says nothing of them and balls are read."""
    known = machine_from_text(machine)
    lacking = [_STYLUS] if "sphere" in instruments and known.nose.stylus <= 0 else []
    lacking += [_HEAD] if not known.nose.head and {"sphere", "ballbar"} & set(instruments) else []
    return machine.replace("[tool]\n", "\n".join(["[tool]", *lacking, ""]), 1)


def write_files(folder: Path, described: CampaignDescription) -> None:
    """Write both files into a folder, or none; raises RecordError where one of them is there as another already."""
    texts = {"machine.toml": described.machine.text, "campaign.toml": described.text}
    folder.mkdir(parents=True, exist_ok=True)
    new = {folder / name: text.encode() for name, text in texts.items()}
    for path in [path for path in new if path.exists()]:
        if not path.is_file() or path.read_bytes() != new.pop(path):
            raise RecordError("This file exists already", "Name another folder, or move it away", path)
    with ExitStack() as undone:
        for path, content in new.items():
            undone.callback(path.unlink, missing_ok=True)
            write_whole(path, content)
        undone.pop_all()


def machine_text(machine: IniMachine, source: str) -> str:
    """Return the text of machine.toml.  source : the INI file, as it is named"""
    units = {"from_unit": from_unit, "to_unit": to_unit}
    rendering = ports.templates(
        "axiscal.description",
        plain=lambda text: "".join(each if each.isprintable() else " " for each in text),  # ends no line of remarks
        toml=toml_value,
        number=lambda value: f"{float(value) + 0.0:.9g}",
        direction=letter_direction,
        **units,
    )
    values = {each.name: getattr(machine, each.name) for each in fields(machine)}
    return rendering.get_template("machine.jinja").render(values, source=source)


def unread(machine: IniMachine) -> list[str]:
    """Return in sentences what the INI file could not say and was supposed, for the person to look at."""
    found = [said("the length of the tool")]
    if not (machine.sure or machine.said):
        chain = f'"{machine.chain}"'
        found.append(said("which axes carry the workpiece (chain = {chain} is supposed)", chain=chain))
    if any(axis.rotary for axis in machine.axes) and not machine.sure:
        found.append(said("where the rotary axes lie (origin)"))
    if any(axis.rotary and axis.letter not in machine.reversed for axis in machine.axes):
        found.append(said("which way the rotary axes count (direction)"))
    return found
