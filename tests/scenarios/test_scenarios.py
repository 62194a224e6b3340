"""What people rely on, in quick campaigns: how commands end, what documents hold, and that a target is reached."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from tests.scenarios.playing import Outcome, played
from tests.scenarios.scenario import names, scenario

SOURCES = Path(__file__).resolve().parents[2] / "src"
QUICK = ("iso_test", "level", "outlier", "rtest")
RESULT = {
    *("schema", "readings", "minutes", "stopped_because", "rms_um", "worst_um", "history", "errors", "constants"),
    *("observability", "rejected", "warnings", "versions"),
}

Played = Callable[[str], Outcome]


@pytest.fixture(scope="module")
def outcome() -> Played:
    """Play a campaign with the sources of this checkout; the same one once only."""
    return cache(lambda name: played(scenario(name), str(SOURCES)))


def _document(outcome: Outcome, file: str) -> Any:
    return json.loads(outcome.files[file])


def _answered(outcome: Outcome, command: str) -> Any:
    """Return the document that a command printed."""
    return next(json.loads(said.out) for said in outcome.said if said.command.words[0] == command)


def test_every_campaign_is_written_as_commands() -> None:
    assert set(QUICK) < set(names())
    assert all(command.words for name in names() for command in scenario(name).commands)


@pytest.mark.parametrize("name", QUICK)
def test_commands_end_as_the_campaign_says_and_never_with_a_traceback(name: str, outcome: Played) -> None:
    for said in outcome(name).said:
        assert said.as_expected, said
        assert said.status in (0, 1, 2)
        assert "Traceback" not in said.err


@pytest.mark.parametrize("name", QUICK)
def test_what_is_refused_is_one_paragraph_and_nothing_on_stdout(name: str, outcome: Played) -> None:
    for said in outcome(name).said:
        if said.status == 1:
            assert said.out == ""
            assert said.err.splitlines()[-1].strip()
            assert "axiscal: " in said.err
            assert "\n\n" not in said.err.strip()


@pytest.mark.parametrize(
    ("name", "file"), [("rtest", "out"), ("level", "survey"), ("iso_test", "out"), ("outlier", "out")]
)
def test_a_result_holds_what_outsiders_read(name: str, file: str, outcome: Played) -> None:
    found = _document(outcome(name), f"{file}/result.json")
    assert found["schema"] == "axiscal-result/1"
    assert set(found) >= RESULT
    history = found["history"]
    assert [row["reading"] for row in history] == list(range(found["readings"] + 1))
    assert history[0]["position"] is None
    assert history[-1]["rms_um"] < history[0]["rms_um"]
    for curve in found["errors"].values():
        assert len(curve["position"]) == len(curve["mean"]) == len(curve["std"]) > 0
        assert min(curve["std"]) > 0


def test_a_campaign_stops_when_its_target_is_reached_and_not_before(outcome: Played) -> None:
    found = _document(outcome("rtest"), "out/result.json")
    assert found["stopped_because"] == "rms target reached"
    reached = [row["rms_um"] <= 9.0 for row in found["history"]]
    assert reached == [False] * found["readings"] + [True]


def test_a_plan_becomes_sharper_with_every_reading_and_stays_above_its_bound(outcome: Played) -> None:
    plan = _answered(outcome("rtest"), "plan")
    assert plan["schema"] == "axiscal-plan/1"
    assert all({"setup", "position", "direction", "approach", "rms_um", "minutes"} <= set(p) for p in plan["points"])
    assert all(b["rms_um"] < a["rms_um"] and b["minutes"] > a["minutes"] for a, b in pairwise(plan["points"]))
    assert plan["bound_rms_um"] <= plan["rms_um"] == plan["points"][-1]["rms_um"]


def test_a_test_of_iso_230_2_has_its_figures(outcome: Played) -> None:
    said = _answered(outcome("iso_test"), "iso230")
    assert (said["schema"], said["unit"]) == ("axiscal-iso230/1", "um")
    assert all(said[name] > 0 for name in ("A", "A_up", "A_down", "E", "R", "M"))
    assert max(said["A_up"], said["A_down"], said["E"]) <= said["A"]
    assert len(said["per_target"]) == 9


def test_the_reading_that_is_50_um_off_is_the_one_that_is_not_believed(outcome: Played) -> None:
    found = _document(outcome("outlier"), "out/result.json")
    assert [each["reading"] for each in found["rejected"]] == [12]
    assert any(each["code"] == "outlier" for each in found["warnings"])


def test_a_campaign_leaves_record_result_report_and_tables(outcome: Played) -> None:
    files = set(outcome("rtest").files)
    assert {f"out/{name}" for name in ("campaign.axiscal.json", "result.json", "report.html")} < files
    assert {"out/tables/linuxcnc/README.txt", "out/tables/linuxcnc/X.comp", "out/tables/csv/README.txt"} < files


def test_what_a_survey_with_a_level_cannot_see_is_said(outcome: Played) -> None:
    said = " ".join(_document(outcome("level"), "survey/result.json")["observability"])
    assert "EZX" in said
