"""An export into the owner's LinuxCNC configuration: checked against it, patched, undoable.

`configured` holds his INI file beside the description: what has to agree, what follows from it, and his files.

`joint.N.motor-pos-cmd` and `joint.N.motor-pos-fb` change places with `axiscal-vcomp.drive-N` and `.encoder-N` in his
net lines: his signals and his hardware stay as they are named. The component is loaded first, its functions stand
beside those of motion, and what else it needs is joined last.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path

from axiscal.description.ini_file import IniFile, read_ini
from axiscal.description.ini_machine import BELTS, IniMachine, machine_of
from axiscal.document.ports import rendered
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.language.spoken import said
from axiscal.measurement.readers.text_file import exact_text
from axiscal.ports.linuxcnc.volumetric_tables import HAL_FILE, LOADRT
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.offer import Export
from axiscal.tables.registry import export
from axiscal.units import format_quantity, from_unit
from axiscal_core.machine import Machine

_APART = 1e-6
"""m or rad: places nearer than a micrometre are one."""
_LOAD_FILE, _JOIN_FILE, _APPLY, _UNDO = "axiscal-load.hal", "axiscal-join.hal", "apply.sh", "undo.sh"
_TEMPLATES = "axiscal.ports.linuxcnc"
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,120}")
_TABLE_KEYS = ("COMP_FILE", "COMP_FILE_TYPE", "BACKLASH")
_FUNCTION = re.compile(r"\s*addf\s+(motion-command-handler|motion-controller)\s+(\S+)(?:\s+-?\d+)?\s*(#.*)?")
_ARROWS = {"=>", "<=", "<=>"}
_OLD_WORDS = re.compile(r"\s*(linkps|linksp|linkpp|newsig|unlinkp)\b")
_BY_HAND = "wire it by hand: axiscal-volumetric.hal, written without --ini, says how"


def export_into(ini: Path, estimate: Estimate, options: ExportOptions) -> Export:
    """Return the files of the component with those of a configuration; raises InputError."""
    found = configured(ini)
    refuse_other_machine(found, estimate.machine)
    offered = export(estimate, "linuxcnc-volumetric", options_of(found, options))
    patched, tables = found.patched()
    beside = [name for name in offered.files if name.endswith(".vcomp")]
    files = {name: text for name, text in offered.files.items() if name != HAL_FILE}
    files |= patched | scripts(found.files, patched, beside)
    lines = "line" if tables == 1 else "lines"
    taken = f" {tables} {lines} of COMP_FILE and BACKLASH taken out." if tables else ""
    note = (
        f"INTO YOUR CONFIGURATION: stop LinuxCNC, then sh {_APPLY} FOLDER (of {ini.name}); back again: "
        f"sh {_UNDO} FOLDER. Both refuse where a file is not the one that was read. The files as they were are "
        f"kept in its folder before-axiscal.{taken}"
    )
    kept = [line for line in offered.readme.split("\n") if not line.startswith(f"- Put {beside[0]} and ")]
    notes = "\n".join([note, *to_mind(found, estimate.machine)])
    readme = "\n".join(kept).replace("\nThese files hold ", f"\n{notes}\nThese files hold ", 1)
    return replace(offered, files=files, readme=readme)


@dataclass(frozen=True, slots=True)
class Configured:
    """A LinuxCNC as its files have it.

    machine : what the INI says; files : the INI and its HAL files by name, in the order in which they run
    """

    ini: IniFile
    machine: IniMachine
    files: Mapping[str, str]

    def patched(self) -> tuple[dict[str, str], int]:
        """Return the files with the component in them, and how many lines of tables and backlash were taken out.

        Raises TableError with file and line for what has to be done by hand.
        """
        joints = {number: axis.letter for axis in self.machine.axes for number in axis.joints}
        files, nets, threads = dict(self.files), dict[str, str](), dict[str, str]()
        for name in files:
            if not _NAME.fullmatch(name):
                remedy = "rename the file: letters, digits, . _ -"
                raise TableError("{name!r} is no name that a script can copy", remedy, name=name[:60])
        hal = [name for name in files if name != self.ini.path.name]
        for name in hal:
            files[name] = _with_functions(name, files[name], nets, threads)
        if len(threads) < 2 or len(set(threads.values())) > 1:
            what = (
                "no addf lines of motion-command-handler and motion-controller, in one thread, stand in the HAL files"
            )
            raise TableError(what, _BY_HAND, self.ini.path.name)
        for joint in joints:  # in each net line where a pin stands: delsig may part it from one
            for pin, other in (("motor-pos-cmd", "drive"), ("motor-pos-fb", "encoder")):
                line = re.compile(rf"^(\s*net\s[^#\n]*?\s)joint\.{joint}\.{pin}(?=\s|$)", re.MULTILINE)
                changed = {name: line.sub(rf"\g<1>axiscal-vcomp.{other}-{joint}", files[name]) for name in hal}
                if all(files[name] == text for name, text in changed.items()):
                    what = "no net line of the HAL files joins {pin}"
                    raise TableError(what, _BY_HAND, self.ini.path.name, pin=f"joint.{joint}.{pin}")
                files |= changed
        files[self.ini.path.name], tables = self._ini(files)
        letters = "".join(joints.get(number, "_") for number in range(max(joints) + 1))  # the kinematics' own order
        load = LOADRT.replace('"coordinates=[TRAJ]COORDINATES"', f"coordinates={letters}")
        load += " belts=1" if self.machine.kinematics == BELTS else ""
        files[_LOAD_FILE] = f"# Made by axiscal: the component, before anything is joined to it.\n{load}\n"
        joined = {"joints": sorted(joints), "nets": nets, "thread": next(iter(threads.values()))}
        files[_JOIN_FILE] = rendered(_TEMPLATES, "volumetric.hal.jinja", **joined)
        return files, tables

    def _ini(self, files: Mapping[str, str]) -> tuple[str, int]:
        """Load the component first and join it last; tables and backlash are taken out by a sign before them."""
        ini, tables = self.ini, 0
        lines = files[ini.path.name].split("\n")
        for (section, key), values in ini.values.items():
            table = section.startswith(("JOINT_", "AXIS_")) and key in _TABLE_KEYS
            for each in values if table or section == "HAL" else ():
                if each.file != ini.path:
                    what, remedy = "{key} stands in a file that {ini} includes", "move the line into {ini}"
                    raise each.fail(what, remedy, key=key, ini=ini.path.name)
                if table:
                    lines[each.line - 1] = f"# taken out by axiscal: {lines[each.line - 1].strip()}"
                    tables += 1
        named = [each.line for each in ini.all("HAL", "HALFILE")]
        lines.insert(named[-1], f"HALFILE = {_JOIN_FILE}")
        lines.insert(named[0] - 1, f"HALFILE = {_LOAD_FILE}")
        return "\n".join(lines), tables


def _with_functions(name: str, text: str, nets: dict[str, str], threads: dict[str, str]) -> str:
    """Return a HAL file with the component's functions beside those of motion.

    nets : takes which signal each pin is on; threads : takes the thread of each function
    """
    lines = list[str]()
    for number, line in enumerate(text.split("\n"), 1):
        words = line.partition("#")[0].split()
        if "axiscal_vcomp" in line or "axiscal-vcomp" in line:
            remedy = "run {command} first"
            raise TableError("the component is in this configuration already", remedy, name, number, command=_UNDO)
        if _OLD_WORDS.match(line) and any(word.startswith(("joint.", "motion.")) for word in words):
            what = "{word} joins pins of motion here"
            raise TableError(what, "write it as net, or {how}", name, number, word=words[0], how=said(_BY_HAND))
        if words[:1] == ["net"] and len(words) > 2:
            nets |= {pin: words[1] for pin in words[2:] if pin not in _ARROWS}
        function = _FUNCTION.fullmatch(line)
        before = function is not None and function[1] == "motion-command-handler"
        lines += [f"addf axiscal-vcomp.fb {function[2]}"] if function and before else []
        lines.append(line)
        lines += [f"addf axiscal-vcomp.cmd {function[2]}"] if function and not before else []
        if function:
            threads[function[1]] = function[2]
    return "\n".join(lines)


def scripts(before: Mapping[str, str], after: Mapping[str, str], beside: Sequence[str]) -> dict[str, str]:
    """Return what puts the files into a configuration's folder and what takes them out again.

    before, after : the files as they were and as they are to be; beside : more files that belong to it
    Both refuse where a file is not the one that was read, or has been changed since.
    """
    changed = [name for name in before if before[name] != after[name]]
    added = [name for name in [*after, *beside] if name not in before]
    texts = {
        _APPLY: {name: [before[name]] for name in changed},
        _UNDO: {name: [before[name], after[name]] for name in changed},
    }
    named = {"changed": [*map(shlex.quote, changed)], "added": [*map(shlex.quote, added)]}
    found = dict[str, str]()
    for script, expected in texts.items():
        each = ((shlex.quote(n), [sha256(text.encode()).hexdigest() for text in own]) for n, own in expected.items())
        found[script] = rendered(_TEMPLATES, "script.sh.jinja", undo=script == _UNDO, read=[*each], **named)
    return found


def configured(path: Path) -> Configured:
    """Return what stands in an INI file and in the HAL files beside it; raises InputError."""
    ini = read_ini(path)
    files = {path.name: exact_text(path)}
    for named in ini.all("HAL", "HALFILE"):
        name = named.text.split()[0] if named.text else ""
        if not name.endswith(".hal"):
            continue  # programs: nothing in them is changed
        if Path(name).name != name or not (path.parent / name).exists():
            what, remedy = "{name} lies not beside the INI file", "put it there, and name it without LIB: or a folder"
            raise named.fail(what, remedy, name=name)
        files[name] = exact_text(path.parent / name)
    return Configured(ini, machine_of(ini), files)


def options_of(found: Configured, options: ExportOptions) -> ExportOptions:
    """Return options with the unit and the joints of the INI file; raises TableError where these were given as well."""
    if any(axis.unit == "rad" for axis in found.machine.axes):
        remedy = "set them to degree"
        raise TableError("ANGULAR_UNITS are radians, and the component counts degrees", remedy, found.ini.path)
    if {"--number", "--unit"} & set(options.given):
        raise TableError("--ini says the unit and which joints are whose", "leave --unit and --number out")
    return replace(options, unit=found.machine.unit, numbers={a.letter: a.joints for a in found.machine.axes})


def refuse_other_machine(found: Configured, machine: Machine) -> None:
    """Raise TableError where INI file and machine.toml describe different machines."""
    own, described = {axis.letter for axis in found.machine.axes}, {axis.name: axis for axis in machine.axes}
    if own != set(described):
        what = "the INI file has axes {own}, machine.toml {described}"
        remedy = "the component corrects the whole chain: describe all of them"
        raise TableError(what, remedy, found.ini.path, own=" ".join(sorted(own)), described=" ".join(sorted(described)))
    build = found.machine
    for name, axis in described.items():
        against = name in build.reversed
        if build.sure and axis.rotary and against != axis.reversed:
            what = "{kinematics} turns {axis} by ISO 841, and machine.toml says the other way"
            if against:
                what = "{kinematics} turns {axis} against ISO 841, and machine.toml says the other way"
            remedy = "write direction = {way} in machine.toml, and evaluate the readings again"
            kinematics, way = build.kinematics, "reversed" if against else "iso"
            raise TableError(what, remedy, found.ini.path, kinematics=kinematics, axis=name, way=way)


def to_mind(found: Configured, machine: Machine) -> Iterator[str]:
    """Yield where the INI file goes beyond what was calibrated, or turns an axis elsewhere than it was measured."""
    build = found.machine
    for own in found.machine.axes:
        axis, ends = machine.axis(own.letter), [float(from_unit(end, own.unit)) for end in (own.low, own.high)]
        (low, high), (first, last) = axis.travel, ends
        if not axis.cyclic and (first < low - _APART or last > high + _APART):
            may, known = (" to ".join(format_quantity(end, axis.unit) for end in each) for each in (ends, axis.travel))
            text = "may go {may}, and was calibrated over {known}: beyond, the correction stays near that of the end."
            yield f"{own.letter} {text.format(may=may, known=known)}"
        if build.sure and axis.rotary and own.letter in build.origins:
            turns = [float(from_unit(v, build.unit)) for v in build.origins[own.letter]]
            if max(abs(a - b) for a, b in zip(turns, axis.origin, strict=True)) > _APART:
                there, here = (", ".join(format_quantity(v, "mm", 6) for v in place) for place in (turns, axis.origin))
                yield (
                    f"WARNING: the kinematics turn {own.letter} about ({there}), machine.toml about ({here}): one of "
                    "them is not the machine that was measured."
                )
