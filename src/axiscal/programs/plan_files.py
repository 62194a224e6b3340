"""The files of a plan: programs, their lists, the form for the values, and what must be known."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path

from axiscal.document import shown
from axiscal.document.durable import write_whole
from axiscal.document.ports import rendered
from axiscal.exceptions import ProgramError
from axiscal.measurement.readers.touch_log import LISTS, plan_code
from axiscal.measurement.reading import Place
from axiscal.measurement.setup import Setup
from axiscal.programs.dialects import dialect
from axiscal.programs.program import form, programs
from axiscal_core.machine import Machine


def write_programs(
    machine: Machine,
    setups: Sequence[Setup],
    places: Sequence[Place],
    controller: str,
    folder: str | Path,
    log: bool = False,
) -> list[Path]:
    """Write the programs of a plan to a folder and return the files. These are a program and its list for each set-up,
    then readings.csv and README.txt.  log : the programs touch the spheres themselves and write a log.
    Raises ProgramError before the first file is touched, OSError.
    """
    made = programs(machine, setups, places, dialect(controller), log)
    files = dict[str, str]()
    for program in made:
        files |= {program.file_name: program.text, f"{program.name}.csv": program.listing}
    code = plan_code([program.listing for program in made])
    _refuse_other_plan(Path(folder), LISTS.format(code), files)
    if log:
        files[LISTS.format(code)] = "".join(f"{program.name}.csv\n" for program in made)
    files["readings.csv"] = form([reading for program in made for reading in program.readings])
    files["README.txt"] = rendered("axiscal.programs", "readme.jinja", title=dialect(controller).title, made=made)
    Path(folder).mkdir(parents=True, exist_ok=True)
    paths = {Path(folder) / name: text for name, text in files.items()}
    for path, text in paths.items():
        write_whole(path, text.encode())
    return list(paths)


def _refuse_other_plan(folder: Path, own: str, files: Collection[str]) -> None:
    """Raise ProgramError where lists of another plan would be overwritten: its logs could not be read any more."""
    for other in sorted(folder.glob(LISTS.format("*"))):
        lists = other.read_text(encoding="utf-8", errors="replace").split("\n")
        if other.name != own and (taken := next((name for name in lists if name in files), None)):
            what = "{folder} holds {taken} of another plan, whose logs are read with it"
            remedy = "Write to another folder; or take out {list} if it was never run"
            raise ProgramError(what, remedy, folder=folder, taken=shown(taken), list=other.name)
