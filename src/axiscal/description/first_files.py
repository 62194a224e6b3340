"""The first files of a new calibration: a machine to begin with, the instruments there are, the target."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from axiscal.description.campaign import campaign_from_texts
from axiscal.description.file_schemas import SCHEMAS
from axiscal.description.first_campaign import OFFERED, UNSAID, first_campaign
from axiscal.description.ini_machine import IniMachine
from axiscal.description.ini_text import machine_text, unread
from axiscal.document.quoting import shown
from axiscal.exceptions import DescriptionError, RecordError
from axiscal.machine import builtin_names, load_machine, machine_from_text
from axiscal.record.durable import write_whole
from axiscal.units import parse_quantity


@dataclass(frozen=True, slots=True)
class Beginning:
    """A machine to begin with.

    text : of machine.toml; active : the line of campaign.toml on compensation; look : what could not be read
    """

    text: str
    active: str = UNSAID
    look: tuple[str, ...] = ()


class FirstFiles(NamedTuple):
    """texts : by the name of their file; setups : how many are offered"""

    texts: dict[str, str]
    setups: int


def of_builtin(name: str) -> Beginning:
    """Return a built-in machine; raises DescriptionError for a name that is none."""
    _refuse_unknown("built-in machine", [name], builtin_names(), "The built-in machines are")
    return Beginning(load_machine(name).text)


def of_ini(found: IniMachine, file: Path, folder: Path, chain: str | None = None) -> Beginning:
    """Return the machine of an INI file of LinuxCNC.

    found : what the file says; folder : where the files will stand
    chain : how it is built, where the kinematics leave it open
    Raises DescriptionError for a chain that is none.
    """
    if chain is not None:
        found = replace(found, build=replace(found.build, chain=chain, said=True))
    text = machine_text(found, file.name)
    machine_from_text(text, file)
    return Beginning(text, _active(found, file, folder), tuple(unread(found)))


def _active(found: IniMachine, file: Path, folder: Path) -> str:
    """Return the line of campaign.toml on what LinuxCNC corrects while it is measured."""
    if not found.compensated:
        return "compensation_active = false      # the INI file has no COMP_FILE and no BACKLASH"
    joints = ", ".join(map(str, found.compensated))
    path = json.dumps(os.path.relpath(file, folder), ensure_ascii=False)
    return f"compensation_active = [{path}]   # tables or backlash of joint {joints}: new tables go on top of them"


def first_files(begun: Beginning, instruments: Sequence[str], target: str) -> FirstFiles:
    """Return the files of a new calibration.

    instruments : of OFFERED; target : the expanded uncertainty wanted, such as "10 um"
    Raises DescriptionError for an instrument that cannot be offered, UnitError for a target that is no length.
    """
    offered = "docs/campaign.md shows how others are written. Offered are"
    _refuse_unknown("instrument whose set-ups can be offered", instruments, OFFERED, offered)
    if not instruments:
        raise DescriptionError("No instrument was named", f"Name one or more of {', '.join(OFFERED)}")
    parse_quantity(target, "length")
    machine = _with_stylus(begun.text) if "sphere" in instruments else begun.text
    text = first_campaign(machine_from_text(machine), "machine.toml", instruments, target, begun.active)
    setups = len(campaign_from_texts(text, "campaign.toml", machine, "machine.toml").setups)
    texts = {
        "machine.toml": f"#:schema ./machine.schema.json\n{machine.rstrip()}\n",
        "campaign.toml": text,
        **{f"{name}.schema.json": json.dumps(schema(), indent=1) + "\n" for name, schema in SCHEMAS.items()},
    }
    return FirstFiles(texts, setups)


def _with_stylus(machine: str) -> str:
    """Return the text of a machine with the ball of a stylus, where it says of none."""
    if machine_from_text(machine).stylus > 0:
        return machine
    return machine.replace(
        "[tool]\n", '[tool]\nstylus = "6 mm"                # CHECK: diameter of the ball of the stylus\n', 1
    )


def write_files(folder: Path, texts: Mapping[str, str]) -> None:
    """Write files into a folder, all or none; raises RecordError where one of them is there as another already."""
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


def _refuse_unknown(what: str, names: Sequence[str], known: Sequence[str] | Mapping[str, object], remedy: str) -> None:
    for name in names:
        if name not in known:
            raise DescriptionError(f"{shown(name)} is no {what}", f"{remedy} {', '.join(known)}")
