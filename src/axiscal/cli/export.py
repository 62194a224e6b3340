"""`axiscal export`: files for a control, or a part program rewritten by the estimate."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from shlex import quote

from axiscal.campaign.agreement_words import agreement_words
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.possible import versions
from axiscal.cli.printing import say, say_either
from axiscal.document.durable import write_whole
from axiscal.document.ports import part, rendered
from axiscal.exceptions import TableError
from axiscal.language.spoken import ending, joined, said, speaking
from axiscal.machine.axis import ROTARY_LETTERS
from axiscal.measurement.readers.probe_offset import place_of
from axiscal.measurement.readers.text_file import exact_text, read_text
from axiscal.present.answer_words import wrapped
from axiscal.present.delivery import introduced
from axiscal.present.findings import findings
from axiscal.present.result_of_campaign import record_state
from axiscal.present.result_set import result_set, write_manifest
from axiscal.tables import registry
from axiscal.tables.bump import bumped
from axiscal.tables.exporter import ExportOptions, informed
from axiscal.tables.loaded import read_old
from axiscal.tables.offer import Export, effect_sentence
from axiscal.tables.rewriting import rewrite
from axiscal.units import format_quantity, parse_quantity, to_unit, within

PROGRAM = "program"
_CHORD = "0.2 um"
_FINEST, _COARSEST = 1e-7, 1e-3
"""m: a decimal of a program, and more than any machine is off by."""


def export(
    record: Path,
    to: str,
    out: Path = Path("tables"),
    template: Path | None = None,
    spacing: list[str] | None = None,
    number: list[str] | None = None,
    unit: str | None = None,
    mesh: int | None = None,
    zero: str | None = None,
    probe_sign: bool = False,
    measuring_system: int = 1,
    on_top_of: list[str] | None = None,
    ini: Path | None = None,
    program: Path | None = None,
    origin: str | None = None,
    chord: str | None = None,
    anyway: bool = False,
) -> None:
    """Write compensation files for a control."""
    if to == "list":
        say("\n".join([*registry.controllers(), PROGRAM]))
        return
    options = ExportOptions(
        spacing=_spacing(spacing or []),
        unit=unit or "",
        numbers=_numbers(number or []),
        template=None if template is None else exact_text(template),
        template_name=str(template or "the template"),
        mesh=mesh,
        zero=None if zero is None else place_of(zero),
        encoder=measuring_system,
        old_files=read_old(on_top_of or ()),
    )
    given = [*([] if ini is None else ["--ini"]), *options.given]
    wanted = {"--program": program, "--origin": origin, "--chord": chord}
    if to == PROGRAM:
        if other := next((option for option in given if option != "--unit"), ""):
            raise TableError("{controller} does not take {option}", "leave it out", controller=to, option=other)
        _rewrite(record, out, program, origin, chord, unit, anyway)
        return
    given += [name for name, value in wanted.items() if value is not None]
    registry.refuse_untaken(to, given)
    with speaking("en"), Campaign.open(record, write=False) as campaign:  # README.txt is in English
        estimation = campaign.estimate(ended=True)
        described = estimation.case.description
        options = informed(options, replace(described, bumps=()) if probe_sign else described, to)
        options = replace(options, origin=record_state(campaign).hash)
        into = None if ini is None else part("linuxcnc-configuration")
        estimate = estimation.estimate()
        estimate, bump = bumped(estimate, to, registry.unstated(to)) if probe_sign else (estimate, "")
        offered = registry.export(estimate, to, options) if into is None else into(ini, estimate, options)
        offered = replace(offered, readme=f"{bump}\n{offered.readme}") if bump else offered
        doubts = [finding.text for finding in findings(estimation, ended=campaign.state.finished is not None)]
        agreement = agreement_words(estimation, record) if estimation.readings else ""
        if estimation.agreement.withheld and not anyway:
            remedy = "Take readings again, or write the files all the same with --anyway"
            raise TableError(agreement_words(estimation, record), remedy, record)
        offered = introduced(offered, campaign, agreement, doubts)
        _write(out, offered.files, offered.readme, campaign, offered.controller)
    made_from = "" if template is None else f" --template {quote(str(template))}"
    then = said("load {folder} (README.txt there), then", folder=out)
    coming = [then, f"axiscal verify {quote(str(record))} --to {to}{made_from}"]
    if not offered.worth:
        coming = [said("do not load these files: they leave no less error than there is")]
    effect = bump or effect_sentence(said("All files together"), offered.effect, offered.known)
    idle = said("The files do not move {axes}.", axes=joined(offered.idle)) if offered.idle else ""
    written = {said("Written"): [f"{out}: {', '.join([*offered.files, 'README.txt'])}"], said("Next"): coming}
    lines = [*wrapped(effect, 4), *(wrapped(idle, 4) if idle else ()), *ending(written)]
    say_either("axiscal-export/1", _document(offered, out), lines)


def _write(out: Path, files: Mapping[str, str], readme: str, campaign: Campaign, name: str) -> None:
    """Write files with their README.txt and the manifest of a name as a set; raises OSError."""
    manifest = f"manifest-{name}.json"
    with result_set(out, manifest) as folder:
        for file, text in {**files, "README.txt": readme}.items():
            write_whole(folder / file, text.encode())
        write_manifest(folder, record_state(campaign), versions(), manifest)


def _rewrite(
    record: Path,
    out: Path,
    program: Path | None,
    origin: str | None,
    chord: str | None,
    unit: str | None,
    anyway: bool,
) -> None:
    """Write a program as the estimate has it, with its README.txt; raises TableError, ReadingError, UnitError, OSError.

    origin : where the machine stands at its zero; chord : how exactly its ways are held; unit : before G20 or G21
    """
    if program is None or origin is None:
        remedy = 'write --program part.ngc --origin "120 mm, 80 mm, -60 mm"'
        what = "a program is rewritten, and it is not said which, or where X, Y and Z stand at its zero"
        raise TableError(what, remedy)
    if origin.count(",") != 2:
        remedy = 'write X, Y and Z of the machine: --origin "120 mm, 80 mm, -60 mm"'
        raise TableError('"{text}" is no place', remedy, text=origin[:40])
    x, y, z = (parse_quantity(each.strip(), "length") for each in origin.split(","))
    size, file = within(chord or _CHORD, "length", _FINEST, _COARSEST), read_text(program)
    path = out / program.name
    if path.exists() and path.samefile(program):
        raise TableError("the program itself would be overwritten", "name another folder by --out", program)
    with speaking("en"), Campaign.open(record, write=False) as campaign:  # README.txt is in English
        estimation = campaign.estimate(ended=True)
        if estimation.agreement.withheld and not anyway:
            remedy = "Take readings again, or write the program all the same with --anyway"
            raise TableError(agreement_words(estimation, record), remedy, record)
        done = rewrite(file, "in" if unit == "in" else "mm", estimation.estimate(), (x, y, z), size)
        moved, held = (format_quantity(each, "um", 3) for each in (done.added, size))
        state = record_state(campaign)
        values = {
            "name": path.name,
            "origin": f"From the record {state.file} at event {state.event}: {state.hash}",
            "at": ", ".join(format_quantity(each, "mm", 8) for each in (x, y, z)),
        }
        readme = rendered("axiscal.tables", "program.jinja", done=done, size=moved, chord=held, **values)
        _write(out, {path.name: "\n".join(done.lines) + "\n"}, readme, campaign, PROGRAM)
    what = "Against the deviation as estimated places are moved by {size} RMS, and ways are held to {chord}."
    count = said("{motions} feed motions became {pieces}.", motions=done.motions, pieces=done.pieces)
    written = {
        said("Written"): [f"{out}: {path.name}, README.txt"],
        said("Next"): [said("run it without a workpiece first, at reduced feed")],
    }
    lines = [*wrapped(said(what, size=moved, chord=held) + " " + count, 4), *ending(written)]
    sizes = {"rms_um_added": to_unit(done.added, "um"), "chord_um": to_unit(size, "um")}
    document = {"file": str(path), **sizes, "motions": done.motions, "pieces": done.pieces}
    say_either("axiscal-program/1", document, lines)


def _spacing(texts: list[str]) -> float | dict[str, float] | None:
    """Return the distance of the points of all linear axes, or of some axes by name; raises TableError, UnitError."""
    found = dict[str, float]()
    for text in texts:
        axis, _, length = text.rpartition("=")
        axis = axis.strip()
        distance = parse_quantity(length.strip(), "angle" if axis[:1] in tuple(ROTARY_LETTERS) else "length")
        if not 0 < distance < 1e3:
            raise TableError('a spacing of "{text}"', "Give a length above zero", text=text[:40])
        if axis in found:
            remedy = "Give it once"
            raise TableError("the spacing of {axes} is given twice", remedy, axes=axis or said("the linear axes"))
        found[axis] = distance
    if "" in found and len(found) > 1:
        raise TableError("a spacing is given for all linear axes and for some", 'Give it for each: --spacing "X=25 mm"')
    return found.get("", found or None)


def _numbers(texts: list[str]) -> dict[str, tuple[int, ...]]:
    """Return the numbers of axes, one for each of their joints; raises TableError."""
    wrong = next((text for text in texts if not re.fullmatch(r"[^\W_]+=[0-9]{1,3}", text)), None)
    if wrong is not None:
        raise TableError('"{text}" is not AXIS=N', "Write --number X=1", text=wrong[:40])
    found = dict[str, tuple[int, ...]]()
    for axis, number in (text.partition("=")[::2] for text in texts):
        found[axis] = (*found.get(axis, ()), int(number))
    return found


def _document(offered: Export, out: Path) -> dict[str, object]:
    sizes = dict(zip(("before", "after", "expected"), (*offered.effect, offered.expected), strict=True))
    return {
        "controller": offered.controller,
        "files": [str(out / name) for name in offered.files],
        "readme": offered.readme,
        **{f"rms_um_{name}": to_unit(size, "um") for name, size in sizes.items()},
        "tables": [
            {
                "axis": table.axis,
                "over": table.over,
                "points": len(table.positions),
                "largest_departure": to_unit(table.departure, table.fine_unit),
                "rms_std": to_unit(float((table.std**2).mean() ** 0.5), table.fine_unit),
                "shape_std": to_unit(table.shape_std, table.fine_unit),
                "unit": table.fine_unit,
                "prior_only_points": int(table.prior_only.sum()),
            }
            for table in offered.tables
        ],
    }
