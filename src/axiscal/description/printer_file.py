"""A printer.cfg of Klipper and what it includes: how a printer is built, and how far and how fast its axes travel."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from glob import glob
from pathlib import Path

from axiscal.description.first_campaign import Beginning
from axiscal.description.ini_file import IniFile, IniValue
from axiscal.description.screws import screws_text
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal.machine import load_machine, machine_from_text
from axiscal.measurement.readers.probe_offset import Beside, offset_in, offset_of, sections_in
from axiscal.measurement.readers.text_file import read_text
from axiscal.units import from_unit

Place = tuple[float, float]
_SECTION = re.compile(r"\[\s*+([^\]\s]++(?:\s++[^\]\s]++)*+)\s*+\].*")
_INCLUDED = re.compile(r"\[include\s++([^\]\s]++(?:\s++[^\]\s]++)*+)\s*+\].*")
_KEY = re.compile(r"(\w+)\s*[:=]\s*(.*)")
_REMARK = re.compile(r"\s[#;].*")
_GANTRY, _SLIDING = "w-Z'-b-Y-X-t", "w-Y'-b-Z-X-t"
_CHAINS = {
    "corexy": _GANTRY, "hybrid_corexy": _GANTRY, "cartesian": _SLIDING, "corexz": _SLIDING, "hybrid_corexz": _SLIDING
}  # fmt: skip
"""Of kinematics: the bed of most goes up and down under a gantry, that of the others slides to and fro."""


_MOST_SCREWS = 8
"""More than any bed has."""


def is_printer_file(path: Path) -> bool:
    """Return whether a file has sections of Klipper; raises ReadingError for no file."""
    sections = (_SECTION.fullmatch(line.strip()) for line in read_text(path).lines)
    return any(found[1].startswith(("stepper_", "include ")) or found[1] == "printer" for found in sections if found)


def of_printer(path: Path, chain: str | None = None) -> Beginning:
    """Return the machine of a printer.cfg of Klipper: the built-in printer with its kinematics, travels and speeds.

    chain : how it is built, where the usual one of its kinematics is not that
    Raises ReadingError for no file, DescriptionError with the line of what cannot be.
    """
    lines = list(_lines(path, path.resolve().parent))
    read, whole = _sections(path, lines), "\n".join(text for _, _, text in lines)
    if read.place("printer")[1] is None:
        for file, number, line in lines:
            if (included := _INCLUDED.fullmatch(line.strip())) and not _files(file, included[1]):
                what, remedy = "The file {name!r} that is included here is not there", "Copy it beside this one"
                raise DescriptionError(what, remedy, file, number, name=included[1])
    stated = read.needed("printer", "kinematics", "corexy")
    if stated.text not in _CHAINS:
        what = "kinematics: {name} has no axes X, Y and Z that move by themselves"
        remedy = "Known are {known}; docs/scope.md says what to use instead"
        raise stated.fail(what, remedy, name=stated.text, known=", ".join(_CHAINS))
    usual, supposed = load_machine("printer-gantry"), _CHAINS[stated.text]
    text = usual.text.replace(f'name = "{usual.name}"', f'name = "3D printer ({stated.text})"')
    text = re.sub(r'chain = "[^"]*"', lambda _: f'chain = "{chain or supposed}"', text, count=1)
    text = "name = " + text.partition("\nname = ")[2]  # what stands above are the figures of another printer
    travels = {axis: _travel(read, f"stepper_{axis.lower()}") for axis in "XYZ"}
    travels["Z"] = (max(travels["Z"][0], 0.0), travels["Z"][1])  # below the bed a probe only looks for it
    for axis, (low, high) in travels.items():
        text = stating(text, axis, "travel", f'["{low:g} mm", "{high:g} mm"]')
        for key, of, unit in (("speed", "velocity", "mm/s"), ("acceleration", "accel", "mm/s^2")):
            if found := read.get("printer", name := f"max_{'z_' * (axis == 'Z')}{of}"):
                text = stating(text, axis, key, f'"{found.number(name):g} {unit}"')
    machine_from_text(text, path)
    look = [said("the length of the tool")]
    if chain is None:
        look.append(said("which axes carry the workpiece (chain = {chain} is supposed)", chain=f'"{supposed}"'))
    return Beginning(
        f"# From {path.name} of Klipper; errors as printers usually have them.\n\n{text}",
        look=tuple(look),
        beside=offset_in(whole),
        screws=_screws(read, offset_of(sections_in(whole) or {})),
        mesh=_mesh(read, travels),
        instrument="probe",
    )


def stating(text: str, axis: str, key: str, value: str) -> str:
    """Return the text of a machine with another value of a key of an axis."""
    section = re.compile(rf"(\[axes\.{re.escape(axis)}\]\n(?:(?!\[axes).)*?{key} = )(\[[^\]]*\]|\"[^\"]*\")", re.DOTALL)
    return section.sub(lambda found: found[1] + value, text, count=1)


def _mesh(read: IniFile, travels: Mapping[str, Place]) -> Mapping[str, Place]:
    """Return what a mesh and the travels share, mm; raises DescriptionError where that is nothing."""
    stated = read.get("bed_mesh", "mesh_min"), read.get("bed_mesh", "mesh_max")
    if stated[0] is None or stated[1] is None:
        return {}
    low, high = _place(stated[0], "mesh_min"), _place(stated[1], "mesh_max")
    found = {axis: (max(low[i], travels[axis][0]), min(high[i], travels[axis][1])) for i, axis in enumerate("XY")}
    if any(ends[0] >= ends[1] for ends in found.values()):
        what, remedy = "mesh_max = {text} is not above mesh_min within the travels", "Write where the mesh ends"
        raise stated[1].fail(what, remedy, text=stated[1].text)
    return found


def _place(stated: IniValue, key: str) -> Place:
    """Return X and Y, mm; raises DescriptionError."""
    parts = [IniValue(part.strip(), stated.file, stated.line) for part in stated.text.split(",")]
    if len(parts) != 2:
        raise stated.fail("{key} = {text} is no place", "Write X and Y", key=key, text=stated.text)
    return parts[0].number(key), parts[1].number(key)


def _screws(read: IniFile, beside: Beside | None) -> str:
    """Return the screws under the bed for campaign.toml: below the probe in screws_tilt_adjust, else the nozzle.

    "" for less than three. Raises DescriptionError with the line of what is no place.
    """
    section = next((each for each in ("screws_tilt_adjust", "bed_screws") if read.get(each, "screw1")), "")
    aside = beside if beside and section == "screws_tilt_adjust" else (0.0, 0.0)
    places = dict[str, Place]()
    for number in range(1, _MOST_SCREWS + 1):
        stated, named = read.get(section, f"screw{number}"), read.get(section, f"screw{number}_name")
        if stated is None:
            break
        at = _place(stated, f"screw{number}")
        name = f"screw {number}" if named is None else named.text.replace('"', "")
        places[name] = from_unit(at[0], "mm") + aside[0], from_unit(at[1], "mm") + aside[1]
    thread = read.get(section, "screw_thread")
    return screws_text("CW-M3" if thread is None else thread.text, places) if len(places) > 2 else ""


def _lines(path: Path, folder: Path, above: Sequence[Path] = ()) -> Iterator[tuple[Path, int, str]]:
    """Yield file, number and text of each line, of included files in their place as Klipper reads them.

    folder : beyond which nothing is looked for; above : the files that include this one
    What is not there is left out: macros are of no use here.
    """
    within = (*above, path.resolve())
    for number, line in enumerate(read_text(path).lines, start=1):
        yield path, number, line
        if included := _INCLUDED.fullmatch(line.strip()):
            for file in _files(path, included[1]):
                if file.resolve().is_relative_to(folder) and file.resolve() not in within:
                    yield from _lines(file, folder, within)


def _files(path: Path, pattern: str) -> list[Path]:
    return [Path(found) for found in sorted(glob(str(path.parent / pattern)))]


def _sections(path: Path, lines: Iterable[tuple[Path, int, str]]) -> IniFile:
    read, section = IniFile(path), ""
    for file, number, raw in lines:
        line = raw.rstrip()
        if line.startswith(("#", ";")):
            continue
        if found := _SECTION.fullmatch(line):
            section = found[1]
        elif key := _KEY.fullmatch(line):
            value = IniValue(_REMARK.sub("", f" {key[2]}").strip(), file, number)
            read.values.setdefault((section, key[1]), []).insert(0, value)  # Klipper heeds the last
    return read


def _travel(read: IniFile, section: str) -> Place:
    """Return the lower and the upper end, mm; raises DescriptionError where the latter is not above."""
    low, high = read.get(section, "position_min"), read.needed(section, "position_max", "235")
    ends = 0.0 if low is None else low.number("position_min"), high.number("position_max")
    if not max(ends[0], 0.0) < ends[1]:
        raise high.fail(
            "position_max of {section} is {high:g}", "Write where the axis ends", section=section, high=ends[1]
        )
    return ends
