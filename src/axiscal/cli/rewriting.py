"""`axiscal export --to program`: a part program rewritten by the estimate."""

from __future__ import annotations

from pathlib import Path

from axiscal.campaign.agreement_words import agreement_words
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.possible import versions
from axiscal.cli.printing import say, say_document
from axiscal.document.durable import write_whole
from axiscal.document.ports import rendered
from axiscal.exceptions import TableError
from axiscal.language.spoken import ending, said, speaking
from axiscal.measurement.readers.text_file import read_text
from axiscal.present.answer_words import wrapped
from axiscal.present.result_of_campaign import record_state
from axiscal.present.result_set import result_set, write_manifest
from axiscal.tables.rewriting import rewrite
from axiscal.units import format_quantity, parse_quantity, to_unit, within
from axiscal_core.threads import one_thread

PROGRAM = "program"
_CHORD = "0.2 um"
_FINEST, _COARSEST = 1e-7, 1e-3
"""m: a decimal of a program, and more than any machine is off by."""


def write_program(
    record: Path,
    out: Path,
    program: Path | None,
    origin: str | None,
    chord: str | None,
    unit: str | None,
    anyway: bool,
    json: bool,
) -> None:
    """Write a program and its README.txt into a folder; raises TableError, ReadingError, UnitError, OSError.

    origin : where the machine stands at its zero; chord : how exactly its ways are held; unit : before G20 or G21
    """
    if program is None or origin is None:
        remedy = 'write --program part.ngc --origin "120 mm, 80 mm, -60 mm"'
        what = "a program is rewritten, and it is not said which, or where X, Y and Z stand at its zero"
        raise TableError(what, remedy)
    parts = origin.split(",")
    if len(parts) != 3:
        remedy = 'write X, Y and Z of the machine: --origin "120 mm, 80 mm, -60 mm"'
        raise TableError('"{text}" is no place', remedy, text=origin[:40])
    x, y, z = (parse_quantity(part.strip(), "length") for part in parts)
    size, file = within(chord or _CHORD, "length", _FINEST, _COARSEST), read_text(program)
    path = out / program.name
    if path.exists() and path.samefile(program):
        raise TableError("the program itself would be overwritten", "name another folder by --out", program)
    with speaking("en"), Campaign.open(record, write=False) as campaign:  # README.txt is in English
        estimation = campaign.estimate(ended=True)
        if estimation.agreement.withheld and not anyway:
            remedy = "Take readings again, or write the program all the same with --anyway"
            raise TableError(agreement_words(estimation, record), remedy, record)
        with one_thread():
            done = rewrite(file, "in" if unit == "in" else "mm", estimation.estimate(), (x, y, z), size)
        moved, held = (format_quantity(each, "um", 3) for each in (done.added, size))
        state, manifest = record_state(campaign), "manifest-program.json"
        values = {
            "name": path.name,
            "origin": f"From the record {state.file} at event {state.event}: {state.hash}",
            "at": ", ".join(format_quantity(each, "mm", 8) for each in (x, y, z)),
        }
        readme = rendered("axiscal.tables", "program.jinja", done=done, size=moved, chord=held, **values)
        with result_set(out, manifest) as folder:
            write_whole(folder / path.name, ("\n".join(done.lines) + "\n").encode())
            write_whole(folder / "README.txt", readme.encode())
            write_manifest(folder, state, versions(), manifest)
    if json:
        sizes = {"rms_um_added": to_unit(done.added, "um"), "chord_um": to_unit(size, "um")}
        counts = {"motions": done.motions, "pieces": done.pieces}
        say_document({"schema": "axiscal-program/1", "file": str(path), **sizes, **counts})
        return
    what = "Against the deviation as estimated places are moved by {size} RMS, and ways are held to {chord}."
    last = {
        said("Written"): [f"{out}: {path.name}, README.txt"],
        said("Next"): [said("run it without a workpiece first, at reduced feed")],
    }
    count = said("{motions} feed motions became {pieces}.", motions=done.motions, pieces=done.pieces)
    say("\n".join([*wrapped(said(what, size=moved, chord=held) + " " + count, 4), *ending(last)]))
