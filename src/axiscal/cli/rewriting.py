"""`axiscal export --to program`: a part program rewritten by the estimate."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from axiscal.answers.answer_words import wrapped
from axiscal.campaign.agreement_words import agreement_words
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.possible import versions
from axiscal.cli.printing import say, say_document
from axiscal.document.durable import write_whole
from axiscal.document.ports import rendered
from axiscal.exceptions import TableError
from axiscal.language.spoken import ending, said, speaking
from axiscal.measurement.readers.text_file import TextFile, read_text
from axiscal.present.result_of_campaign import record_state
from axiscal.present.result_set import result_set, write_manifest
from axiscal.programs.part_program import Spot, Unit
from axiscal.tables.rewriting import Rewritten, rewrite
from axiscal.units import format_quantity, parse_quantity, to_unit, within
from axiscal_core.threads import one_thread

PROGRAM = "program"
_CHORD = "0.2 um"
_FINEST, _COARSEST = 1e-7, 1e-3
"""m: a decimal of a program, and more than any machine is off by."""


class Rewriting(NamedTuple):
    """What is rewritten.  unit : of lengths before G20 or G21; origin, chord : m"""

    file: TextFile
    unit: Unit
    origin: Spot
    chord: float

    @classmethod
    def asked(
        cls, program: Path | None, origin: str | None, chord: str | None, unit: str, given: Sequence[str]
    ) -> Rewriting:
        """Return what the options of the command line say; raises TableError, ReadingError, UnitError.

        given : others
        """
        other = next((option for option in given if option != "--unit"), None)
        if other is not None:
            raise TableError("{controller} does not take {option}", "leave it out", controller=PROGRAM, option=other)
        if program is None or origin is None:
            remedy = 'write --program part.ngc --origin "120 mm, 80 mm, -60 mm"'
            what = "a program is rewritten, and it is not said which, or where X, Y and Z stand at its zero"
            raise TableError(what, remedy)
        parts = origin.split(",")
        if len(parts) != 3:
            remedy = 'write X, Y and Z of the machine: --origin "120 mm, 80 mm, -60 mm"'
            raise TableError('"{text}" is no place', remedy, text=origin[:40])
        x, y, z = (parse_quantity(part.strip(), "length") for part in parts)
        size = within(chord or _CHORD, "length", _FINEST, _COARSEST)
        return cls(read_text(program), "in" if unit == "in" else "mm", (x, y, z), size)

    def write(self, record: Path, out: Path, anyway: bool, json: bool) -> None:
        """Write the program and its README.txt into a folder; raises TableError, ReadingError, OSError."""
        path = Path(self.file.name)
        if (out / path.name).exists() and (out / path.name).samefile(path):
            raise TableError("the program itself would be overwritten", "name another folder by --out", path)
        with speaking("en"), Campaign.open(record, write=False) as campaign:  # README.txt is in English
            estimation = campaign.estimate(ended=True)
            if estimation.agreement.withheld and not anyway:
                remedy = "Take readings again, or write the program all the same with --anyway"
                raise TableError(agreement_words(estimation, record), remedy, record)
            with one_thread():
                done = rewrite(self.file, self.unit, estimation.estimate(), self.origin, self.chord)
            state, manifest = record_state(campaign), "manifest-program.json"
            origin = f"From the record {state.file} at event {state.event}: {state.hash}"
            with result_set(out, manifest) as folder:
                write_whole(folder / path.name, ("\n".join(done.lines) + "\n").encode())
                write_whole(folder / "README.txt", self._readme(done, origin).encode())
                write_manifest(folder, state, versions(), manifest)
        if json:
            say_document(self._document(done, out / path.name))
            return
        what = "Against the deviation as estimated places are moved by {size} RMS, and ways are held to {chord}."
        sizes = format_quantity(done.added, "um", 3), format_quantity(self.chord, "um", 3)
        last = {
            said("Written"): [f"{out}: {path.name}, README.txt"],
            said("Next"): [said("run it without a workpiece first, at reduced feed")],
        }
        count = said("{motions} feed motions became {pieces}.", motions=done.motions, pieces=done.pieces)
        say("\n".join([*wrapped(said(what, size=sizes[0], chord=sizes[1]) + " " + count, 4), *ending(last)]))

    def _document(self, done: Rewritten, path: Path) -> dict[str, object]:
        sizes = to_unit(done.added, "um"), to_unit(self.chord, "um")
        named = ("schema", "file", "rms_um_added", "chord_um", "motions", "pieces")
        values = ("axiscal-program/1", str(path), *sizes, done.motions, done.pieces)
        return dict(zip(named, values, strict=True))

    def _readme(self, done: Rewritten, origin: str) -> str:
        at = ", ".join(format_quantity(each, "mm", 8) for each in self.origin)
        size, chord = (format_quantity(each, "um", 3) for each in (done.added, self.chord))
        values = {"name": Path(self.file.name).name, "origin": origin, "at": at, "size": size, "chord": chord}
        return rendered("axiscal.tables", "program.jinja", done=done, **values)
