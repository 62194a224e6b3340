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
from axiscal.exceptions import TableError
from axiscal.language.spoken import said

FILE, HAL_FILE = "axiscal.vcomp", "axiscal-volumetric.hal"
STATEMENT = "Never run on real drives or on a realtime kernel. It is no safety function."
_HEAD = f"""\
# Made by axiscal: every error of the machine taken away between motion and drives.
# {STATEMENT}
# To be run after motion and your drives are loaded (HALFILE, the last one). Then, for each joint N: net to your drive
# the signal vc-drv-N instead of joint.N.motor-pos-cmd (pid.N.command, stepgen's position-cmd), net its position
# feedback to vc-enc-N instead of joint.N.motor-pos-fb, and take your own net lines of these two pins out.
# axiscal-vcomp.fb has to run before motion-command-handler, axiscal-vcomp.cmd after motion-controller: put your own
# addf lines that read the hardware before, those that write it behind. With another order the following error grows by
# the way of one period. Where KINEMATICS is corexykins, belts=1 goes behind joints=[KINS]JOINTS.
"""
SWITCHES = """\
# Off at start. Switch it on with the spindle stopped and the tool clear: halcmd setp axiscal-vcomp.enable 1
setp axiscal-vcomp.enable 0
# A fault lets a part go on wrong by the whole error; to stop the feed then:
# net vc-fault axiscal-vcomp.fault => motion.feed-inhibit
# Tool lengths: without these lines the length of the campaign is taken for every tool. With them tool lengths have to
# count from the spindle nose; where they count from elsewhere, setp axiscal-vcomp.tool-gauge to the distance.
# net vc-tool-x motion.tooloffset.x => axiscal-vcomp.tool-x
# net vc-tool-y motion.tooloffset.y => axiscal-vcomp.tool-y
# net vc-tool-z motion.tooloffset.z => axiscal-vcomp.tool-z
"""

LIB = "LIB:"
"""Before a HAL file that LinuxCNC looks for in its library alone."""
LOAD_FILE, JOIN_FILE, APPLY, UNDO = "axiscal-load.hal", "axiscal-join.hal", "apply.sh", "undo.sh"
_BACKUP = "before-axiscal"
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
    head = f"# Made by axiscal: what the component reads beside. Its functions stand in {thread}."
    found.files[JOIN_FILE] = "\n".join([head, *_nets(found.nets, sorted(joints))]) + "\n" + SWITCHES
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


def _nets(nets: Mapping[str, str], joints: Sequence[int]) -> list[str]:
    """Return the net lines of what is read and passed on.  nets : the signal of each pin that is on one already"""
    lines = list[str]()

    def read(signal: str, pin: str, own: str) -> None:
        known = nets.get(pin)
        lines.append(f"net {known} => {own}" if known else f"net {signal} {pin} => {own}")

    read("vc-home", "motion.is-all-homed", "axiscal-vcomp.homed")
    read("vc-on", "motion.motion-enabled", "axiscal-vcomp.powered")
    for n in joints:
        read(f"vc-pos-{n}", f"joint.{n}.pos-cmd", f"axiscal-vcomp.pos-{n}")
        read(f"vc-bl-{n}", f"joint.{n}.backlash-corr", f"axiscal-vcomp.backlash-{n}")
        lines.append(f"net vc-mot-{n} joint.{n}.motor-pos-cmd => axiscal-vcomp.motor-{n}")
        lines.append(f"net vc-fb-{n} axiscal-vcomp.feedback-{n} => joint.{n}.motor-pos-fb")
    return lines


def scripts(before: Mapping[str, str], after: Mapping[str, str], beside: Sequence[str]) -> dict[str, str]:
    """Return what puts the files into a configuration's folder and what takes them out again.

    before, after : the files as they were and as they are to be; beside : more files that belong to it
    Both refuse where a file is not the one that was read, or has been changed since.
    """
    changed = [name for name in before if before[name] != after[name]]
    added = [name for name in [*after, *beside] if name not in before]
    kept = [(name, (before[name],)) for name in changed]
    either = [(name, (before[name], after[name])) for name in changed]
    part, gone = f'"$to/{_BACKUP}.part"', f'"$to/{_BACKUP}.gone"'
    free = [f'[ ! -e "$to"/{q} ] || {_TAKEN}' for q in _quoted(added)]
    copies = [f"rm -rf {part} {gone}", f"mkdir {part}", *(f'cp -p "$to"/{q} {part}/{q}' for q in _quoted(changed))]
    copies += ["sync", f'mv {part} "$to/{_BACKUP}"']
    news = [line for q in _quoted([*changed, *added]) for line in _put(f'"$from"/{q}', q)]
    backs = [line for q in _quoted(changed) for line in _put(f'"$to/{_BACKUP}"/{q}', q)]
    taken = [f'rm -f "$to"/{q} "$to"/{q}.part' for q in _quoted(added)]
    there, lacking = f'[ ! -e "$to/{_BACKUP}" ] || {_THERE}', f'[ -d "$to/{_BACKUP}" ] || {_NONE}'
    ends = ["sync", f'mv "$to/{_BACKUP}" {gone}', f"rm -rf {gone}"]
    return {
        APPLY: _script("puts the component into", [there], kept, [*free, *copies, *news, "sync"]),
        UNDO: _script("takes the component out of", [lacking], either, [*backs, *taken, *ends]),
    }


def _put(file: str, name: str) -> list[str]:
    """Return what puts a file in the place of another, whole at any time.  file, name : quoted"""
    return [f'cp -p {file} "$to"/{name}.part', "sync", f'mv "$to"/{name}.part "$to"/{name}']


_THERE = '{ echo "There is a backup already: run undo.sh first." >&2; exit 1; }'
_NONE = '{ echo "There is no backup: nothing was put in, or it is taken out already." >&2; exit 1; }'
_TAKEN = (
    '{ echo "A file of axiscal is there already, which another configuration may need: move it first." >&2; exit 1; }'
)
_OTHER = '{ echo "A file is not the one that was read." >&2; exit 1; }'


def _quoted(names: Sequence[str]) -> list[str]:
    return [shlex.quote(name) for name in names]


def _script(what: str, first: Sequence[str], files: Sequence[tuple[str, Sequence[str]]], lines: Sequence[str]) -> str:
    """Return a script.  first : checks; files : by name, with the texts of which each must have one"""
    return "\n".join(
        [
            "#!/bin/sh",
            f"# Made by axiscal: {what} a LinuxCNC configuration. Stop LinuxCNC first.",
            "# Whatever ends it half-way: undo.sh puts back what was there.",
            "set -eu",
            '[ $# = 1 ] || { echo "Usage: sh $0 FOLDER-OF-THE-INI-FILE" >&2; exit 2; }',
            'from=$(cd "$(dirname "$0")" && pwd)',
            'to=$(cd "$1" && pwd)',
            *first,
            *(
                f'case "$(sha256sum < "$to"/{shlex.quote(name)})" in '
                f"{'|'.join(sha256(text.encode()).hexdigest() + '*' for text in texts)}) ;; *) {_OTHER} ;; esac"
                for name, texts in files
            ),
            *lines,
            "",
        ]
    )


def hal_text(joints: Sequence[int]) -> str:
    """Return the HAL text for joints by their numbers."""
    lines = [_HEAD + _LOADRT, "addf axiscal-vcomp.fb servo-thread 1", "addf axiscal-vcomp.cmd servo-thread"]
    lines += _nets({}, sorted(joints))
    for n in sorted(joints):
        lines += [f"net vc-drv-{n} axiscal-vcomp.drive-{n}", f"net vc-enc-{n} axiscal-vcomp.encoder-{n}"]
    return "\n".join(lines) + "\n" + SWITCHES
