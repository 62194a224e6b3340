"""`axiscal init`."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from axiscal.cli.printing import ask, say
from axiscal.cli.texts import count_text
from axiscal.description.first_campaign import OFFERED
from axiscal.description.first_files import (
    Beginning,
    first_files,
    linear_travels,
    of_builtin,
    of_ini,
    with_travels,
    write_files,
)
from axiscal.description.ini_file import read_ini
from axiscal.description.ini_machine import lacking_limits, machine_of
from axiscal.exceptions import DescriptionError
from axiscal.machine import builtin_names

_MACHINE, _INSTRUMENT, _TARGET = "three-axis-mill", "dial", "20 um"
"""What an empty answer stands for."""


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
    limits: Annotated[
        list[str] | None,
        typer.Option(metavar="LIMITS", help='With --from: of an axis that the file leaves open, such as "Z -300 0".'),
    ] = None,
    instrument: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help=f"{', '.join(OFFERED)}; may be given several times.")
    ] = None,
    target: Annotated[str | None, typer.Option(metavar="U", help='The uncertainty wanted, such as "10 um".')] = None,
) -> None:
    """Write a first machine.toml and campaign.toml.

    Every line has a word of explanation; the command asks for what is not given. From a built-in machine, or from the
    INI file of a LinuxCNC: axes, limits, units, speeds, kinematics with their pivots, joints, and whether tables or
    backlash are active. What the INI cannot say is marked CHECK. The JSON schemas beside the files let editors complete
    and check while you write. Nothing is written over.

    \b
    Examples:
      axiscal init mill
      axiscal init mill --machine three-axis-mill --instrument interferometer --instrument ballbar --target "20 um"
      axiscal init mill --from ~/linuxcnc/configs/mill/mill.ini --instrument ballbar --target "30 um"
    """
    if ini is not None and machine is not None:
        raise typer.BadParameter("give either --machine or --from, not both")
    if ini is None and (chain is not None or limits):
        raise typer.BadParameter(f"{'--limits' if chain is None else '--chain'} belongs to --from")
    begun = _built_in(machine) if ini is None else _from_ini(ini, chain, limits or (), folder)
    which = f"Which instruments are there? Several with blanks between; Enter for {_INSTRUMENT}"
    names = instrument or _asked(which, OFFERED).replace(",", " ").split() or [_INSTRUMENT]
    wanted = target or _asked(f"How well is the tool point to be known, 95 %? Enter for {_TARGET}", ()) or _TARGET
    files = first_files(begun, names, wanted)
    write_files(folder, files.texts)
    look = f"\nLook at, in machine.toml: {'; '.join(begun.look)}." if begun.look else ""
    setups = count_text(files.setups, "set-up")
    machine_file, campaign = folder / "machine.toml", folder / "campaign.toml"
    say(
        f"{machine_file}: change it to what your machine is, then: axiscal machine check {machine_file}\n"
        f"{campaign}: {setups} offered; a plan takes what is worth mounting\n"
        f"Then: axiscal plan {campaign}, axiscal start {campaign}, axiscal measure or axiscal serve{look}"
    )


def _built_in(machine: str | None) -> Beginning:
    """Return a built-in machine; of one that is not given its travels are asked as well."""
    if machine is not None:
        return of_builtin(machine)
    question = f"Which built-in machine is most like yours? Enter for {_MACHINE}"
    begun = of_builtin(_asked(question, builtin_names()) or _MACHINE)
    usual = linear_travels(begun)
    each = " ".join(f"{length:g}" for length in usual.values())
    words = _asked(f"How far do {' '.join(usual)} travel, in mm? Enter for {each}", ()).replace(",", " ").split()
    return with_travels(begun, _lengths(list(usual), words)) if words else begun


def _lengths(axes: Sequence[str], words: Sequence[str]) -> dict[str, float]:
    """Return how far each axis travels, mm; raises DescriptionError."""
    try:
        lengths = [float(word) for word in words]
    except ValueError:
        lengths = []
    if len(lengths) != len(axes) or not all(math.isfinite(length) and length > 0 for length in lengths):
        what, text, count = "{text!r} are not {count} travels in mm", " ".join(words), len(axes)
        remedy, example = "Write a number for each of {axes}, such as {example}", " ".join(["400"] * count)
        raise DescriptionError(what, remedy, text=text, count=count, axes=" ".join(axes), example=example)
    return dict(zip(axes, lengths, strict=True))


def _from_ini(file: Path, chain: str | None, limits: Sequence[str], folder: Path) -> Beginning:
    """Return the machine of an INI file; at a terminal, ask for what it leaves open."""
    ini, given = read_ini(file), dict(map(_limits, limits))
    asking = sys.stdin.isatty()
    if asking:
        open_ = {letter: unit for letter, unit in lacking_limits(ini).items() if letter not in given}
        for letter, unit in open_.items():
            words = _asked(f"From where to where does {letter} move, in {unit}, such as -300 0?", ())
            given |= [_limits(f"{letter} {words}")]
    found = machine_of(ini, given)
    if asking and chain is None and not found.build.sure:
        chain = _asked(f"How is it built? Primed axes carry the workpiece; Enter for {found.build.chain}", ()) or None
    return of_ini(found, file, folder, chain)


def _limits(text: str) -> tuple[str, tuple[float, float]]:
    """Return the axis and its limits of a text such as "Z -300 0"."""
    letter, *numbers = text.split() or [""]
    try:
        low, high = map(float, numbers)
    except ValueError:
        low = high = math.nan
    if not (math.isfinite(low) and math.isfinite(high)):
        remedy = 'Write the letter of the axis, the lower and the upper limit, such as "Z -300 0"'
        raise DescriptionError("{text!r} is not an axis and its two limits", remedy, text=text)
    return letter.upper(), (low, high)


def _asked(question: str, known: Iterable[str]) -> str:
    names = ", ".join(known)
    say(f"{question}{f' ({names})' if names else ''}")
    try:
        return ask("> ").strip()
    except EOFError:
        raise DescriptionError("Nobody answered", "Give --machine or --from, --instrument and --target") from None
