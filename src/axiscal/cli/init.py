"""`axiscal init`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from axiscal.cli.printing import say
from axiscal.cli.texts import count_text
from axiscal.description.campaign import campaign_from_texts
from axiscal.description.file_schemas import campaign_schema, machine_schema
from axiscal.description.first_campaign import OFFERED, first_campaign
from axiscal.document.quoting import shown
from axiscal.exceptions import DescriptionError, RecordError
from axiscal.machine import builtin_names, load_machine
from axiscal.units import parse_quantity

_SCHEMAS = {"machine.schema.json": machine_schema, "campaign.schema.json": campaign_schema}


def init(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder for the files; it may exist.")] = Path(),
    machine: Annotated[str | None, typer.Option(metavar="NAME", help="A built-in machine to begin with.")] = None,
    instrument: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help=f"{', '.join(OFFERED)}; may be given several times.")
    ] = None,
    target: Annotated[str | None, typer.Option(metavar="U", help='The uncertainty wanted, such as "10 um".')] = None,
) -> None:
    """Write a first machine.toml and campaign.toml, with a word on every line; ask for what is not given.

    The JSON schemas beside them let editors complete and check while you write. Nothing is written over.

    \b
    Examples:
      axiscal init mill
      axiscal init mill --machine three-axis-mill --instrument interferometer --instrument ballbar --target "20 um"
    """
    name = machine or _asked("Which built-in machine is most like yours?", builtin_names())
    chosen = instrument or _asked("Which instruments are there? Several with blanks between", OFFERED).split()
    wanted = target or _asked('How well is the tool point to be known, 95 %, such as "20 um"?', ())
    _refuse_unknown(name, chosen, wanted)
    described = load_machine(name)
    text = first_campaign(described, "machine.toml", chosen, wanted)
    setups = len(campaign_from_texts(text, "campaign.toml", described.text, "machine.toml").setups)
    files = {
        "machine.toml": f"#:schema ./machine.schema.json\n{described.text.rstrip()}\n",
        "campaign.toml": text,
        **{file: json.dumps(schema(), indent=1) + "\n" for file, schema in _SCHEMAS.items()},
    }
    _write(folder, files)
    say(
        f"{folder / 'machine.toml'}: change it to what your machine is, then: axiscal machine check machine.toml\n"
        f"{folder / 'campaign.toml'}: {count_text(setups, 'set-up')} offered; a plan takes what is worth mounting\n"
        f"Then: axiscal plan campaign.toml, axiscal start campaign.toml, axiscal measure or axiscal serve"
    )


def _asked(question: str, known: object) -> str:
    names = ", ".join(known) if isinstance(known, dict | list | tuple) else ""
    say(f"{question}{f' ({names})' if names else ''}")
    try:
        return input("> ").strip()
    except EOFError:
        remedy = "Give --machine, --instrument and --target"
        raise DescriptionError("Nobody answered", remedy) from None


def _refuse_unknown(machine: str, instruments: list[str], target: str) -> None:
    if machine not in builtin_names():
        known = ", ".join(builtin_names())
        raise DescriptionError(f"{shown(machine)} is no built-in machine", f"The built-in machines are {known}")
    for name in instruments:
        if name not in OFFERED:
            remedy = f"Offered are {', '.join(OFFERED)}; docs/campaign.md shows how the others are written"
            raise DescriptionError(f"No set-ups can be offered for {shown(name)}", remedy)
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
