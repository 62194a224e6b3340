"""A LinuxCNC configuration with the component in it: the owner's own INI and HAL files, changed in a few lines.

`joint.N.motor-pos-cmd` and `joint.N.motor-pos-fb` change places with `axiscal-vcomp.drive-N` and `.encoder-N` in his
net lines: his signals and his hardware stay as they are named. The component is loaded first, its functions stand
beside those of motion, and what else it needs is joined last.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from hashlib import sha256

from axiscal.description.ini_file import IniFile
from axiscal.document.ports import rendered
from axiscal.exceptions import TableError
from axiscal.language.spoken import said

FILE, HAL_FILE = "axiscal.vcomp", "axiscal-volumetric.hal"
STATEMENT = "Never run on real drives or on a realtime kernel. It is no safety function."
_TEMPLATES = "axiscal.ports.linuxcnc"

LIB = "LIB:"
"""Before a HAL file that LinuxCNC looks for in its library alone."""
LOAD_FILE, JOIN_FILE, APPLY, UNDO = "axiscal-load.hal", "axiscal-join.hal", "apply.sh", "undo.sh"
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,120}")
_TABLE_KEYS = ("COMP_FILE", "COMP_FILE_TYPE", "BACKLASH")
_FUNCTION = re.compile(r"\s*addf\s+(motion-command-handler|motion-controller)\s+(\S+)(?:\s+-?\d+)?\s*(#.*)?")
_ARROWS = {"=>", "<=", "<=>"}
_OLD_WORDS = re.compile(r"\s*(linkps|linksp|linkpp|newsig|unlinkp)\b")


@dataclass(slots=True)
class Configuration:
    """The files of a LinuxCNC as they are to be read, by name beside the INI file; changed in place.

    ini : name of the INI file; files : name -> text; tables : how many lines of tables and backlash were taken out
    """

    ini: str
    files: dict[str, str]
    tables: int = 0
    nets: dict[str, str] = field(default_factory=dict)

    def texts(self) -> list[str]:
        """Return the names of the HAL files, in order."""
        return [name for name in self.files if name != self.ini]


def patched(ini: IniFile, files: Mapping[str, str], joints: Mapping[int, str], belts: bool) -> Configuration:
    """Return the configuration with the component in it.

    files : the INI file and its HAL files in the order in which they run; joints : their numbers with their axes
    belts : whether joints 0 and 1 are X + Y and X - Y
    Raises TableError with file and line for what has to be done by hand.
    """
    for name in files:
        if not _NAME.fullmatch(name):
            remedy = "rename the file: letters, digits, . _ -"
            raise TableError("{name!r} is no name that a script can copy", remedy, name=name[:60])
    found = Configuration(ini.path.name, dict(files))
    thread = _functions(found)
    for name in found.texts():
        _read_nets(found, name)
    for joint in joints:
        _exchange(found, f"joint.{joint}.motor-pos-cmd", f"axiscal-vcomp.drive-{joint}")
        _exchange(found, f"joint.{joint}.motor-pos-fb", f"axiscal-vcomp.encoder-{joint}")
    _ini(found, ini, {name for name in found.texts() if found.files[name] != files[name]})
    letters = "".join(joints.get(number, "_") for number in range(max(joints) + 1))
    load = _LOADRT.replace('"coordinates=[TRAJ]COORDINATES"', f"coordinates={letters}")  # the kinematics' own order
    load += " belts=1" if belts else ""
    found.files[LOAD_FILE] = f"# Made by axiscal: the component, before anything is joined to it.\n{load}\n"
    joined = {"joints": sorted(joints), "nets": found.nets, "thread": thread}
    found.files[JOIN_FILE] = rendered(_TEMPLATES, "volumetric.hal.jinja", **joined)
    return found


_LOADRT = (  # with quotes: people write blanks between the letters
    f'loadrt axiscal_vcomp file={FILE} units=[TRAJ]LINEAR_UNITS "coordinates=[TRAJ]COORDINATES" joints=[KINS]JOINTS'
)


def _functions(found: Configuration) -> str:
    """Put the component's functions beside those of motion and return their thread."""
    threads: dict[str, str] = {}
    for name in found.texts():
        lines = []
        for number, line in enumerate(found.files[name].split("\n"), 1):
            if "axiscal_vcomp" in line or "axiscal-vcomp" in line:
                remedy = "run {command} first"
                raise TableError("the component is in this configuration already", remedy, name, number, command=UNDO)
            if not (function := _FUNCTION.fullmatch(line)):
                lines.append(line)
            elif function[1] == "motion-command-handler":
                lines += [f"addf axiscal-vcomp.fb {function[2]}", line]
                threads[function[1]] = function[2]
            else:
                lines += [line, f"addf axiscal-vcomp.cmd {function[2]}"]
                threads[function[1]] = function[2]
        found.files[name] = "\n".join(lines)
    if len(threads) < 2 or len(set(threads.values())) > 1:
        what = "no addf lines of motion-command-handler and motion-controller, in one thread, stand in the HAL files"
        raise TableError(what, _BY_HAND, found.ini)
    return next(iter(threads.values()))


_BY_HAND = "wire it by hand: axiscal-volumetric.hal, written without --ini, says how"


def _read_nets(found: Configuration, name: str) -> None:
    """Remember which signal each pin is on."""
    for number, line in enumerate(found.files[name].split("\n"), 1):
        words = line.partition("#")[0].split()
        if _OLD_WORDS.match(line) and any(word.startswith(("joint.", "motion.")) for word in words):
            what = "{word} joins pins of motion here"
            raise TableError(what, "write it as net, or {how}", name, number, word=words[0], how=said(_BY_HAND))
        if words[:1] == ["net"] and len(words) > 2:
            found.nets |= {pin: words[1] for pin in words[2:] if pin not in _ARROWS}


def _exchange(found: Configuration, pin: str, other: str) -> None:
    """Put another pin in the place of one of a joint, in each net line where it stands: delsig may part it from one."""
    line = re.compile(rf"^(\s*net\s[^#\n]*?\s){re.escape(pin)}(?=\s|$)", re.MULTILINE)
    changed = {name: line.sub(rf"\g<1>{other}", found.files[name]) for name in found.texts()}
    if all(found.files[name] == text for name, text in changed.items()):
        raise TableError("no net line of the HAL files joins {pin}", _BY_HAND, found.ini, pin=pin)
    found.files |= changed


def _ini(found: Configuration, ini: IniFile, changed: Collection[str]) -> None:
    """Load the component first and join it last; tables and backlash are taken out by a sign before them.

    changed : names of HAL files, whose changed copies are read and not those in the library
    """
    lines = found.files[found.ini].split("\n")
    for (section, key), values in ini.values.items():
        table = section.startswith(("JOINT_", "AXIS_")) and key in _TABLE_KEYS
        for each in values if table or section == "HAL" else ():
            if each.file != ini.path:
                what, remedy = "{key} stands in a file that {ini} includes", "move the line into {ini}"
                raise each.fail(what, remedy, key=key, ini=found.ini)
            if table:
                lines[each.line - 1] = f"# taken out by axiscal: {lines[each.line - 1].strip()}"
                found.tables += 1
            elif any(f"{LIB}{name}" in each.text.split() for name in changed):
                lines[each.line - 1] = lines[each.line - 1].replace(LIB, "", 1)
    named = [each.line for each in ini.all("HAL", "HALFILE")]
    lines.insert(named[-1], f"HALFILE = {JOIN_FILE}")
    lines.insert(named[0] - 1, f"HALFILE = {LOAD_FILE}")
    found.files[found.ini] = "\n".join(lines)


def scripts(before: Mapping[str, str], after: Mapping[str, str], beside: Sequence[str]) -> dict[str, str]:
    """Return what puts the files into a configuration's folder and what takes them out again.

    before, after : the files as they were and as they are to be; beside : more files that belong to it
    Both refuse where a file is not the one that was read, or has been changed since.
    """
    changed = [name for name in before if before[name] != after[name]]
    added = [name for name in [*after, *beside] if name not in before]
    texts = {
        APPLY: {name: [before[name]] for name in changed},
        UNDO: {name: [before[name], after[name]] for name in changed},
    }
    named = {"changed": [*map(shlex.quote, changed)], "added": [*map(shlex.quote, added)]}
    found = dict[str, str]()
    for script, expected in texts.items():
        each = ((shlex.quote(n), [sha256(text.encode()).hexdigest() for text in own]) for n, own in expected.items())
        found[script] = rendered(_TEMPLATES, "script.sh.jinja", undo=script == UNDO, read=[*each], **named)
    return found


def hal_text(joints: Sequence[int]) -> str:
    """Return the HAL text for joints by their numbers."""
    values = {"joints": sorted(joints), "nets": {}, "thread": "", "statement": STATEMENT, "load": _LOADRT}
    return rendered(_TEMPLATES, "volumetric.hal.jinja", **values)
