"""Programs read a second time, each by a small reader written from the descriptions of the controls, not from ours.

A reader knows the few words that a measuring program may have and refuses every other: what it returns is what the
machine would do.
"""

import re
import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Move:
    """A straight move at a feed to machine coordinates, mm or deg, mm/min or deg/min; axes left out stand still."""

    to: dict[str, float]
    feed: float


@dataclass(frozen=True, slots=True)
class Wait:
    """The machine stands still, s."""

    seconds: float


@dataclass(frozen=True, slots=True)
class Halt:
    """The program waits for start."""


@dataclass(frozen=True, slots=True)
class Mark:
    """Here reading `number` is taken."""

    number: int


Event = Move | Wait | Halt | Mark

_NUMBER = r"[+-]?\d+\.\d+"
_WORD = re.compile(rf"([A-Z][0-9]?)(?:=|(?<=[A-Z]))({_NUMBER})")
_COMMENT = r"[A-Z0-9 _.+-]*"


def _mark(comment: str) -> list[Event]:
    found = re.fullmatch(r"READING (\d+)", comment.strip())
    return [Mark(int(found[1]))] if found else []


def _move(words: str, feed: str) -> Move:
    pairs = [_WORD.fullmatch(word) for word in words.split()]
    assert pairs
    assert all(pairs), words
    to = {pair[1]: float(pair[2]) for pair in pairs if pair}
    assert len(to) == len(pairs), f"an axis twice in {words}"
    return Move(to, float(feed))


@dataclass(frozen=True, slots=True)
class Form:
    """The lines that a program may have, as patterns.

    head, tail : one for each line there; comment, move : with what they say, and the feed; wait : in `seconds`
    """

    head: tuple[str, ...]
    tail: tuple[str, ...]
    comment: str
    move: str
    wait: str
    halt: str = "M0"
    seconds: float = 1.0

    def read(self, lines: Sequence[str]) -> list[Event]:
        """Return what the lines do; every line is of one of the patterns."""
        first, last = len(self.head), len(lines) - len(self.tail)
        for line, pattern in zip([*lines[:first], *lines[last:]], [*self.head, *self.tail], strict=True):
            assert re.fullmatch(pattern, line), f"not at the begin or end of a measuring program: {line!r}"
        acts: dict[str, Callable[[re.Match[str]], list[Event]]] = {
            self.comment: lambda m: _mark(m[1]),
            self.move: lambda m: [_move(m[1], m[2])],
            self.wait: lambda m: [Wait(float(m[1]) * self.seconds)],
            self.halt: lambda m: [Halt()],
        }
        events: list[Event] = []
        for line in lines[first:last]:
            hits = [(found, act) for pattern, act in acts.items() if (found := re.fullmatch(pattern, line))]
            assert len(hits) == 1, f"not a line of a measuring program: {line!r}"
            events += hits[0][1](hits[0][0])
        return events


_AXES = rf"((?:[A-Z]{_NUMBER} )+)"
_IN_BRACKETS, _AFTER_SEMICOLON = rf"\(({_COMMENT})\)", rf"; ({_COMMENT})"
_SECONDS = r"(\d+\.\d+)"
_MODAL = "G21 G90 G94 G17 G40 G49 G80"
LINUXCNC = Form(
    (f"G8 {_MODAL}", "M5 M9", "G61"),
    ("M2",),
    rf"\((?:MSG, )?({_COMMENT})\)",
    rf"G53 G1 {_AXES}F(\d+)",
    f"G4 P{_SECONDS}",
)
"""G53 with G1 in every block; G4 P in seconds."""
ISG = Form(
    (r"%AXISCAL[1-9]\d*", "#TRAFO OFF", "G71 G90 G94 G17 G40 G53 G60 D0", "G20", "G52", "M5 M9"),
    ("M30",),
    _IN_BRACKETS,
    rf"G1 {_AXES}F(\d+)",
    f"#TIME {_SECONDS}",
)
"""G1 with nothing in force that would shift it; #TIME in seconds."""
SINUMERIK = Form(
    ("TRAFOOF", "G710 G90 G94 G17 G40 G60 D0", "DIAMOF", "TRANS", "M5 M9", r"FGROUP\([A-Z0-9,]+\)"),
    ("M30",),
    rf"(?:; |MSG\(\")({_COMMENT})(?:\"\))?",
    rf"G1 SUPA ((?:[A-Z](?:\d=)?{_NUMBER} )+)F(\d+)",
    f"G4 F{_SECONDS}",
)
"""SUPA in every block; G4 F in seconds; an axis whose name has a digit takes a =."""
_CYCLES = (
    *(r"CYCL DEF 8\.0 MIRROR IMAGE", r"CYCL DEF 8\.1"),
    *(r"CYCL DEF 10\.0 ROTATION", r"CYCL DEF 10\.1 ROT\+0"),
    *(r"CYCL DEF 11\.0 SCALING", r"CYCL DEF 11\.1 SCL 1"),
)
HEIDENHAIN = Form(
    ("BEGIN PGM [A-Z0-9_]{1,16} MM", *_CYCLES, "M5", "M9"),
    ("M30", "END PGM [A-Z0-9_]{1,16} MM"),
    _AFTER_SEMICOLON,
    r"L ((?:[A-Z][+-]\d+\.\d+ )+)R0 F(\d+) M91",
    rf"CYCL DEF 9\.0 DWELL TIME\|CYCL DEF 9\.1 DWELL {_SECONDS}",
    "STOP",
)
"""M91 in every move; cycle 9 in seconds, its two blocks in one line here."""
_OPTIONS = "G15", "G50", r"G50\.1( [A-Z]0)+", "G69"
FANUC = Form(
    ("%", r"O[1-9]\d{3}", r"IF\[#4008NE49\]GOTO9000", _MODAL, *_OPTIONS, "M5", "M9", "G54", "G61"),
    ("G64", "M30", r"N9000 #3000=1\([A-Z ]{1,31}\)", "%"),
    _IN_BRACKETS,
    rf"G1 {_AXES}F(\d+)",
    r"G4 P(\d+)",
    seconds=1e-3,
)
"""G54 that has been compared with the machine's zero after every stop; G4 P in whole milliseconds."""


def _axes(events: list[Event]) -> set[str]:
    return {axis for event in events if isinstance(event, Move) for axis in event.to}


def read_sinumerik(text: str) -> list[Event]:
    """Return what a program does; it moves the axes that its path is measured by."""
    lines = text.splitlines()
    events = SINUMERIK.read(lines)
    assert _axes(events) == set(lines[5].removeprefix("FGROUP(").removesuffix(")").split(","))
    return events


def read_heidenhain(text: str) -> list[Event]:
    """Return what a program does; its blocks are numbered, and its end has the name of its begin."""
    numbered = [line.partition(" ") for line in text.splitlines()]
    assert [int(number) for number, _, _ in numbered] == list(range(len(numbered)))
    blocks = "\n".join(block for _, _, block in numbered)
    lines = blocks.replace("CYCL DEF 9.0 DWELL TIME\n", "CYCL DEF 9.0 DWELL TIME|").splitlines()
    assert lines[0].removeprefix("BEGIN") == lines[-1].removeprefix("END")
    return HEIDENHAIN.read(lines)


def read_fanuc(text: str) -> list[Event]:
    """Return what a program does; all its axes are compared after every stop."""
    plain, compared = _without_comparisons(text.splitlines())
    events = FANUC.read(plain)
    assert compared == [list(range(1, len(_axes(events)) + 1))] * events.count(Halt())
    return events


def _without_comparisons(lines: list[str]) -> tuple[list[str], list[list[int]]]:
    """Return the other lines, and which axes are compared after each M0."""
    others: list[str] = []
    compared: list[list[int]] = []
    for line in lines:
        found = re.fullmatch(r"IF\[ABS\[#50([24]\d)-#50([46]\d)\]GT0\.0005\]GOTO9000", line)
        if found is None:
            others.append(line)
            compared += [[]] if line == "M0" else []
            continue
        assert others[-1] == "M0", "a comparison is made where reading ahead has ended"
        assert int(found[2]) - int(found[1]) == 20
        compared[-1].append(int(found[1]) - 20)
    return others, compared


READERS: dict[str, Callable[[str], list[Event]]] = {
    "linuxcnc": lambda text: LINUXCNC.read(text.splitlines()),
    "sinumerik": read_sinumerik,
    "heidenhain": read_heidenhain,
    "fanuc": read_fanuc,
    "isg": lambda text: ISG.read(text.splitlines()),
}

SILENT = {
    "USE_LENGTH_UNITS(CANON_UNITS_MM)",
    "SET_FEED_MODE(0, 0)",
    "SET_FEED_REFERENCE(CANON_XYZ)",
    "SELECT_PLANE(CANON_PLANE_XY)",
    "SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH)",
    "SET_XY_ROTATION(0.0000)",
    "ON_RESET()",
}
"""Calls that set what a measuring program may set; beside them offsets of nothing but zeros."""
AT_THE_START = {"STOP_SPINDLE_TURNING(0)", "MIST_OFF()", "FLOOD_OFF()"}
AT_THE_END = {"STOP_SPINDLE_TURNING(0)", "SET_SPINDLE_MODE(0 0.0000)", "PROGRAM_END()"}


def interpreter() -> str | None:
    """Return where LinuxCNC's interpreter is, as a program of its own; None where it is not installed."""
    return shutil.which("rs274")


def canonical_calls(text: str, folder: Path) -> list[str]:
    """Return the calls that LinuxCNC's interpreter makes of a program: "STRAIGHT_FEED(1.0000, …)"."""
    program = interpreter()
    assert program is not None
    path = folder / "program.ngc"
    path.write_text(text, encoding="ascii")
    done = subprocess.run([program, "-g", path], cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    return [line.split(maxsplit=2)[2] for line in done.stdout.splitlines() if re.match(r"\s*\d+ N", line)]


def read_canonical(calls: list[str]) -> list[Event]:
    """Return what the calls do; any call that a measuring program has no use for is refused, a rapid above all.

    The interpreter begins with every axis at zero; of its moves only the axes that move are returned.
    """
    assert calls.count("PROGRAM_END()") == 1
    events: list[Event] = []
    at, feed, ending = dict.fromkeys("XYZABC", 0.0), 0.0, False
    for call in calls:
        name, _, rest = call.partition("(")
        if not events and call in AT_THE_START:
            continue
        ending = ending or call in AT_THE_END or (name == "SET_G5X_OFFSET" and bool(events))
        assert not (ending and name in {"STRAIGHT_FEED", "DWELL", "PROGRAM_STOP"})
        if name == "SET_FEED_RATE":
            feed = float(rest[:-1])
        elif name == "STRAIGHT_FEED":
            there = dict(zip("XYZABC", map(float, rest[:-1].split(",")), strict=True))
            events.append(Move({axis: to for axis, to in there.items() if to != at[axis]}, feed))
            at = there
        else:
            events += list(_event(call, name, rest[:-1], ending))
    return events


def _event(call: str, name: str, rest: str, ending: bool) -> Iterator[Event]:
    if name == "DWELL":
        yield Wait(float(rest))
    elif call == "PROGRAM_STOP()":
        yield Halt()
    elif name in ("COMMENT", "MESSAGE"):
        yield from _mark(rest.strip('"'))
    elif name in {"SET_G5X_OFFSET", "SET_G92_OFFSET", "USE_TOOL_LENGTH_OFFSET"}:
        assert set(re.findall(r"\d+\.\d+", rest)) == {"0.0000"}, call
    else:
        assert call in SILENT or (ending and call in AT_THE_END), f"not a call of a measuring program: {call}"
