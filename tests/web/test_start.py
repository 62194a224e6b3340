"""From nothing to the first reading on the page: what a person sees, touches and types, and what stands on the disk."""

import json
import os
import re
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.language.spoken import speaking
from axiscal.planning.next_readings import next_places
from axiscal.present.plan_answer import coming_answer
from axiscal.web import draft, shapes
from tests.commands import Command
from tests.golden.surfaces import of_paper, plain
from tests.measurement.test_instrument_files import RTL
from tests.measurement.test_written_instruments import GRID
from tests.web.browser import Browser, Page
from tests.web.served import PATIENCE, Answer, Served, kept, served
from tests.web.test_page import SHOWN, looked_at, stood, type_reading

PRINTER = """\
[printer]
kinematics: corexy
max_velocity: 300    # mm/s
max_accel = 3000
[stepper_x]
position_max: 250
[stepper_y]
position_max: 210
[stepper_z]
position_min: -5
position_max: 220
[probe]
x_offset: 0
#*# [probe]
#*# z_offset = 1.2
"""
HELD = """(() => {
  const ask = window.fetch;
  const held = new Promise((release) => { window.release = release; });
  window.fetch = async (...words) => {
    const answer = await ask(...words);
    if (words[0].endsWith("/plan") && !window.here) { window.here = true; await held; }
    return answer;
  };
})()"""
"""Holds the first plan back until it is released."""


class Person:
    """Eyes and fingers at a page: sees buttons by their words, and counts what is done."""

    def __init__(self, page: Page) -> None:
        self.page, self.actions = page, 0

    def tick(self, row: str) -> None:
        """Tick a row, or take the tick away."""
        self.actions += 1
        self.page.value(f"document.querySelector('[data-row=\"{row}\"]').click()")

    def slide(self, steps: int) -> None:
        """Move the slider to the right; it says at once what that buys."""
        self.actions += 1
        before = self.page.value("document.getElementById('buys').textContent")
        self.page.value("document.getElementById('minutes').focus()")
        for _ in range(steps):
            self.page.press("ArrowRight")
            assert self.page.value("document.getElementById('buys').textContent") != before

    def until(self, row: str, *, there: bool) -> None:
        """Wait until the plan is made, and says how well a row will be known, or no longer does."""
        known = f"document.querySelector('[data-row=\"{row}\"]')?.closest('tr').lastElementChild.textContent"
        self.page.until(f"!document.getElementById('begin').disabled && Boolean({known}) === {json.dumps(there)}")

    def press(self, words: str) -> None:
        """Click on the button, or the option, that begins with these words, as soon as it can be pressed."""
        self.actions += 1
        button = f"""[...document.querySelectorAll("button, summary")].find(e => e.checkVisibility() && !e.disabled
            && e.innerText.trim().startsWith({json.dumps(words)}))"""
        middle = "const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2];"
        place = f"(e => {{ e.scrollIntoView(); {middle} }})({button})"
        self.page.until(f"{button} !== undefined")
        x, y = self.page.value(place)
        for kind in ("mousePressed", "mouseReleased"):
            self.page.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def drop(self, file: Path) -> None:
        """Drop a file on the page."""
        self.actions += 1
        data = {"items": [], "files": [str(file)], "dragOperationsMask": 1}
        for kind in ("dragEnter", "dragOver", "drop"):
            self.page.call("Input.dispatchDragEvent", type=kind, x=200, y=200, data=data)

    def sees(self, words: str) -> None:
        """Wait until words stand on the page."""
        self.page.until(f"document.body?.innerText.includes({json.dumps(words)})")

    def write(self, field: str, text: str) -> None:
        """Write into a field, in the place of what stands there."""
        self.actions += 1
        self.page.until(f"document.getElementById('{field}') !== null")
        self.page.value(f"document.getElementById('{field}').select()")
        self.page.type(text)

    def mount(self) -> None:
        """Say that it stands, and type what the display shows after the jog that is asked for."""
        self.press("It stands")
        stood(self.page)  # nobody knows the temperature

    def type(self, text: str) -> None:
        """Type where the focus is, and press Enter."""
        self.actions += 2
        self.page.enter(text)

    def read(self, text: str) -> None:
        """Type the first reading, which the page asks for."""
        self.actions += 2
        type_reading(self.page, text)


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Served]:
    """The start of an empty folder."""
    with served(tmp_path) as running:
        yield running


def arrived(browser: Browser, server: Served, width: int = 1400) -> Person:
    page = browser.page(width, 900)
    page.open(server.address)
    page.until("document.getElementById('start').offsetParent !== null")
    return Person(page)


def arrives(file: Path) -> bytes:
    """Return the content of a file that a browser saves, once it is there."""
    deadline = time.monotonic() + PATIENCE
    while not (file.is_file() and file.stat().st_size):
        assert time.monotonic() < deadline, [path.name for path in file.parent.iterdir()]
        time.sleep(0.03)
    return file.read_bytes()


@pytest.mark.chromium
@pytest.mark.long
def test_from_nothing_to_the_first_reading_of_a_router(browser: Browser, start: Served) -> None:
    person = arrived(browser, start)
    page = person.page
    looked_at(page)
    person.press("Calibrate a machine")
    person.press("router")
    page.until("document.querySelector('#machine-drawing img').naturalWidth > 200")
    person.write("travel-X", "900 kg")
    person.sees('"900 kg"')
    assert page.value("document.getElementById('machine-next').disabled")
    assert [path.name for path in start.record.iterdir()] == ["axiscal-draft"]
    person.write("travel-X", "900")
    person.press("head moves")
    person.sees("table moves")
    person.press("Home-made")
    looked_at(page)
    person.press("Next")
    person.press("dial")
    person.press("square")
    person.sees("+ laser")
    looked_at(page)
    person.tick("squareness YZ")
    person.until("squareness YZ", there=False)
    person.until("squareness XY", there=True)
    person.write("target", "1")
    assert page.value("document.getElementById('begin').disabled")  # what is shown is the plan of another target
    person.write("target", " ")
    person.actions -= 2
    person.press("Plan")
    page.until("document.getElementById('buying').offsetParent !== null")
    (minutes,) = re.findall(r", (\d+) MIN", page.value("document.getElementById('first').textContent"))
    parts = page.value("[...document.querySelectorAll('#strip small')].map(e => parseInt(e.textContent))")
    assert sum(parts) == pytest.approx(int(minutes), rel=0, abs=(len(parts) + 1) / 2)  # each is rounded
    looked_at(page)
    person.slide(1)
    person.press("Begin")
    looked_at(page)
    person.mount()
    looked_at(page)
    person.read("1.5")
    assert person.actions <= 25
    assert page.complaints() == []
    (record,) = start.record.glob("*/*.axiscal")
    with Campaign.open(record, write=False) as campaign:
        assert [reading.value for reading in campaign.state.readings] == [pytest.approx(1.5e-6)]
        assert "test of sign" in campaign.state.notes[0].text
        machine, target = campaign.description.machine, campaign.description.target
    assert {axis.name for axis in machine.axes if axis.workpiece_side} == {"X"}
    assert (round(machine.axis("X").length, 9), record.parent.name) == (0.9, record.stem)
    wanted = {want.row.name for want in target.wants}
    assert {"squareness XY", "straightness X in Y"} <= wanted
    assert "squareness YZ" not in wanted
    assert target.budget is not None
    files = {path.name for path in record.parent.iterdir()}
    assert {"machine.toml", "campaign.toml"} <= files
    assert not (start.record / "axiscal-draft").exists()


@pytest.mark.chromium
@pytest.mark.long
def test_a_lathe_with_a_laser_to_the_loaded_table(browser: Browser, start: Served) -> None:
    """To the report and a check of the tables; slips at the display are named before anything is written."""
    person = arrived(browser, start)
    page = person.page
    for words in ("Virtual machine", "lathe"):
        person.press(words)
    person.sees("X, the radius")
    for words in ("Next", "laser"):
        person.press(words)
    person.until("positioning Z", there=True)
    for words in ("Plan", "Begin", "It stands"):
        person.press(words)
    page.until("document.activeElement.id === 'jogged'")
    person.type("-100")
    person.sees("The display counts the other way. Turn it round")
    person.type("0.1")
    person.sees("The display is in mm, not in µm. Type the unit behind each number")
    looked_at(page)
    person.type("0.1 mm")
    page.until("document.activeElement.id === 'sentence'")
    person.type("21")
    person.read(start.state()["shows"])
    assert person.actions <= 30
    for number in range(2, 21):
        if page.until(f"{SHOWN}('stands') && 'stands' || {SHOWN}('field') && 'field'") == "stands":
            person.mount()  # how many readings another set-up is after depends on the machine
        person.type(start.state()["shows"])
        taken = f"document.getElementById('count').textContent.startsWith('reading {number + 1} ')"
        if page.until(f"{taken} ? 'kept' : {SHOWN}('doubt') && 'doubt'") == "doubt":  # any machine may surprise
            person.press("really so")
            page.until(taken)
    person.press("more")
    person.press("Stop here")
    person.press("End it here")
    person.sees("Report to sign (PDF)")
    looked_at(page)
    page.saves_into(start.record)
    for words, file in (("Download", "linuxcnc.zip"), ("Report to sign (PDF)", "report.pdf")):
        person.press(words)
        assert arrives(start.record / file)
    begun = person.actions
    person.press("Loaded: verify now")
    person.sees("PLACES TO CHECK")
    assert person.actions - begun == 1
    person.press("Judge")
    person.sees("missing")
    looked_at(page)
    person.press("Let the virtual machine read")
    person.press("Judge")
    person.sees("AS PROMISED")
    looked_at(page)
    person.press("Undo")
    page.until("document.activeElement.id === 'stands' || document.activeElement.id === 'field'")
    (start.record / "torn.axiscal").write_text("axiscal record 9\n")
    person.press("Start")
    person.sees("torn.axiscal")
    looked_at(page)
    person.press("Go on: Lathe, 20 of")
    page.until("['stands', 'field'].includes(document.activeElement?.id)")
    (record,) = start.record.glob("*/*.axiscal")
    assert start.state()["record"] == record.name
    assert {"found.csv", "left.csv"} <= {file.name for file in record.parent.iterdir()}
    with served(record) as again:  # the record alone says which machine it is
        assert again.state()["shows"] == start.state()["shows"]


@pytest.mark.chromium
@pytest.mark.long
def test_back_of_the_page_and_of_the_browser_go_one_screen_back(browser: Browser, start: Served) -> None:
    person = arrived(browser, start)
    screen = "[...document.querySelectorAll('.screen')].filter(e => !e.hidden).map(e => e.id).join()"
    for words in ("Calibrate a machine", "one axis", "Next", "laser", "Plan"):
        person.press(words)
    person.page.until(f"{screen} === 'plan'")
    backs = ("Back", "browser", "Back")
    for reload in (False, True):
        for back, shown in zip(backs, ("with", "machine", "start"), strict=True):
            if reload:
                while start.call("start").document["draft"]["screen"] != person.page.value(screen):
                    time.sleep(0.05)  # it is not on the disk yet
                person.page.value("window.old = true")
                person.page.call("Page.reload")
                person.page.until(f"!window.old && {screen} !== ''")
            if back == "Back":
                person.press("Back")
            else:
                person.page.value("history.back()")
            person.page.until(f"{screen} === '{shown}'")
        person.press("Calibrate a machine")
        person.press("Next")
        person.press("Plan")
        person.page.until(f"{screen} === 'plan'")


@pytest.mark.chromium
@pytest.mark.long
def test_a_plan_that_comes_too_late_is_not_shown(browser: Browser, start: Served) -> None:
    """It stood there with Begin beside it, and another one began."""
    person = arrived(browser, start)
    for words in ("Calibrate a machine", "one axis", "Next"):
        person.press(words)
    person.page.value(HELD)
    person.press("laser")
    person.page.until("window.here")
    person.write("target", "1")
    person.sees("CANNOT BE REACHED")
    person.page.value("release(); new Promise(done => setTimeout(done, 300))")
    assert "CANNOT BE REACHED" in person.page.value("document.getElementById('first').textContent")


@pytest.mark.chromium
@pytest.mark.long
def test_a_file_from_a_spreadsheet_arrives_letter_by_letter(browser: Browser, start: Served) -> None:
    """In a page of Windows it was spoilt; the command reads it in each of these."""
    person = arrived(browser, start)
    table = "setup;X_mm;approach;value_µm\nPrüftisch – außen;100;+;1,5\n"
    long = table.ljust(4 * shapes.LETTERS - 5) + "ä" * 9  # whose beginning ends within a letter of two bytes
    for number, (letters, code) in enumerate(
        [(table, "cp1252"), (table, "utf-8-sig"), (table, "utf-16"), (long, "utf-8")]
    ):
        file = start.record / f"table{number}.csv"
        file.write_bytes(letters.encode(code))
        person.drop(file)
        person.page.until(
            f"fetch('/api/1/start', {{ headers: {{ Authorization: 'Bearer {start.token}' }} }})"
            f".then((answer) => answer.json()).then((found) => found.draft.file === '{file.name}')"
        )
        assert start.call("start").document["draft"]["text"] == letters[: shapes.LETTERS], code


def test_requests_of_a_campaign_are_refused_until_there_is_one(start: Served) -> None:
    for path in ("state", "typed?text=1", "cost"):
        refused = start.call(path)
        assert (refused.status, refused.document["problem"]) == (422, "refused"), path
    assert "No machine is chosen" in start.call("plan").document["sentence"]
    assert start.call("open", record="../mill.axiscal").document["problem"] == "refused"
    assert start.call("draft", file="../x.ini").document["problem"] == "malformed"


def test_what_is_wrong_is_said_by_its_field(start: Served) -> None:
    made = start.call("draft", machine="one-axis", travels={"X": "5 kg"}, target="2 min").document
    assert set(made["faults"]) == {"travels.X", "target"}
    assert made["faults"]["target"].startswith('"2 min" is a time, not a length')
    assert "interferometer" in made["offered"]
    assert "square" not in made["offered"]
    assert start.call("draft", machine="one-axis", travels={"X": "0,4"}).document["faults"]["travels.X"]
    assert start.call("draft", machine="one-axis", travels={"X": "1.000 mm"}).document["faults"]["travels.X"]
    made = start.call("draft", machine="one-axis", travels={"X": "40 cm"}).document
    assert (made["faults"], made["lengths"]) == ({}, {"X": 400.0})
    offered = start.call("draft", machine="turning-centre").document["offered"]
    assert ("indexer" in offered, "sphere" in offered) == (True, False)  # no Y brings a probe round a ball


DROPPED = {
    "setup,X_mm,approach,value_um\nlaser,100,+,1.5\n": "a table of readings",
    "HEADER::\nTARGET DATA::\n": "a positioning test (.rtl)",
    "setup,X\nlaser,0 mm,+1\n": "This is no file of a control. Give the INI",
    "": "This is no file of a control",
}


def test_a_dropped_file_says_what_it_is(start: Served) -> None:
    made = {text: start.call("draft", file="dropped.txt", text=text).document for text in DROPPED}
    said = {text: each["faults"].get("file", f"dropped.txt: {each['readings']}") for text, each in made.items()}
    assert [each for text, each in said.items() if not each.startswith(f"dropped.txt: {DROPPED[text]}")] == []


def opened(start: Served) -> Answer:
    return start.ask("POST", "/api/1/open", b'{"record": ""}', Authorization=f"Bearer {start.token}")


def test_a_dropped_file_of_a_control_is_one_in_german_too(tmp_path: Path) -> None:
    """It was taken for readings, called by the head of the catalogue."""
    with speaking("de"):
        made = draft.keep(tmp_path, shapes.DraftShape(file="printer.cfg", text=PRINTER, instruments=["probe"]))
    assert (made.title, made.readings, made.faults) == ("3D printer (corexy)", "", {})


def test_dropped_readings_become_an_answer(start: Served) -> None:
    """The file of a laser names no axis, which a person then does."""
    chosen = {"machine": "three-axis-mill", "instruments": ["interferometer"], "file": "x.rtl", "text": RTL}
    assert start.call("draft", **chosen).document["readings"] == "a positioning test (.rtl)"
    assert "several set-ups" in opened(start).document["sentence"]
    cut = (RTL + " " * shapes.LETTERS)[: shapes.LETTERS]
    assert "of up to 48000 letters" in start.call("draft", **chosen | {"text": cut}).document["faults"]["file"]
    assert start.call("draft", **chosen, along="X").document["faults"] == {}
    state = opened(start).document["state"]
    assert (state["finished"], state["results"]) == ("all readings evaluated", "three-axis-mill-results")
    folder = start.record / "three-axis-mill"
    assert sorted(file.name for file in folder.glob("*.rtl")) == ["x.rtl"]
    assert len(kept(folder / "three-axis-mill.axiscal")) == 12
    assert plain("positioning X") in of_paper(folder / state["results"] / "report.pdf")


def test_a_curve_that_cannot_be_planned_is_none(start: Served) -> None:
    """A quick click took the last instrument away while the curve was asked for."""
    start.call("draft", machine="one-axis", instruments=[])
    assert start.call("plan").status == 422
    answer = start.call("curve")
    assert (answer.status, answer.body) == (200, b"null")


def test_the_page_plans_roughly_what_is_measured(start: Served) -> None:
    """Figures of the lattice are near those of the plan in full, which begins."""
    start.call("draft", machine="lathe", instruments=["interferometer"])
    rough = start.call("plan").document["answer"]["document"]
    opened(start)
    (record,) = start.record.glob("*/*.axiscal")
    with Campaign.open(record, write=False) as campaign:
        exact, places = coming_answer(campaign), next_places(campaign.case(), campaign.estimate().knowledge, ())
        assert campaign.state.coming == places  # as every other way to begin plans it
    assert exact is not None
    pairs = zip([row["known_to"] for row in rough["rows"]], [row.known_to for row in exact.rows], strict=True)
    assert all(0.8 < one / other < 1.25 for one, other in pairs)
    assert rough["minutes"] == pytest.approx(exact.minutes, rel=0.02)


def test_an_instrument_of_a_package_or_of_the_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    brought = tmp_path / "acme-1.dist-info"
    brought.mkdir()
    (brought / "entry_points.txt").write_text("[axiscal.instruments]\nacme = acme_grid:Grid\n")
    (tmp_path / "acme_grid.py").write_text(GRID)
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{os.environ.get('PYTHONPATH', '')}")
    (tmp_path / "torn.py").write_text("class Torn(ac.Instrument:\n")
    own = "acme_grid.py:Grid"
    with served(tmp_path) as start:
        names = start.call("start").document["instruments"]
        assert [name for name in names if name == "acme" or ".py:" in name] == ["acme", own]
        assert {"acme", own} <= {*start.call("draft", machine="one-axis", instruments=[own]).document["offered"]}
        for name in ("acme", own):
            assert "positioning X" in start.call(f"rows?instrument={name}").document["rows"]
        drawn = start.ask("GET", "/machine.svg?width=400&instrument=acme", Authorization=f"Bearer {start.token}")
        assert b"acme" in drawn.body
        assert start.call("plan").status == 200
    assert (tmp_path / "axiscal-draft" / "acme_grid.py").is_file()


@pytest.mark.long
def test_a_campaign_that_is_open_is_not_begun_again(start: Served) -> None:
    start.call("draft", machine="one-axis", instruments=["interferometer"], compensated="no")
    plan = start.call("plan").document
    assert (plan["answer"]["document"]["setups"][0]["setup"], plan["minds"]) == ("laser along X", [])
    bearer = {"Authorization": f"Bearer {start.token}"}
    begun = start.ask("POST", "/api/1/open", b'{"record": ""}', **bearer)
    assert (begun.status, begun.document["state"]["question"]["number"]) == (200, 1)
    again = start.ask("POST", "/api/1/open", b'{"record": ""}', **bearer)
    assert (again.status, again.document["problem"]) == (409, "overtaken")
    assert [path.name for path in start.record.iterdir()] == ["one-axis"]


@pytest.mark.long
def test_a_plan_that_is_overtaken_by_another_choice_is_no_answer(start: Served) -> None:
    chosen = {"machine": "router", "compensated": "no"}
    start.call("draft", instruments=["dial", "square"], **chosen)
    with ThreadPoolExecutor(1) as aside:
        first = aside.submit(start.call, "plan")
        while not start.call("stage").document["sentence"]:
            time.sleep(0.05)
        start.call("draft", instruments=["interferometer"], without=["volume"], **chosen)
        plan = start.call("plan").document
        assert first.result().document is None
    wanted = {row["kind"] for row in plan["answer"]["document"]["rows"]}
    assert wanted == {"positioning", "scale", "backlash"}
    assert start.call("draft", machine="router", size="worn").document["problem"] == "malformed"
    start.call(
        "draft", instruments=["dial"], without=list(start.call("rows?instrument=dial").document["rows"]), **chosen
    )
    assert start.call("plan").document["sentence"] == "Nothing is to be known. Tick a row at least."


def test_alone_at_a_screen_the_command_opens_the_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command
) -> None:
    """In a pipe it stays the help: `tests/cli/test_cli.py`."""
    seen = list[object]()

    def serve_page(record: Path | None, port: int, ready: Callable[[str], None]) -> str:
        seen.append(record)
        ready("http://127.0.0.1:1/#x")
        return ""

    (tmp_path / "mill.axiscal").touch()  # the only record here, which `serve` alone would open
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("axiscal.cli.app._at_a_screen", lambda: True)
    monkeypatch.setattr("axiscal.web.serving.serve_page", serve_page)
    monkeypatch.setattr("webbrowser.open", seen.append)
    assert "Open http://127.0.0.1:1/#x" in command().out
    assert seen == [None, "http://127.0.0.1:1/#x"]
    command("serve")
    assert seen[2:] == [Path("mill.axiscal")]
    assert "Usage: axiscal" in command("-h").out
