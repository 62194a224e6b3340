"""The steps of a campaign over HTTP, looked at from outside: what is kept is what is on the disk."""

import io
import re
import zipfile
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import pytest

from axiscal.campaign.campaign import Campaign
from tests.web.served import Answer, Served, kept, served, started


@pytest.fixture
def page(tmp_path: Path) -> Iterator[Served]:
    """A campaign of four readings that is served."""
    with served(started(tmp_path)) as running:
        yield running


@pytest.fixture(scope="module")
def still(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """One that is served for all tests that change nothing."""
    with served(started(tmp_path_factory.mktemp("still"))) as running:
        yield running


def test_a_whole_campaign_over_the_api(page: Served) -> None:
    state = page.state()
    assert state["question"]["sign"] == "+ where the tool stands too far towards +x, seen from the workpiece"
    assert (state["question"]["mount"], state["progress"]["taken"], state["progress"]["coming"]) == (True, 0, 4)
    for text in ("-1,7", "0.0005 mm", "0.4", "1.1"):
        done = page.call("readings", after=page.state()["last"], text=text)
        assert done.status == 200, done.document
    assert kept(page.record) == [-1.7, 0.5, 0.4, 1.1]
    state = page.state()
    assert (state["question"], state["ended"]) == (None, "4 readings taken")
    assert [each["values"] for each in state["readings"]] == [[1.1], [0.4], [0.5]]
    assert page.call("finish", after=state["last"]).status == 200
    assert (page.record.parent / "mill-results" / "report.pdf").is_file()
    known = page.state()["answer"]
    assert known["first"][0] == "MEASURED"
    assert re.fullmatch(r"4 readings, \d+ min", known["first"][1])  # of the clock
    assert [step["code"] for step in known["document"]["steps"]] == []  # four readings tell no table to check
    paper = page.ask("GET", "/report.pdf", Authorization=f"Bearer {page.token}")
    assert (paper.status, paper.body[:5], paper.headers["content-disposition"]) == (200, b"%PDF-", "attachment")
    assert page.call("undo", after=page.state()["last"]).document["sentence"].startswith("Took back the end")


def test_the_tables_of_a_control_are_one_file_and_made_anew_once_its_sign_is_measured(page: Served) -> None:
    def tables(control: str) -> Answer:
        return page.ask("GET", f"/tables.zip?control={control}", Authorization=f"Bearer {page.token}")

    assert tables("linuxcnc").status == 422
    assert page.call("finish", after=page.state()["last"]).status == 200
    made = page.record.parent / "mill-results" / "tables" / "linuxcnc"
    made.mkdir(parents=True)
    (made / "X.comp").write_text("0 0 0\n")
    page.call("notes", text="the tables are there")
    assert page.state()["tables"] == ["linuxcnc"]
    with zipfile.ZipFile(io.BytesIO(tables("linuxcnc").body)) as archive:
        assert archive.read("linuxcnc/X.comp") == b"0 0 0\n"
    for other in ("..", "linuxcnc/..", "%2e%2e", ""):
        assert tables(other).status == 422
    with Campaign.open(page.record) as campaign:
        campaign.bump("linuxcnc", 1e-5)
    assert tables("linuxcnc").status == 422  # no readings, no tables anew


def test_what_is_typed_is_understood_before_it_is_sent(still: Served) -> None:
    meant = still.call("typed?text=0%2C0021%20mm").document
    assert (meant["values"], meant["surprising"], meant["sentence"]) == ([pytest.approx(2.1)], False, "")
    assert still.call("typed?text=99%20mm").document["surprising"]
    assert "Type the number that" in still.call("typed?text=twelve").document["sentence"]


@pytest.mark.long
def test_a_note_answers_nothing_so_who_has_seen_the_state_before_may_still_answer(page: Served) -> None:
    before = page.state()
    assert (before["due"]["ask"], before["due"]["temperature_degc"]) == (True, None)
    assert page.call("notes", text="the workshop has 23,4 °C").status == 200
    assert page.state()["due"] == before["due"]
    assert page.call("notes", text="21,4 °C").status == 200
    state = page.state()
    assert [note["text"] for note in state["notes"]] == ["the workshop has 23,4 °C", "21,4 °C"]
    assert (state["due"]["ask"], state["due"]["temperature_degc"]) == (False, 21.4)
    assert page.call("notes", text=" ").document["problem"] == "refused"
    assert page.call("readings", after=before["last"], text="1.5").status == 200
    assert page.call("readings", after=state["last"], text="1.5").document["problem"] == "overtaken"
    assert kept(page.record) == [1.5]


def test_the_set_up_that_is_asked_for_is_drawn_as_wide_as_the_page_wants(still: Served) -> None:
    answer = still.ask("GET", "/setup.svg?width=640", None, Authorization=f"Bearer {still.token}")
    assert answer.status == 200
    drawing = ElementTree.fromstring(answer.body)
    assert drawing.get("width") == "640"
    words = [each.text for each in drawing.iter("{http://www.w3.org/2000/svg}text")]
    assert "interferometer" in words
    refused = still.ask("GET", "/setup.svg?width=20000", None, Authorization=f"Bearer {still.token}")
    assert (refused.status, refused.document["problem"]) == (422, "malformed")


NAMES = (
    "start stage rows curve plan draft open leave state typed cost readings jogs skips notes zeros "
    "accepts undo next finish check"
)
"""Of all paths."""


def test_the_description_names_every_document(still: Served) -> None:
    described = still.call("openapi.json").document
    assert set(described["paths"]) == {f"/api/1/{name}" for name in NAMES.split()}
    assert set(still.state()) == set(described["components"]["schemas"]["StateShape"]["required"]) | {"document"}


def test_a_record_that_went_away_is_said(page: Served) -> None:
    state = page.state()
    page.record.rename(page.record.with_name("gone.axiscal"))
    refused = page.call("readings", after=state["last"], text="1")
    assert refused.status in (409, 422)
    assert "mill.axiscal" in refused.document["sentence"]
    page.record.with_name("gone.axiscal").rename(page.record)
