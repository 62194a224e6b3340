"""`axiscal export --to program`: a part program rewritten by the estimate."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from axiscal.answers.answer_words import wrapped
from axiscal.campaign.agreement_words import agreement_words
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.possible import versions
from axiscal.cli.printing import say, say_document
from axiscal.document.durable import write_whole
from axiscal.document.ports import rendered
from axiscal.exceptions import TableError
from axiscal.language.spoken import ending, said, speaking
from axiscal.measurement.readers.text_file import read_text
from axiscal.present.result_of_campaign import record_state
from axiscal.present.result_set import result_set, write_manifest
from axiscal.tables.rewriting import rewrite
from axiscal.units import format_quantity, parse_quantity, to_unit, within
from axiscal_core.threads import one_thread

PROGRAM = "program"
_CHORD = "0.2 um"
_FINEST, _COARSEST = 1e-7, 1e-3
"""m: a decimal of a program, and more than any machine is off by."""


def rewrite_program(
    record: Path,
    program: Path | None,
    origin: str | None,
    chord: str | None,
    unit: str,
    given: Sequence[str],
    out: Path,
    anyway: bool,
    json: bool,
) -> None:
    """Write the program and its README.txt into a folder.

    unit : of lengths before G20 or G21; given : other options of the command line
    Raises TableError, ReadingError, UnitError, OSError.
    """
    other = next((option for option in given if option != "--unit"), None)
    if other is not None:
        raise TableError("{controller} does not take {option}", "leave it out", controller=PROGRAM, option=other)
    if program is None or origin is None:
        remedy = 'write --program part.ngc --origin "120 mm, 80 mm, -60 mm"'
        what = "a program is rewritten, and it is not said which, or where X, Y and Z stand at its zero"
        raise TableError(what, remedy)
    if origin.count(",") != 2:
        remedy = 'write X, Y and Z of the machine: --origin "120 mm, 80 mm, -60 mm"'
        raise TableError('"{text}" is no place', remedy, text=origin[:40])
    zero = tuple(parse_quantity(part.strip(), "length") for part in origin.split(","))
    size, file = within(chord or _CHORD, "length", _FINEST, _COARSEST), read_text(program)
    if (out / program.name).exists() and (out / program.name).samefile(program):
        raise TableError("the program itself would be overwritten", "name another folder by --out", program)
    with speaking("en"), Campaign.open(record, write=False) as campaign:  # README.txt is in English
        estimation = campaign.estimate(ended=True)
        if estimation.agreement.withheld and not anyway:
            remedy = "Take readings again, or write the program all the same with --anyway"
            raise TableError(agreement_words(estimation, record), remedy, record)
        with one_thread():
            done = rewrite(file, "in" if unit == "in" else "mm", estimation.estimate(), zero, size)
        state, manifest = record_state(campaign), "manifest-program.json"
        added, held = (format_quantity(each, "um", 3) for each in (done.added, size))
        told = {"name": program.name, "at": ", ".join(format_quantity(each, "mm", 8) for each in zero)}
        told["origin"] = f"From the record {state.file} at event {state.event}: {state.hash}"
        readme = rendered("axiscal.tables", "program.jinja", done=done, size=added, chord=held, **told)
        with result_set(out, manifest) as folder:
            write_whole(folder / program.name, ("\n".join(done.lines) + "\n").encode())
            write_whole(folder / "README.txt", readme.encode())
            write_manifest(folder, state, versions(), manifest)
    if json:
        sizes = {"rms_um_added": to_unit(done.added, "um"), "chord_um": to_unit(size, "um")}
        counts = {"motions": done.motions, "pieces": done.pieces}
        say_document({"schema": "axiscal-program/1", "file": str(out / program.name), **sizes, **counts})
        return
    what = "Against the deviation as estimated places are moved by {size} RMS, and ways are held to {chord}."
    count = said("{motions} feed motions became {pieces}.", motions=done.motions, pieces=done.pieces)
    last = {
        said("Written"): [f"{out}: {program.name}, README.txt"],
        said("Next"): [said("run it without a workpiece first, at reduced feed")],
    }
    say("\n".join([*wrapped(said(what, size=added, chord=held) + " " + count, 4), *ending(last)]))
