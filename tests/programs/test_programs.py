"""Measuring programs: what each control is told, what is refused, and what the judge of random plans would catch."""

import math
from dataclasses import replace
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

from axiscal.exceptions import InputError, ProgramError
from axiscal.machine.axis import iso_axis
from axiscal.machine.motion import USUAL, Driving, inward
from axiscal.measurement.instruments.displacement import Interferometer, Probe
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.reading import Place
from axiscal.measurement.setup import Setup
from axiscal.programs import dialect, programs, write_programs
from axiscal.programs.scale import AxisScale
from axiscal_core.machine import Machine
from tests.programs.judge import Judge, Plan, judged
from tests.programs.readers import READERS, Move

TABLE = iso_axis("C", True, (0.0, math.tau), speed=math.radians(90), acceleration=math.radians(180))
SLIDE = iso_axis("X", False, (0.0, 0.5), speed=0.1, acceleration=1.0)
MACHINE = Machine((TABLE, SLIDE), tool=0.1, name="Mill (old)")
SETUP = Interferometer("laser 1", MACHINE, (1, 0, 0), (1,), (0.0, 0.25), 1e-6, (), 0, 1.5, 3.0, (0.0, 0.0), "both")
UP, DOWN = Place(SETUP.name, (0.0, 0.1), (0, 1)), Place(SETUP.name, (0.0, 0.3), (0, -1))


def text_of(
    controller: str,
    *places: Place,
    driving: Driving = USUAL,
    machine: Machine = MACHINE,
    setup: Setup = SETUP,
) -> str:
    """Return the program of visits in one set-up."""
    (program,) = programs(machine, [replace(setup, driving=driving)], places, dialect(controller))
    return program.text


def refusal(*places: Place, driving: Driving = USUAL, machine: Machine = MACHINE, setup: Setup = SETUP) -> str:
    """Return why a program cannot be written."""
    with pytest.raises(InputError) as refused:
        programs(machine, [replace(setup, driving=driving)], places, dialect("linuxcnc"))
    return str(refused.value)


def single(name: str) -> Machine:
    """Return a machine of one axis."""
    return Machine((iso_axis(name, False, (0.0, 0.5)),), tool=0.0, name="m")


def test_an_approach_without_room_is_refused_and_named() -> None:
    why = refusal(UP, replace(UP, pose=(0.0, 0.00005)))
    assert 'reading 2 of the set-up "laser 1": X = 0.05 mm lies outside 0.0 to 500.0 mm' in why
    assert "to come to X+" in why
    assert "less than the overrun of 1 mm" in why
    assert "or give the axis a smaller overrun" in why
    assert refusal(replace(DOWN, pose=(0.0, 0.5)))
    longer = replace(MACHINE, axes=(TABLE, replace(SLIDE, overrun=0.02)))
    assert "to come to X+" in refusal(replace(UP, pose=(0.0, 0.001)), machine=longer)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("place", [0.0, 0.0005, 0.001, 0.25, 0.499, 0.4999, 0.5])
def test_what_has_no_room_for_the_planner_has_none_for_a_program(place: float, side: int) -> None:
    visit = Place(SETUP.name, (0.0, place), (0, side))
    if inward(SLIDE, place, side) == place:
        assert text_of("linuxcnc", visit)
    else:
        assert "leaves less than the overrun" in refusal(visit)
        assert text_of("linuxcnc", replace(visit, pose=(0.0, inward(SLIDE, place, side))))


@pytest.mark.parametrize("value", [-1e-5, 0.50001, math.nan, math.inf])
def test_a_reading_outside_the_travel_is_refused(value: float) -> None:
    why = refusal(UP, replace(UP, pose=(0.0, value)))
    assert why.startswith('reading 2 of the set-up "laser 1": X = ')
    assert "raster" in why


def test_what_arithmetic_adds_to_the_end_of_the_travel_is_forgiven() -> None:
    assert "X500.0000" in text_of("linuxcnc", Place(SETUP.name, (0.0, 0.5 + 1e-13), (0, 0)))


@pytest.mark.parametrize("value", ["-0.0001", "500.0001", "0.00001"])
def test_a_number_is_read_again_before_it_is_written(value: str) -> None:
    with pytest.raises(ProgramError, match=r"X would go to .* its travel is 0\.0 to 500\.0"):
        AxisScale.of_axis(SLIDE, 4).written(Decimal(value))


def test_a_travel_without_any_number_that_can_be_written_is_refused() -> None:
    sliver = Machine((iso_axis("X", False, (0.10000004, 0.10000006)),), tool=0.0, name="m")
    assert "no number with 4 decimals" in refusal(Place(SETUP.name, (0.10000005,), (0,)), machine=sliver)


@pytest.mark.parametrize("name", ["X2", "P", "U1"])
def test_axes_that_a_control_cannot_name_are_refused(name: str) -> None:
    assert f"LinuxCNC programs have no axis {name}" in refusal(Place(SETUP.name, (0.1,), (0,)), machine=single(name))


def test_sinumerik_writes_a_digit_with_an_equals_sign() -> None:
    assert "G1 SUPA X2=100.0000 F10000" in text_of("sinumerik", Place(SETUP.name, (0.1,), (0,)), machine=single("X2"))
    with pytest.raises(ProgramError, match="no axis A3"):
        text_of("sinumerik", Place(SETUP.name, (0.1,), (0,)), machine=single("A3"))


def test_waits_longer_than_a_minute_come_in_parts_and_over_an_hour_not_at_all() -> None:
    text = text_of("linuxcnc", UP, setup=replace(SETUP, settle=150))
    assert text.count("G4 P50.000") == 3
    assert "a wait of 4000 s at each reading" in refusal(UP, setup=replace(SETUP, settle=4000))
    assert "G4 P0.000" not in text_of("linuxcnc", UP, setup=replace(SETUP, settle=0))


@pytest.mark.parametrize(("speed", "feed"), [(0.29, 17400), (0.55, 33000), (11 / 60, 11000), (50.0, 99999)])
def test_a_feed_is_a_whole_number_without_the_noise_of_arithmetic(speed: float, feed: int) -> None:
    machine = Machine((replace(SLIDE, speed=speed),), tool=0.0, name="m")
    assert f"F{feed}\n" in text_of("linuxcnc", Place(SETUP.name, (0.1,), (0,)), machine=machine)


def test_other_things_that_cannot_be() -> None:
    assert "no readings" in refusal()
    assert "does not fit the machine's 2 axes" in refusal(Place(SETUP.name, (0.1,), (0,)))
    assert "does not fit" in refusal(Place(SETUP.name, (0.0, 0.1), (0, 2)))
    creep = Machine((replace(SLIDE, speed=1e-6),), tool=0.0, name="m")
    assert "less than 1 mm/min" in refusal(Place(SETUP.name, (0.1,), (0,)), machine=creep)
    with pytest.raises(ProgramError, match="Perhaps fanuc is meant"):
        dialect("fanuk")


def test_the_form_with_values_filled_in_is_a_file_of_readings(tmp_path: Path) -> None:
    places = [Place("laser 1", visit.pose, visit.approach) for visit in (UP, DOWN)]
    write_programs(MACHINE, [SETUP], places, "fanuc", tmp_path)
    blank = (tmp_path / "readings.csv").read_text()
    (tmp_path / "readings.csv").write_text(blank.replace(",\n", ",1.5\n"))
    first, second = read_any(tmp_path / "readings.csv")
    assert (first.setup, first.position, first.approach, first.value) == ("laser 1", {"X": 0.1}, {"X": 1}, 1.5e-6)
    assert second.approach == {"X": -1}
    assert (first.number, second.number) == (1, 2)


def test_nothing_is_written_where_one_reading_is_refused(tmp_path: Path) -> None:
    places = [Place("laser 1", UP.pose, UP.approach), Place("laser 1", (0.0, 0.0), (0, 1))]
    with pytest.raises(ProgramError):
        write_programs(MACHINE, [SETUP], places, "linuxcnc", tmp_path / "out")
    with pytest.raises(ProgramError, match="laser 9"):
        write_programs(MACHINE, [SETUP], [Place("laser 9", UP.pose, UP.approach)], "linuxcnc", tmp_path / "out")
    assert not (tmp_path / "out").exists()


SPOILT = {
    "beyond the travel": ("X301.0000", "X501.0000"),
    "a rapid": ("G53 G1 X301", "G53 G0 X301"),
    "in work coordinates": ("G53 G1 X301", "G1 X301"),
    "from the wrong side": ("X301.0000", "X299.0000"),
    "from too near": ("X301.0000", "X300.5000"),
    "another place": ("X300.0000 F6000\n(READING 2)", "X300.0100 F6000\n(READING 2)"),
    "too fast": ("X301.0000 F6000", "X301.0000 F6001"),
    "too long a wait": ("(READING 2)\nG4 P1.500", "(READING 2)\nG4 P1500.000"),
    "no wait": ("(READING 2)\nG4 P1.500\n", "(READING 2)\n"),
    "no stop": ("(READING 2)\nG4 P1.500\nM0\n", "(READING 2)\nG4 P1.500\n"),
    "no reading": ("(READING 2)\n", ""),
    "both at once": ("X301.0000 F", "X301.0000 C1.0000 F"),
    "a spindle": ("M2\n", "M3\nM2\n"),
    "a comment that says more": ("(READINGS", "(PROBEOPEN) G0 X0 (READINGS"),
    "inches": ("G21", "G20"),
    "a stop less": ("(MSG, MOUNT AND ZERO THE INSTRUMENT THEN PRESS START)\nM0\n", ""),
}


@pytest.mark.parametrize("what", SPOILT)
def test_the_judge_of_the_random_plans_sees_what_is_spoilt(what: str) -> None:
    plan = Plan(MACHINE, (SETUP,), (UP, DOWN))
    text = text_of("linuxcnc", UP, DOWN)
    judge = Judge(plan, SETUP, 4)
    assert judged(text, READERS["linuxcnc"], judge)[1] == []
    spoilt = text.replace(*SPOILT[what])
    assert spoilt != text
    assert judged(spoilt, READERS["linuxcnc"], Judge(plan, SETUP, 4))[1] != []


def test_what_goes_clear_does_so_before_others_move_and_at_the_end() -> None:
    """Wherever X or Y go further than an overrun, Z is at its clearance; so it is when the program ends."""
    axes = tuple(iso_axis(name, False, (0.0, 0.5)) for name in "XYZ")
    mill = Machine(axes, tool=0.0, name="m")
    probe = Probe("p", mill, (1, 0, 0), (0, 1, 2), (0.0,) * 3, 1e-6, (), 0, 0.001, 0, (0.0,) * 3, "both")
    rng = np.random.default_rng(3)
    poses = [tuple(map(float, rng.uniform(0.01, 0.4, 3))) for _ in range(12)]
    poses.append((*poses[-1][:2], 0.05))  # only Z moves: no need to go clear
    places = [Place("p", pose, (1, -1, 1)) for pose in poses]
    probe = replace(probe, driving=Driving(clearance=("Z", 0.45)))
    (program,) = programs(mill, [probe], places, dialect("linuxcnc"))
    at: dict[str, float] = {}
    seen = 0
    for event in READERS["linuxcnc"](program.text):
        if not isinstance(event, Move):
            continue
        far = [axis for axis in "XY" if axis in event.to and abs(event.to[axis] - at.get(axis, -99.0)) > 1.0001]
        seen += bool(far)
        assert not far or (at["Z"] == 450.0 and "Z" not in event.to)
        at |= event.to
    assert seen >= 12
    assert at["Z"] == 450.0
    assert "Z goes to 450.0000 mm before others move, and at the end" in " ".join(program.notes)
    beyond = replace(probe, driving=Driving(clearance=("Z", 0.6)))
    with pytest.raises(ProgramError, match="outside its travel"):
        programs(mill, [beyond], places, dialect("linuxcnc"))
