"""`axiscal init`."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, NamedTuple

import typer

from axiscal.cli.printing import say
from axiscal.cli.texts import count_text
from axiscal.description.campaign import campaign_from_texts
from axiscal.description.file_schemas import SCHEMAS
from axiscal.description.first_campaign import OFFERED, UNSAID, first_campaign
from axiscal.description.ini_file import read_ini
from axiscal.description.ini_machine import IniMachine, machine_of
from axiscal.description.ini_text import machine_text, unread
from axiscal.document.quoting import shown
from axiscal.exceptions import DescriptionError, RecordError
from axiscal.machine import builtin_names, load_machine, machine_from_text
from axiscal.units import parse_quantity


class _First(NamedTuple):
    """text : of machine.toml; active : the line of campaign.toml on compensation; look : what could not be read"""

    text: str
    active: str = UNSAID
    look: tuple[str, ...] = ()


def init(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder for the files; it may exist.")] = Path(),
    machine: Annotated[str | None, typer.Option(metavar="NAME", help="A built-in machine to begin with.")] = None,
    ini: Annotated[
        Path | None,
        typer.Option("--from", metavar="FILE.ini", help="The INI file of a LinuxCNC, instead of --machine."),
    ] = None,
    chain: Annotated[
        str | None, typer.Option(metavar="CHAIN", help='With --from: how it is built, such as "w-Y\'-b-X-Z-t".')
    ] = None,
    instrument: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help=f"{', '.join(OFFERED)}; may be given several times.")
    ] = None,
    target: Annotated[str | None, typer.Option(metavar="U", help='The uncertainty wanted, such as "10 um".')] = None,
) -> None:
    """Write a first machine.toml and campaign.toml, with a word on every line; ask for what is not given.

    From a built-in machine, or from the INI file of a LinuxCNC: axes, limits, units, speeds, kinematics with their
    pivots, joints, and whether tables or backlash are active. What the INI cannot say is marked CHECK. The JSON schemas
    beside the files let editors complete and check while you write. Nothing is written over.

    \b
    Examples:
      axiscal init mill
      axiscal init mill --machine three-axis-mill --instrument interferometer --instrument ballbar --target "20 um"
      axiscal init mill --from ~/linuxcnc/configs/mill/mill.ini --instrument ballbar --target "30 um"
    """
    if ini is not None and machine is not None:
        raise typer.BadParameter("give either --machine or --from, not both")
    if chain is not None and ini is None:
        raise typer.BadParameter("--chain belongs to --from")
    if machine is not None:
        _refuse_unknown("built-in machine", [machine], builtin_names(), "The built-in machines are")
    first = _from_ini(ini, chain, folder) if ini is not None else _built_in(machine)
    chosen = instrument or _asked("Which instruments are there? Several with blanks between", OFFERED).split()
    wanted = target or _asked('How well is the tool point to be known, 95 %, such as "20 um"?', ())
    _refuse_unsuitable(chosen, wanted)
    text = first_campaign(machine_from_text(first.text), "machine.toml", chosen, wanted, first.active)
    setups = len(campaign_from_texts(text, "campaign.toml", first.text, "machine.toml").setups)
    files = {
        "machine.toml": f"#:schema ./machine.schema.json\n{first.text.rstrip()}\n",
        "campaign.toml": text,
        **{f"{name}.schema.json": json.dumps(schema(), indent=1) + "\n" for name, schema in SCHEMAS.items()},
    }
    _write(folder, files)
    look = f"\nLook at, in machine.toml: {'; '.join(first.look)}." if first.look else ""
    say(
        f"{folder / 'machine.toml'}: change it to what your machine is, then: axiscal machine check machine.toml\n"
        f"{folder / 'campaign.toml'}: {count_text(setups, 'set-up')} offered; a plan takes what is worth mounting\n"
        f"Then: axiscal plan campaign.toml, axiscal start campaign.toml, axiscal measure or axiscal serve{look}"
    )


def _built_in(machine: str | None) -> _First:
    name = machine or _asked("Which built-in machine is most like yours?", builtin_names())
    _refuse_unknown("built-in machine", [name], builtin_names(), "The built-in machines are")
    return _First(load_machine(name).text)


def _from_ini(file: Path, chain: str | None, folder: Path) -> _First:
    """Return the machine of an INI file; what its kinematics leave open is asked where a terminal is there."""
    found = machine_of(read_ini(file))
    if chain is None and not found.build.sure and sys.stdin.isatty():
        chain = _asked(f"How is it built? Primed axes carry the workpiece; Enter for {found.build.chain}", ()) or None
    if chain is not None:
        found = replace(found, build=replace(found.build, chain=chain, sure=True))
    text = machine_text(found, file.name)
    machine_from_text(text, file)
    return _First(text, _active(found, file, folder), tuple(unread(found)))


def _active(found: IniMachine, file: Path, folder: Path) -> str:
    """Return the line of campaign.toml on what LinuxCNC corrects while it is measured."""
    if not found.compensated:
        return "compensation_active = false      # the INI file has no COMP_FILE and no BACKLASH"
    joints = ", ".join(map(str, found.compensated))
    path = json.dumps(os.path.relpath(file, folder), ensure_ascii=False)
    return f"compensation_active = [{path}]   # tables or backlash of joint {joints}: new tables go on top of them"


def _asked(question: str, known: Iterable[str]) -> str:
    names = ", ".join(known)
    say(f"{question}{f' ({names})' if names else ''}")
    try:
        return input("> ").strip()
    except EOFError:
        remedy = "Give --machine or --from, --instrument and --target"
        raise DescriptionError("Nobody answered", remedy) from None


def _refuse_unknown(what: str, names: Iterable[str], known: Iterable[str], remedy: str) -> None:
    for name in names:
        if name not in known:
            raise DescriptionError(f"{shown(name)} is no {what}", f"{remedy} {', '.join(known)}")


def _refuse_unsuitable(instruments: list[str], target: str) -> None:
    offered = "docs/campaign.md shows how others are written. Offered are"
    _refuse_unknown("instrument whose set-ups can be offered", instruments, OFFERED, offered)
    if not instruments:
        raise DescriptionError("No instrument was named", f"Name one or more of {', '.join(OFFERED)}")
    parse_quantity(target, "length")


def _write(folder: Path, files: dict[str, str]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name in files:
        if (folder / name).exists():
            raise RecordError("This file exists already", "Name another folder, or move it away", folder / name)
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
