"""`axiscal init`."""

from __future__ import annotations

import shlex
import sys
import textwrap
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TypeVar

import typer

from axiscal.cli.printing import ask, complain, say
from axiscal.description.campaign import CampaignDescription
from axiscal.description.first_campaign import Beginning, Purpose
from axiscal.description.first_files import (
    first_described,
    instruments_of,
    linear_travels,
    of_builtin,
    of_ini,
    offered_names,
    with_travels,
    write_files,
)
from axiscal.description.ini_file import read_ini
from axiscal.description.ini_machine import lacking_limits, machine_of
from axiscal.description.printer_file import is_printer_file, of_printer
from axiscal.document.file import number_or_none
from axiscal.exceptions import DescriptionError, InputError
from axiscal.language.spoken import counted, ending, listed, said
from axiscal.machine import builtin_names
from axiscal.present.answer_words import WIDTH, wrapped
from axiscal.present.row_words import row_name

_Answer = TypeVar("_Answer")
_MACHINE = "three-axis-mill"
"""What an empty answer stands for."""


def init(
    folder: Path = Path(),
    machine: str | None = None,
    ini: Path | None = None,
    chain: str | None = None,
    limits: list[str] | None = None,
    instrument: list[str] | None = None,
    target: str | None = None,
) -> None:
    """Write a first machine.toml and campaign.toml."""
    if ini is not None and machine is not None:
        raise typer.BadParameter(said("give either --machine or --from, not both"))
    if ini is None and (chain is not None or limits):
        raise typer.BadParameter(said("{option} belongs to --from", option="--limits" if chain is None else "--chain"))
    try:
        begun = _built_in(machine) if ini is None else _from_ini(ini, chain, limits or (), folder)
        begun = replace(begun, folder=folder)
        names = (instrument and instruments_of(", ".join(instrument), folder)) or _instruments(begun)
        wanted = said("How well is the tool point to be known, such as 20 um? Enter for as good as it gets")
        made = partial(first_described, begun, names)
        described = _answered(wanted, (), lambda text: made(Purpose(text))) if target is None else made(Purpose(target))
    except EOFError:
        remedy = "Give --machine or --from, --instrument and --target"
        raise DescriptionError("Nobody answered", remedy) from None
    write_files(folder, described)
    written, campaign = folder / "machine.toml", folder / "campaign.toml"
    say(said("{file}: change it to what your machine is", file=written))
    if begun.look:
        say(said("Look at, in {file}: {places}.", file=written, places="; ".join(begun.look)))
    for own in (name for name in names if ".py:" in name and Path(name).parent != Path()):
        say(said("{file} names {instrument} where it is: leave that file there.", file=campaign, instrument=own))
    one = "{file}: {count} set-up offered"
    many = "{file}: {count} set-ups offered; a plan takes what is worth mounting"
    say(counted(one, many, len(described.setups), file=campaign))
    if hidden := _hidden(described):
        text = "These set-ups do not show {rows}, however often they are read."
        say("\n".join(wrapped(said(text, rows=hidden))))
    say("\n".join(ending({said("Next"): [f"axiscal plan {shlex.quote(str(campaign))}"]})))


def _hidden(described: CampaignDescription) -> str:
    """Return the rows that a campaign wants and its set-ups cannot show, "" for none."""
    from axiscal.planning.helping import rows_shown  # only a campaign that wants rows needs a posterior

    wanted = [want.row for want in described.target.wants]
    shown = rows_shown(described, wanted) if wanted else ()
    lacking = [row for row in wanted if row not in shown]
    groups = ([row for row in lacking if row.kind == kind] for kind in dict.fromkeys(row.kind for row in lacking))
    return listed(", ", [row_name(rows[0].kind, [row.axes for row in rows]) for rows in groups])


def _built_in(machine: str | None) -> Beginning:
    """Return a built-in machine; of one that is not given its travels are asked as well."""
    if machine is not None:
        return of_builtin(machine)
    question = said("Which built-in machine is most like yours? Enter for {machine}", machine=_MACHINE)
    begun = _answered(question, builtin_names(), lambda name: of_builtin(name or _MACHINE))
    usual = linear_travels(begun)
    each = " ".join(f"{length:g}" for length in usual.values())
    question = said("How far do {axes} travel, in mm? Enter for {usual}", axes=" ".join(usual), usual=each)
    return _answered(question, (), lambda text: with_travels(begun, _lengths(usual, text)) if text else begun)


def _instruments(begun: Beginning) -> list[str]:
    def offered(text: str) -> list[str]:
        names = instruments_of(text, begun.folder) or [begun.instrument]
        first_described(begun, names, Purpose())  # refuses those that it has none for
        return names

    known = offered_names()
    question = said("Which instruments are there? Enter for {usual}", usual=known[begun.instrument])
    return _answered(question, known.values(), offered)


def _answered(question: str, known: Iterable[str], read: Callable[[str], _Answer]) -> _Answer:
    """Return what a person answers; at a terminal a refusal is shown and the question asked again.

    read : makes it of what is typed.  Raises EOFError where nobody is there.
    """
    names = ", ".join(known)
    while True:
        say(textwrap.fill(f"{question}{f' ({names})' if names else ''}", WIDTH, break_on_hyphens=False))
        try:
            return read(ask("> ").strip())
        except InputError as refusal:
            if not sys.stdin.isatty():
                raise
            complain(str(refusal))


def _lengths(axes: Collection[str], text: str) -> dict[str, float]:
    """Return how far each axis travels, mm; raises DescriptionError."""
    words = text.replace(",", " ").split()
    lengths = [number_or_none(word) or 0.0 for word in words]
    if len(lengths) != len(axes) or min(lengths) <= 0:
        what, text, count = "{text!r} are not {count} travels in mm", " ".join(words), len(axes)
        remedy, example = "Write a number for each of {axes}, such as {example}", " ".join(["400"] * count)
        raise DescriptionError(what, remedy, text=text, count=count, axes=" ".join(axes), example=example)
    return dict(zip(axes, lengths, strict=True))


def _from_ini(file: Path, chain: str | None, limits: Sequence[str], folder: Path) -> Beginning:
    """Return the machine of a file of a control; at a terminal, ask for what an INI file leaves open."""
    if is_printer_file(file):
        if limits:
            raise typer.BadParameter(said("a printer.cfg says the limits of every axis"), param_hint="--limits")
        return of_printer(file, chain)
    ini, given = read_ini(file), dict(_limits(*each.partition(" ")[::2]) for each in limits)
    asking = sys.stdin.isatty()
    if asking:
        open_ = {letter: unit for letter, unit in lacking_limits(ini).items() if letter not in given}
        for letter, unit in open_.items():
            question = said("From where to where does {axis} move, in {unit}, such as -300 0?", axis=letter, unit=unit)
            given |= [_answered(question, (), partial(_limits, letter))]
    found = machine_of(ini, given)
    if asking and chain is None and not found.sure:
        how = said("How is it built? Primed axes carry the workpiece; Enter for {chain}", chain=found.chain)
        return _answered(how, (), lambda text: of_ini(found, file, folder, text or None))
    return of_ini(found, file, folder, chain)


def _limits(letter: str, numbers: str) -> tuple[str, tuple[float, float]]:
    """Return an axis and its limits.  numbers : such as "-300 0"; raises DescriptionError"""
    match [number_or_none(word) for word in numbers.split()]:
        case [float(low), float(high)]:
            return letter.upper(), (low, high)
    remedy = 'Write the letter of the axis, the lower and the upper limit, such as "Z -300 0"'
    text = f"{letter} {numbers}".strip()
    raise DescriptionError("{text!r} is not an axis and its two limits", remedy, text=text)
