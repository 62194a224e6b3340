"""A LinuxCNC that runs is attached to as if it were somebody's: interlocks, readings, and lines that are cut."""

import io
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partialmethod
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.sources.source import Answer, Request
from axiscal.cli.app import run
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.exceptions import SourceError
from axiscal.measurement.reading import Place
from axiscal.ports.linuxcnc.live import InForce, LiveSource, attached
from axiscal.ports.linuxcnc.live.connection import Connection
from axiscal_core.machine import Machine
from tests.generators import touched_table as table
from tests.linuxcnc.bench import Bench, quickened, running
from tests.linuxcnc.needed import WITH_SPHERES

pytestmark = WITH_SPHERES

FAST = table.MACHINE.replace('200 mm"]', '200 mm"]\nspeed = "90 m/min"\nacceleration = "50 m/s^2"')


@pytest.fixture(scope="module")
def shared() -> Iterator[Bench]:
    with running() as bench:
        yield bench


@pytest.fixture
def bench(shared: Bench, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Bench:
    """Return the machine ready, with everything as fast as can be but for the slow touch."""
    shared.ready()
    quickened(monkeypatch, tmp_path)
    monkeypatch.setattr(attached, "_SLOWER", 1)
    monkeypatch.setattr(Connection, "watched", partialmethod(by_hand, shared, Connection.watched))
    return shared


def by_hand(line: Connection, bench: Bench, watched: Callable[[Connection, float], str], seconds: float) -> str:
    """Press the stylus while it is waited for, and let it go."""

    def press() -> None:
        for value in (1, 0) if seconds > 1 else ():
            time.sleep(0.4)
            bench.pin("stuck", value)

    hand = threading.Thread(target=press)
    hand.start()
    try:
        return watched(line, seconds)
    finally:
        hand.join()


def description(readings: int = 2) -> CampaignDescription:
    text = table.CAMPAIGN.replace("readings = 8", f"readings = {readings}")
    text += 'raster = { A = "30 deg", C = "90 deg" }\n'
    return campaign_from_texts(text, "campaign.toml", FAST, "machine.toml")


def opened(bench: Bench, machine: Machine | None = None, begun: bool = True, answers: str = "go") -> LiveSource:
    line = Connection(bench.words())
    reader = LiveSource(line, machine or description().machine, InForce(), asked=lambda _: answers)
    reader._placed = "spheres" if begun else ""
    return reader


def untried(line: Connection, machine: Machine) -> LiveSource:
    """Return what reads without the trial above the ball."""
    reader = LiveSource(line, machine, InForce())
    reader._placed = "spheres"
    return reader


def request(campaign: CampaignDescription, place: Place, number: int = 1) -> Request:
    (setup,) = campaign.setups
    return Request(number, setup, campaign.machine.axes, place.pose, place.approach)


def test_a_campaign_on_a_machine_that_runs(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The command, over ssh: pressed by hand, tried 20 mm above, read, evaluated."""
    monkeypatch.chdir(tmp_path)
    campaign = description()
    Path("machine.toml").write_text(FAST)
    Path("campaign.toml").write_text(campaign.text)
    monkeypatch.setattr(sys, "stdin", io.StringIO("\n\ngo\n"))
    monkeypatch.setenv("PATH", bench.ssh(tmp_path))
    words = ["run", "campaign.toml", "--source", "linuxcnc-live:mill.local", "--out", "results"]
    with monkeypatch.context() as cutting:
        cutting.setattr(LiveSource, "read", partialmethod(cut_in_the_second, LiveSource.read))
        assert run(words) == 1
    said = capsys.readouterr().err
    assert "Press the stylus once by hand" in said
    assert "20 mm above the ball" in said
    assert "1 reading is kept" in " ".join(said.split())
    assert bench.stands()
    monkeypatch.setattr(sys, "stdin", io.StringIO("go\n"))
    assert run([*words, "--resume"]) == 0
    assert "20 mm above the ball" in capsys.readouterr().err
    with Campaign.open("results/campaign.axiscal", write=False) as kept:
        assert len(kept.state.readings) == 2
        for reading in kept.state.readings:
            found = 1e6 * np.array(reading.values)
            np.testing.assert_allclose(found, table.expected_at(campaign, reading.place), atol=2.0)
            assert reading.time is not None
    assert bench.stands()


def cut_in_the_second(reader: LiveSource, read: Callable[[LiveSource, Request], Answer], wanted: Request) -> Answer:
    """Read, and let the line be cut on the way to the second ball."""
    if wanted.reading == 2:
        line = reader._line
        assert line._lines.process.stdin is not None
        line._lines.process.stdin.close()
    return read(reader, wanted)


AMISS = {
    "emergency stop": "c.state(l.STATE_ESTOP)",
    "not switched on": "c.state(l.STATE_OFF)",
    "not every joint is homed": (
        "c.mdi('G53 G0 X0 Y0 Z0 A0 C0'); c.wait_complete(20)  # homing in place is at zero\n"
        "c.mode(l.MODE_MANUAL); c.wait_complete(5); c.teleop_enable(0); c.wait_complete(5); c.unhome(0)"
    ),
    "the spindle turns": "c.mode(l.MODE_MDI); c.wait_complete(5); c.mdi('M3 S100')",
    "the feed override is switched off": "c.mode(l.MODE_MDI); c.wait_complete(5); c.mdi('M49')",
    "above 100 %": "c.feedrate(1.1)",
    "a tool length offset": "c.mode(l.MODE_MDI); c.wait_complete(5); c.mdi('G43.1 Z5')",
    "is turned": "c.mode(l.MODE_MDI); c.wait_complete(5); c.mdi('G10 L2 P1 R5')",
    "a program is running": (
        "open('/tmp/p.ngc','w').write('M0\\nM2\\n'); c.mode(l.MODE_AUTO); c.wait_complete(5)\n"
        "c.program_open('/tmp/p.ngc'); c.auto(l.AUTO_RUN, 0)"
    ),
}


@pytest.mark.parametrize("why", AMISS)
def test_a_machine_that_is_not_as_it_has_to_be_is_not_moved(why: str, bench: Bench) -> None:
    bench.says(AMISS[why] + "\nc.wait_complete(5); time.sleep(0.3)")
    before = bench.says("print(s.joint_position)")
    with pytest.raises(SourceError, match=why):
        opened(bench)
    assert bench.says("print(s.joint_position)") == before


def test_the_probe_is_seen_open_and_closed_by_hand(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(attached, "_BY_HAND", 0.3)
    line = Connection(bench.words())
    with pytest.raises(SourceError, match="was not seen to close and open"):
        LiveSource(line, description().machine, InForce())
    bench.pin("stuck", 1)
    with pytest.raises(SourceError, match="the probe is closed"):
        LiveSource(Connection(bench.words()), description().machine, InForce())


def test_another_machine_is_refused(bench: Bench) -> None:
    machine = description().machine
    wide = tuple(replace(axis, travel=(-0.5, 0.5)) if axis.name == "X" else axis for axis in machine.axes)
    for other, why in [
        (replace(machine, axes=wide), "LinuxCNC lets X go from"),
        (replace(machine, axes=machine.axes[1:], errors=()), "LinuxCNC has axes A C X Y Z"),
        (replace(machine, tool=(0.0, 0.0, 0.0)), "the length of the tool is not known"),
    ]:
        with pytest.raises(SourceError, match=why):
            LiveSource(Connection(bench.words()), other, InForce())
    with pytest.raises(SourceError, match=r"in force is nothing .*, and it is to be a compensation"):
        LiveSource(Connection(bench.words()), machine, InForce(True))


def test_what_the_probe_meets_is_looked_at(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(attached, "_FAR", 1.0)
    campaign = description()
    (place,) = table.places(campaign, 1)
    amiss: dict[str, dict[str, float]] = {
        "met nothing": {"deaf": 1},
        "from where the ball is stated": {"bz0": -87.0, "bz1": -67.0},
        "show a radius of": {"radius": table.RADIUS + 0.5},
        "the stylus stays closed": {"sticky": 1},
    }
    for why, pins in amiss.items():
        bench.ready()
        reader = opened(bench)
        for name, value in pins.items():
            bench.pin(name, value)
        with pytest.raises(SourceError, match=why):
            reader.read(request(campaign, place))
        assert bench.stands()


def test_the_first_run_goes_above_the_ball_and_only_as_long_as_somebody_says_so(bench: Bench) -> None:
    campaign = description()
    (place,) = table.places(campaign, 1)
    reader = opened(bench, begun=False, answers="no")
    with pytest.raises(SourceError, match="the first run was ended by 'no'"):
        reader.read(request(campaign, place))
    reader = opened(bench, begun=False)
    bench.pin("radius", table.RADIUS + 19.0)
    with pytest.raises(SourceError, match="20 mm above the ball the probe met something"):
        reader.read(request(campaign, place))
    assert bench.stands()


class Cut(Connection):
    """A line that is cut after so many messages, a moment after the last of them."""

    def __init__(self, words: tuple[str, ...], after: int, how: str) -> None:
        self.left, self.how = after, how
        super().__init__(words)

    def _send(self, message: object) -> None:
        if self.how == "silent" and self.left <= 0:
            return  # no more signs of life
        super()._send(message)
        if not (isinstance(message, dict) and message.get("do") in ("line", "status", "probe")):
            return
        self.left -= 1
        if self.left == 0:
            time.sleep(0.03)
            if self.how == "interrupt":
                raise KeyboardInterrupt
            if self.how == "silent":
                return
            assert self._lines.process.stdin is not None
            self._lines.process.stdin.close()
            self._lines.process.kill()


@pytest.mark.parametrize(("after", "how"), [(2, "cut"), (6, "cut"), (13, "interrupt"), (21, "cut")])
def test_a_line_that_is_cut_leaves_the_machine_standing(after: int, how: str, bench: Bench) -> None:
    """While the probe is pressed, on the way, while a side is touched fast, and slowly."""
    campaign = description()
    (place,) = table.places(campaign, 1)
    line = Cut(bench.words(), after, how)
    with pytest.raises((SourceError, KeyboardInterrupt)):
        untried(line, campaign.machine).read(request(campaign, place))
    assert bench.stands()


def test_somebody_who_stops_or_moves_the_machine_ends_the_run(bench: Bench) -> None:
    """On the way, while a side is looked for, and between readings."""
    for code in ["G53 G1 Z100 F3000", "G38.3 Z100 F3000"]:
        bench.ready()
        line = Connection(bench.words())
        line.line("G53 G1 Z199 F9000")
        hand = threading.Timer(0.3, lambda: bench.says("c.abort(); c.wait_complete(5)"))
        hand.start()
        with pytest.raises(SourceError, match="somebody stopped it"):
            line.line(code)
        hand.join()
        assert bench.stands()
        assert float(bench.says("print(s.position[2])")) > 101.0
    bench.ready()
    campaign = description()
    first, second = table.places(campaign, 2)
    reader = opened(bench)
    reader.read(request(campaign, first))
    bench.says("c.mdi('G91 G1 X5 F6000'); c.wait_complete(20)")
    with pytest.raises(SourceError, match="where the last reading left it"):
        reader.read(request(campaign, second, 2))
    assert bench.stands()


def test_a_line_that_says_nothing_more_stops_the_machine(bench: Bench, tmp_path: Path) -> None:
    agent = tmp_path / "agent.py"
    agent.write_text(agent.read_text().replace("SILENCE = 5.0", "SILENCE = 2.0"))
    line = Cut(bench.words(), 2, "silent")
    line.line("G53 G1 Z170 F600")  # 3 s, with signs of life
    with pytest.raises(SourceError, match="was cut"):
        line.line("G53 G1 Z-100 F600")
    assert bench.stands()
    assert float(bench.says("print(s.position[2])")) > 100.0


def test_only_lines_that_are_meant_are_executed(bench: Bench) -> None:
    line = Connection(bench.words())
    for code in [
        "G0 X1",
        "M3 S1",
        "G53 G1 X1 F1000000",
        "G53 G1 X1",
        "G53 G1 X1 F10\nM3",
        "O<x> CALL",
        "G38.2 X1 F1",
        "G38.3 A1 F1",
        "G91 G1 X1 F1",
    ]:
        with pytest.raises(SourceError, match="is no line that is executed here"):
            line.line(code)
        line = Connection(bench.words())
    with pytest.raises(SourceError, match="limit"):
        line.line("G53 G1 X900 F1000")


def test_modes_are_left_as_they_were(bench: Bench) -> None:
    def modes() -> set[str]:
        """Return the codes in force but for that of the last motion."""
        return set(bench.says("print(*s.gcodes[1:])").split()) - {"0", "10", "-1"}

    bench.says("c.mdi('G64 P0.05 Q0.02 G91'); c.wait_complete(5); c.mdi('G20'); c.wait_complete(5)")
    bench.says("c.mdi('F12.5'); c.wait_complete(5)")
    before, path = modes(), bench.says("print(*(round(each, 5) for each in (s.settings[1], *s.settings[3:5])))")
    line = Connection(bench.words())
    line.line("G53 G1 Z190 F9000")
    line.close()
    assert modes() == before
    assert bench.says("print(*(round(each, 5) for each in (s.settings[1], *s.settings[3:5])))") == path
    assert path.split()[0] == "12.5"
    assert "200" in before
