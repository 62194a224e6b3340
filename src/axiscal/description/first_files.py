"""The first files of a new calibration: a machine to begin with, the instruments there are, the target."""

from __future__ import annotations

import itertools
import json
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from axiscal.description.campaign import campaign_from_texts
from axiscal.description.campaign_schema import SCHEMAS
from axiscal.description.first_campaign import OFFERED, UNSAID, first_campaign
from axiscal.description.ini_machine import IniAxis, IniMachine
from axiscal.document.durable import write_whole
from axiscal.document.quoting import shown, toml_value
from axiscal.exceptions import DescriptionError, RecordError
from axiscal.language.spoken import LANGUAGES, said, speaking
from axiscal.machine import builtin_names, load_machine, machine_from_text
from axiscal.machine.axis import letter_direction
from axiscal.units import from_unit, parse_quantity, to_unit

_KNOT = 0.05
"""m between knots of a curve; a matter of taste, and the person is asked to change it."""
_MOST_KNOTS = 15
"""Of one curve; a matter of taste: more make a plan slow."""
_TURNS = 100
"""To either side: more are as good as endless."""
_ERRORS = """\

[errors]
# Prior knowledge, one standard deviation each: of a used workshop machine. Change what you know better.
# docs/machine.md of axiscal says what each name means; `axiscal machine check` what no reading could tell apart."""


@dataclass(frozen=True, slots=True)
class Beginning:
    """A machine to begin with.

    text : of machine.toml; active : the line of campaign.toml on compensation; look : what could not be read
    """

    text: str
    active: str = UNSAID
    look: tuple[str, ...] = ()


class FirstFiles(NamedTuple):
    """texts : by the name of their file; setups : how many are offered"""

    texts: dict[str, str]
    setups: int


def offered_words() -> list[str]:
    """Return how each instrument that is offered is called in the language that is spoken."""
    return [said(offer.words).partition(",")[0] for offer in OFFERED.values()]


def instruments_of(text: str) -> list[str]:
    """Return the instruments that a person names, of `OFFERED`; raises DescriptionError for a word that is none."""
    names, words, found = _by_word(), text.casefold().replace(",", " ").split(), list[str]()
    while words:
        count = next((n for n in (3, 2, 1) if _unspaced(words[:n]) in names), 0)
        if not count:
            what = "{name} is no instrument whose set-ups can be offered"
            remedy = "docs/campaign.md shows how others are written. Offered are {known}"
            raise DescriptionError(what, remedy, name=shown(words[0]), known=", ".join(offered_words()))
        found.append(names[_unspaced(words[:count])])
        words = words[count:]
    return [name for name in dict.fromkeys(found) if name]


def _by_word() -> dict[str, str]:
    """Return the instrument of each word for it, in all of the languages, without blanks and hyphens; "" of "and"."""
    found = {_unspaced([name]): name for name in OFFERED}
    for language in LANGUAGES:
        with speaking(language):
            found |= {
                _unspaced([word]): name for name, offer in OFFERED.items() for word in said(offer.words).split(",")
            }
            found[_unspaced([said(" and ")])] = ""
    return found


def _unspaced(words: Sequence[str]) -> str:
    return "".join(words).casefold().replace(" ", "").replace("-", "")


def of_builtin(name: str) -> Beginning:
    """Return a built-in machine; raises DescriptionError for a name that is none."""
    if name not in builtin_names():
        what, remedy = "{name} is no built-in machine", "The built-in machines are {known}"
        raise DescriptionError(what, remedy, name=shown(name), known=", ".join(builtin_names()))
    return Beginning(load_machine(name).text)


def of_ini(found: IniMachine, file: Path, folder: Path, chain: str | None = None) -> Beginning:
    """Return the machine of an INI file of LinuxCNC.

    found : what the file says; folder : where the files will stand
    chain : how it is built, where the kinematics leave it open
    Raises DescriptionError for a chain that is none.
    """
    if chain is not None:
        found = replace(found, build=replace(found.build, chain=chain, said=True))
    text = machine_text(found, file.name)
    machine_from_text(text, file)
    return Beginning(text, _active(found, file, folder), tuple(unread(found)))


def with_travels(begun: Beginning, lengths: Mapping[str, float]) -> Beginning:
    """Return a machine whose linear axes travel so far, mm: up to zero where they end there, else from below."""
    text = begun.text
    for axis in machine_from_text(begun.text).axes:
        if axis.name in lengths:
            low, high = (to_unit(end, "mm") for end in axis.travel)
            low, high = (-lengths[axis.name], 0.0) if high == 0 else (low, low + lengths[axis.name])
            section = re.compile(
                rf"(\[axes\.{re.escape(axis.name)}\]\n(?:(?!\[axes).)*?travel = )\[[^\]]*\]", re.DOTALL
            )
            text = section.sub(rf'\g<1>["{low:g} mm", "{high:g} mm"]', text, count=1)
    return replace(begun, text=text)


def linear_travels(begun: Beginning) -> dict[str, float]:
    """Return how far each linear axis travels, mm."""
    axes = machine_from_text(begun.text).axes
    lengths = {axis.name: to_unit(axis.length, "mm") for axis in axes if not axis.rotary}
    return dict(sorted(lengths.items()))


def _active(found: IniMachine, file: Path, folder: Path) -> str:
    """Return the line of campaign.toml on what LinuxCNC corrects while it is measured."""
    if not found.compensated:
        return "compensation_active = false      # the INI file has no COMP_FILE and no BACKLASH"
    joints = ", ".join(map(str, found.compensated))
    path = toml_value(os.path.relpath(file, folder))
    return f"compensation_active = [{path}]   # tables or backlash of joint {joints}: new tables go on top of them"


def first_files(begun: Beginning, instruments: Sequence[str], target: str) -> FirstFiles:
    """Return the files of a new calibration.

    instruments : of OFFERED
    target : the expanded uncertainty wanted, such as "10 um"; "" for as good as the set-ups make it
    Raises DescriptionError where there is none, UnitError for a target that is no length.
    """
    if not instruments:
        raise DescriptionError(
            "No instrument was named", "Name one or more of {known}", known=", ".join(offered_words())
        )
    if target:
        parse_quantity(target, "length")
    machine = _with_stylus(begun.text) if "sphere" in instruments else begun.text
    text = first_campaign(machine_from_text(machine), "machine.toml", instruments, target, begun.active)
    setups = len(campaign_from_texts(text, "campaign.toml", machine, "machine.toml").setups)
    texts = {
        "machine.toml": f"#:schema ./machine.schema.json\n{machine.rstrip()}\n",
        "campaign.toml": text,
        **{f"{name}.schema.json": json.dumps(schema(), indent=1) + "\n" for name, schema in SCHEMAS.items()},
    }
    return FirstFiles(texts, setups)


def _with_stylus(machine: str) -> str:
    """Return the text of a machine with the ball of a stylus, where it says of none."""
    if machine_from_text(machine).stylus > 0:
        return machine
    return machine.replace(
        "[tool]\n", '[tool]\nstylus = "6 mm"                # CHECK: diameter of the ball of the stylus\n', 1
    )


def write_files(folder: Path, texts: Mapping[str, str]) -> None:
    """Write files into a folder, all or none; raises RecordError where one of them is there as another already."""
    folder.mkdir(parents=True, exist_ok=True)
    new = {folder / name: text.encode() for name, text in texts.items()}
    for path in [path for path in new if path.exists()]:
        if not path.is_file() or path.read_bytes() != new.pop(path):
            raise RecordError("This file exists already", "Name another folder, or move it away", path)
    with ExitStack() as undone:
        for path, content in new.items():
            undone.callback(path.unlink, missing_ok=True)
            write_whole(path, content)
        undone.pop_all()


def machine_text(machine: IniMachine, source: str) -> str:
    """Return the text of machine.toml.  source : the INI file, as it is named"""
    period = "" if machine.servo_period is None else f" Servo period {machine.servo_period * 1e3:g} ms."
    lines = [
        f"# The machine of {_plain(source)}, as LinuxCNC knows it.",
        f"# Kinematics {_plain(machine.build.kinematics)}; joints: {_joints(machine)}.{period}",
        f"name = {toml_value(_plain(machine.name))}",
        *_chain(machine),
        "",
        "[tool]",
        "# CHECK: from the spindle nose to the tool point of the probe, which the INI cannot say.",
        'length = "100 mm"',
        *(line for axis in machine.axes for line in _axis(machine, axis)),
        *_ERRORS.splitlines(),
        *_errors(machine),
    ]
    return "\n".join(lines) + "\n"


def unread(machine: IniMachine) -> list[str]:
    """Return in sentences what the INI file could not say and was supposed, for the person to look at."""
    found = [said("the length of the tool")]
    if not (machine.build.sure or machine.build.said):
        chain = f'"{machine.build.chain}"'
        found.append(said("which axes carry the workpiece (chain = {chain} is supposed)", chain=chain))
    if any(axis.rotary for axis in machine.axes) and not machine.build.sure:
        found.append(said("where the rotary axes lie (origin)"))
    if any(axis.rotary and axis.letter not in machine.build.reversed for axis in machine.axes):
        found.append(said("which way the rotary axes count (direction)"))
    return found


def _chain(machine: IniMachine) -> Iterator[str]:
    build = machine.build
    if not (build.sure or build.said):
        yield "# CHECK: the INI does not say which axes carry the workpiece (primed, before b) and which the tool."
    yield f'chain = "{build.chain}"'


def _joints(machine: IniMachine) -> str:
    return ", ".join(f"{axis.letter} {' and '.join(map(str, axis.joints))}" for axis in machine.axes)


def _axis(machine: IniMachine, axis: IniAxis) -> Iterator[str]:
    yield ""
    home = "" if axis.home is None else f"   # homed at {axis.home:g} {axis.unit}"
    yield f"[axes.{axis.letter}]{home}"
    turn = to_unit(from_unit(360.0, "deg"), axis.unit) if axis.rotary else 0.0
    if axis.endless:
        yield f'travel = ["0 {axis.unit}", "{_number(turn)} {axis.unit}"]      # a whole turn'
        low, high = max(min(axis.low, 0.0), -_TURNS * turn), min(max(axis.high, turn), _TURNS * turn)
        yield f'limits = ["{_number(low)} {axis.unit}", "{_number(high)} {axis.unit}"]   # MIN_LIMIT, MAX_LIMIT'
    else:
        low_text, high_text = (f'"{_number(each)} {axis.unit}"' for each in (axis.low, axis.high))
        yield f"travel = [{low_text}, {high_text}]   # MIN_LIMIT, MAX_LIMIT"
    yield from _motion(axis)
    if axis.letter in machine.build.reversed:
        yield f'direction = "reversed"           # as {_plain(machine.build.kinematics)} turns it; else "iso"'
    if axis.rotary:
        at = machine.build.origins.get(axis.letter, (0.0, 0.0, 0.0))
        origin = ", ".join(f'"{_number(each)} {machine.build.unit}"' for each in at)
        said = (
            "from the pins of the kinematics" if machine.build.sure else "CHECK: a point on its line, all axes at zero"
        )
        yield f"origin = [{origin}]   # {said}"


def _motion(axis: IniAxis) -> Iterator[str]:
    if axis.speed is not None:
        per_minute = from_unit(axis.speed, axis.unit) * 60
        text = f"{_number(to_unit(per_minute, 'deg') / 360)} rpm" if axis.rotary else f"{_number(per_minute)} m/min"
        yield f'speed = "{text}"   # MAX_VELOCITY'
    if axis.acceleration is not None:
        value = from_unit(axis.acceleration, axis.unit)
        text = f"{_number(to_unit(value, 'deg'))} deg/s^2" if axis.rotary else f"{_number(value)} m/s^2"
        yield f'acceleration = "{text}"   # MAX_ACCELERATION'


def _errors(machine: IniMachine) -> Iterator[str]:
    for axis in machine.axes:
        yield ""
        yield f"# {axis.letter}"
        yield from _rotary(axis) if axis.rotary else _linear(axis)
    yield ""
    yield "# Location errors: squareness of the linear axes, and where rotary axes lie and lean"
    linear = [axis.letter for axis in machine.axes if axis.letter in "XYZ"]
    squareness = {("X", "Y"): "C0Y", ("X", "Z"): "B0Z", ("Y", "Z"): "A0Z"}
    for pair in itertools.combinations(sorted(linear), 2):
        yield f'{squareness[pair]} = {{ std = "30 urad" }}'
    for axis in machine.axes:
        if axis.rotary:
            across = [way for way in "XYZ" if "XYZ".index(way) != letter_direction(axis.letter)]
            yield from (f'{way}0{axis.letter} = {{ std = "15 um" }}' for way in across)
            yield from (f'{"ABC"["XYZ".index(way)]}0{axis.letter} = {{ std = "40 urad" }}' for way in across)


def _linear(axis: IniAxis) -> Iterator[str]:
    length = float(from_unit(axis.high - axis.low, axis.unit))
    knots = int(min(max(5, round(length / _KNOT) + 1), _MOST_KNOTS))
    reach = f"{_number(to_unit(max(length / 4, 0.01), 'mm'))} mm"
    own = "XYZ"[letter_direction(axis.letter)]
    for way in "XYZ":
        std = "10 um" if way == own else "5 um"
        yield f'E{way}{axis.letter} = {{ std = "{std}", knots = {knots}, length = "{reach}", rest = "0.3 um" }}'
    for way in "ABC":
        yield f'E{way}{axis.letter} = {{ std = "15 urad", knots = {max(5, knots // 2)}, length = "{reach}" }}'
    yield f'E{own}{axis.letter}_reversal = {{ std = "4 um" }}'


def _rotary(axis: IniAxis) -> Iterator[str]:
    for way in "XYZ":
        yield f'E{way}{axis.letter} = {{ std = "4 um", knots = 7, length = "60 deg" }}'
    for way in "ABC":
        rest = ', rest = "1 urad"' if way == axis.letter else ""
        std = "40 urad" if way == axis.letter else "15 urad"
        yield f'E{way}{axis.letter} = {{ std = "{std}", knots = 7, length = "60 deg"{rest} }}'
    yield f'E{axis.letter}{axis.letter}_reversal = {{ std = "20 urad" }}'


def _number(value: float) -> str:
    return f"{float(value) + 0.0:.9g}"


def _plain(text: str) -> str:
    """Return a text that ends no line of remarks."""
    return "".join(character if character.isprintable() else " " for character in text)
