"""The program beside a running LinuxCNC, on a stand-in for the module `linuxcnc` that others give commands too."""

import re
import sys
import types
from collections.abc import Callable
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import pytest

from axiscal.campaign.sources.source import Request
from axiscal.description.campaign import campaign_from_texts
from axiscal.exceptions import SourceError
from axiscal.ports.linuxcnc.live import LiveSource, connection
from axiscal.ports.linuxcnc.live.attached import _WayToBall
from axiscal.programs.steps import Move, Touched
from tests.generators import touched_table as table

MODE_MANUAL, MODE_MDI, DONE, EXEC, IDLE = 1, 3, 1, 2, 1


@pytest.mark.parametrize(("there", "why"), [(False, "not installed"), (True, "does not run here: nobody")])
def test_where_no_linuxcnc_is_a_sentence_says_so(
    there: bool, why: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    if there:
        fails = "def poll(self): raise error('nobody')"
        text = f"class error(Exception): pass\nclass stat:\n    {fails}\ncommand = ini = error_channel = stat\n"
        (tmp_path / "linuxcnc.py").write_text(text)
    words = ("env", f"PYTHONPATH={tmp_path}", sys.executable, "-u", "-c", connection._FIRST)
    with pytest.raises(SourceError, match=why):
        connection.Connection(words)
    assert capfd.readouterr().err == ""


class Control:
    """What LinuxCNC knows, one for all its clients; a move takes four looks at it."""

    def __init__(self) -> None:
        self.number, self.state, self.mode, self.given = 7, DONE, MODE_MDI, list[str]()
        self.at = dict.fromkeys("XYZAC", 0.0)
        self.way: list[dict[str, float]] = []
        self.feed, self.modes = 1.0, {200, 910, 930, 640}
        self.during: Callable[[], None] | None = None
        self.tilted = 0.0
        self.refuses = ""

    def other(self, **changes: Any) -> None:
        """Another client gives a command."""
        self.number += 1
        for name, value in changes.items():
            setattr(self, name, value)

    def abort(self) -> None:
        self.way, self.state = [], DONE

    def mdi(self, code: str) -> None:
        self.given.append(code)
        if self.refuses and self.refuses in code:
            return
        for old, new in ((200, 210), (910, 900), (930, 940), (640, 610)):
            if f"G{new // 10}" in code.split():
                self.modes = self.modes - {old} | {new}
            if f"G{old // 10}" in code.split():
                self.modes = self.modes - {new} | {old}
        if " G53 G1 " in code or " G38.3 " in code:
            words = {a: float(value) for a, value in re.findall(r" ([XYZAC])(-?[\d.]+)", code)}
            self.way = [{a: at + (words.get(a, at) - at) * k / 4 for a, at in self.at.items()} for k in (1, 2, 3, 4)]
            self.state = EXEC

    def step(self) -> None:
        if self.way:
            self.at = self.way.pop(0)
            self.state = EXEC if self.way else DONE
            if len(self.way) == 2 and self.during:
                self.during()


class Stat:
    def __init__(self, control: Control) -> None:
        self._control = control
        self.homed, self.joints, self.spindles, self.spindle = [1] * 5, 5, 0, ()
        self.estop, self.enabled, self.linear_units, self.angular_units = 0, 1, 1.0, 1.0
        self.rapidrate, self.max_velocity, self.ini_filename = 1.0, 100.0, ""
        self.g5x_offset = self.g92_offset = self.tool_offset = (0.0,) * 9
        self.settings = (0.0, 150.0, 0.0, 0.05, 0.02)
        self.axis = [{"min_position_limit": -500.0, "max_position_limit": 500.0}] * 9
        self.probed_position, self.probe_tripped, self.probe_val = (0.0,) * 9, False, False
        self.poll()

    def poll(self) -> None:
        control = self._control
        control.step()
        at = control.at
        self.position = tuple(at.get(a, 0.0) for a in "XYZABCUVW")
        self.joint_position = (at["X"] + control.tilted * abs(at["A"]), *(at[a] for a in "YZAC"))
        self.echo_serial_number, self.state, self.task_mode = control.number, control.state, control.mode
        self.interp_state, self.inpos, self.queue = IDLE, not control.way, len(control.way)
        self.feedrate, self.gcodes = control.feed, (0, *control.modes)


class Command:
    def __init__(self, control: Control) -> None:
        self._control, self.serial = control, 0

    def _given(self, do: Callable[[], None]) -> None:
        self._control.number += 1
        self.serial = self._control.number
        do()

    def mdi(self, code: str) -> None:
        self._given(lambda: self._control.mdi(code))

    def mode(self, mode: int) -> None:
        self._given(lambda: setattr(self._control, "mode", mode))

    def abort(self) -> None:
        self._control.given.append("abort")
        self._given(self._control.abort)

    def wait_complete(self, _: float) -> int:
        return DONE


@pytest.fixture
def control() -> Control:
    return Control()


@pytest.fixture
def module(control: Control, monkeypatch: pytest.MonkeyPatch) -> types.ModuleType:
    fake = types.ModuleType("linuxcnc")
    for name, value in {
        "command": lambda: Command(control),
        "stat": lambda: Stat(control),
        "error_channel": lambda: types.SimpleNamespace(poll=lambda: None),
        "ini": lambda _: types.SimpleNamespace(find=lambda *_: "X Y Z A C"),
        "MODE_MDI": MODE_MDI,
        "RCS_DONE": DONE,
        "RCS_EXEC": EXEC,
        "INTERP_IDLE": IDLE,
    }.items():
        setattr(fake, name, value)
    monkeypatch.setitem(sys.modules, "linuxcnc", fake)
    spec = spec_from_file_location("live_agent", connection._AGENT)
    assert spec is not None
    assert spec.loader is not None
    loaded = module_from_spec(spec)
    spec.loader.exec_module(loaded)
    monkeypatch.setattr(loaded.Agent, "_listen", lambda _: None)
    return loaded


@pytest.fixture
def agent(module: types.ModuleType) -> Any:
    return module.Agent()


def test_a_move_is_made_in_its_own_modes_which_are_set_before_every_one(agent: Any, control: Control) -> None:
    for end in (5.0, 7.0):
        assert "failure" not in agent.line(f"G53 G1 X{end} F600")
        assert control.at["X"] == end
        control.modes = {200, 910, 930, 640}  # as by an M2 of nobody's program
    plain = [place for place, code in enumerate(control.given) if code.startswith("G21 G90 G94 G61")]
    assert len(plain) == 2


def test_an_axis_that_stands_at_its_limit_is_named_for_a_touch_leaves_it_a_hair_beyond(
    agent: Any, control: Control
) -> None:
    agent.stat.axis = [*agent.stat.axis[:5], {"min_position_limit": 0.0, "max_position_limit": 360.0}, *[{}] * 3]
    control.at["C"] = -1e-17
    assert "failure" not in agent.line("G53 G1 X5 F600")
    (move,) = [code for code in control.given if "G53" in code]
    assert " C0.000000" in move
    control.at["C"] = -1e-17
    assert "failure" not in agent.line("G38.3 X4 F600")
    turned, probed = (code for code in control.given[-3:] if "G53 G1" in code or "G38.3" in code)
    assert "G53 G1 C0.000000 F" in turned
    assert "G38.3 X4.000000 F" in probed
    control.at["C"] = 359.0
    assert "failure" not in agent.line("G53 G1 X6 F600")
    assert " C" not in control.given[-1]


def test_modes_that_are_not_taken_are_a_failure(agent: Any, control: Control) -> None:
    control.refuses = "G61 G17"
    assert "was not executed" in agent.line("G53 G1 X5 F600")["failure"]
    assert control.at["X"] == 0.0


def stopped(control: Control, **changes: Any) -> None:
    """Somebody presses Esc."""
    control.abort()
    control.other(**changes)


def test_a_touch_goes_to_places_of_the_machine_with_inches_and_shifts_in_force(agent: Any, control: Control) -> None:
    """G20 and G92 are the owner's: moves are made in mm, and a touch ends where it was meant."""
    agent.stat.linear_units, agent.stat.g92_offset = 1 / 25.4, (1.0, *(0.0,) * 8)  # inches
    agent.line("G38.3 X5 F600")
    assert "G21 G90 G94 G38.3 X-20.400000 F600" in control.given
    agent.line("G53 G1 X5 F600")
    assert any(code.startswith("G21 G90 G94 G53 G1") and "X5.000000" in code for code in control.given)


@pytest.mark.parametrize("changes", [{}, {"feed": 0.5}], ids=["plainly", "as if by an override"])
@pytest.mark.parametrize("code", ["G53 G1 X5 F600", "G38.3 X5 F600"])
def test_a_stop_at_the_machine_is_no_move_that_is_done(
    agent: Any, control: Control, code: str, changes: dict[str, Any]
) -> None:
    agent.line("G53 G1 X1 F600")
    control.during = lambda: stopped(control, **changes)
    assert "somebody stopped it" in agent.line(code)["failure"]
    assert control.at["X"] < 5


def test_overrides_are_anybodys_and_the_move_goes_on(agent: Any, control: Control) -> None:
    control.during = lambda: control.other(feed=control.feed / 2)
    assert "failure" not in agent.line("G53 G1 X5 F600")
    assert control.at["X"] == 5


@pytest.mark.parametrize("changes", [{}, {"mode": MODE_MANUAL, "feed": 0.9}], ids=["command", "mode of the task"])
def test_after_another_command_or_mode_between_moves_no_more_are_made(
    agent: Any, control: Control, changes: dict[str, Any]
) -> None:
    agent.line("G53 G1 X5 F600")
    control.other(**changes)
    assert "somebody" in agent.line("G53 G1 X7 F600")["failure"]
    assert control.at["X"] == 5
    assert "abort" not in control.given


def test_tool_point_kinematics_end_after_the_first_degree(agent: Any, control: Control) -> None:
    """With rotary axes at zero joints and axes are alike in either mode."""
    control.tilted = 0.02  # mm of a slide for each degree
    assert "identity mode" in agent.line("G53 G1 A90 F600")["failure"]
    assert control.at["A"] == 1.0
    control.tilted, control.at["A"] = 0.0, 0.0
    agent.turned.clear()
    assert "failure" not in agent.line("G53 G1 A90 F600")
    assert control.at["A"] == 90.0


def test_only_a_move_of_our_own_is_aborted(module: types.ModuleType, agent: Any, control: Control) -> None:
    agent.line("G53 G1 X5 F600")
    control.other()  # the owner's own program runs now
    agent.gone = True
    agent.serve()
    assert "abort" not in control.given
    moving = module.Agent()
    moving.asked.put({"do": "line", "code": "G53 G1 X9 F600"})
    control.during = moving.leave
    moving.serve()
    assert "abort" in control.given
    assert control.at["X"] < 9


def test_the_machine_is_left_as_it_was_also_if_nobody_listens(
    module: types.ModuleType, agent: Any, control: Control, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(_: object) -> None:
        raise BrokenPipeError

    monkeypatch.setattr(module, "_tell", broken)
    agent.asked.put({"do": "line", "code": "G53 G1 X5 F600"})
    agent.serve()
    assert control.modes == {200, 910, 930, 640}
    assert control.given[-1] == "G64 P0.050000 Q0.020000"


def test_modes_that_cannot_be_set_again_are_said(
    agent: Any, control: Control, capsys: pytest.CaptureFixture[str]
) -> None:
    agent.line("G53 G1 X5 F600")
    assert 900 in control.modes
    agent.stat.enabled = 0
    agent.gone = True
    agent.serve()
    assert '"left": "G' in (said := capsys.readouterr().out)
    assert "G64 P0.05" in said


def test_the_trial_above_the_ball_goes_at_a_quarter_of_every_feed() -> None:
    lines = list[str]()

    def made(code: str) -> dict[str, bool]:
        lines.append(code)
        return {"tripped": False}

    line: Any = types.SimpleNamespace(line=made)
    reader = object.__new__(LiveSource)
    campaign = campaign_from_texts(table.CAMPAIGN, "campaign.toml", table.MACHINE, "machine.toml")
    (place,) = table.places(campaign, 1)
    (setup,) = campaign.setups
    reader._line, reader._machine, reader._asked = line, campaign.machine, lambda _: "go"
    reader._singly = True
    way = _WayToBall(campaign.machine, Request(1, setup, campaign.machine.axes, place.pose, place.approach))
    steps = way.trial()
    reader._try(steps)
    feeds = [int(code.rpartition("F")[2]) for code in lines]
    expected = list[int]()
    for step in steps:
        assert isinstance(step, Move | Touched)
        expected += [step.fast, step.travel] if isinstance(step, Touched) else [min(step.feed, 2000)]
    assert feeds == [feed // 4 for feed in expected]
    assert any(code.startswith("G38.3") for code in lines)
