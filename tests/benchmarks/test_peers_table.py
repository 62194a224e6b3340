"""The table says what was measured, and what could not be."""

from __future__ import annotations

import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.peers import runner
from benchmarks.peers.field import rival_of
from benchmarks.peers.judge import Judge, Outcomes, Verdict
from benchmarks.peers.problems import CASES, Posed
from benchmarks.peers.rivals import ours
from benchmarks.peers.runner import Bounds, Outcome
from benchmarks.peers.table import table

EXACT = ((5.8730,), (2.3144,), (8.7285,))
POOR = ((5.0,), (5.0,), (5.0,))


def _outcome(key: str, places: tuple[tuple[float, ...], ...], pick: float, letter: str = "a") -> Outcome:
    positions = [list(place) for place in places]
    return Outcome(key, letter, "joint", positions, [pick] * len(places), [pick] * len(places), 1e8, {"x": "1.0"})


def _known(*outcomes: Outcome) -> Outcomes:
    return {(outcome.key, outcome.letter, outcome.criterion): outcome for outcome in outcomes}


def _verdicts(*outcomes: Outcome) -> list[Verdict]:
    return list(Judge(_known(*outcomes), "joint", ours.picker).verdicts())


def _one(words: str, *outcomes: Outcome) -> Verdict:
    return next(verdict for verdict in _verdicts(*outcomes) if words in verdict.text)


@pytest.mark.parametrize(("theirs", "reached"), [(0.051, True), (0.049, False)])
def test_times_faster_than_trieste(theirs: float, reached: bool) -> None:
    verdict = _one("(a) a pick", _outcome("axiscal", EXACT, 0.001), _outcome("trieste", EXACT, theirs))
    assert verdict.reached is reached
    assert f"{theirs * 1e3:.0f} times" in verdict.text


@pytest.mark.parametrize("places", [EXACT, POOR])
def test_gain_at_their_states(places: tuple[tuple[float, ...], ...]) -> None:
    verdict = _one("every state that Emukit", _outcome("emukit", places, 0.1))
    assert verdict.reached is True


def test_a_pick_that_gains_less_is_not_reached() -> None:
    def lazy(posed: Posed) -> object:
        return lambda taken: np.full(posed.case.axes, 5.0)

    known = _known(_outcome("emukit", EXACT, 0.1))
    verdicts = Judge(known, "joint", lazy).verdicts()  # type: ignore[arg-type]
    assert next(v for v in verdicts if "Emukit" in v.text).reached is False


def test_j_of_the_plan_against_the_best_of_the_others() -> None:
    others = (_outcome("emukit", POOR, 0.1), _outcome("pyoptex", EXACT, 0.1))
    assert _one("(a) J of our plan", _outcome("axiscal-together", EXACT, 0.1), *others).reached is True
    worse = _one("(a) J of our plan", _outcome("axiscal-together", POOR, 0.1), *others)
    assert worse.reached is False
    assert "pyoptex" in worse.text


def test_time_of_the_plan() -> None:
    mine = replace(_outcome("axiscal-together", EXACT, 0.0), processor=[0.4])
    assert _one("(a) the whole plan", mine, _outcome("trieste", EXACT, 0.05)).reached is True
    assert _one("(a) the whole plan", mine, _outcome("trieste", EXACT, 0.03)).reached is False
    third = replace(mine, letter="c", processor=[31.0])
    assert _one("(c) the whole plan", third).reached is False


def test_pick_from_candidates() -> None:
    mine = _outcome("axiscal-candidates", EXACT, 0.001)
    assert _one("(a) a pick from", mine, _outcome("pyapprox", EXACT, 0.001)).reached is True
    other = _one("(a) a pick from", mine, _outcome("pyapprox", POOR, 0.0009))
    assert other.reached is False
    assert "another J" in other.text


def test_nothing_to_compare_is_no_verdict() -> None:
    assert {verdict.reached for verdict in _verdicts()} == {None}
    assert str(_verdicts()[0]).startswith("- not judged: ")


def test_missing_environment_is_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runner, "ENVIRONMENTS", tmp_path)
    outcome = runner.run(rival_of("trieste"), Posed(CASES[0], "joint"), Bounds())
    assert outcome.sorry == "not installed (no .venv-peers/trieste)"
    assert any("not installed (no .venv-peers/trieste)" in line for line in table(_known(outcome), "joint"))


def _endless(monkeypatch: pytest.MonkeyPatch, body: str) -> None:
    popen = subprocess.Popen

    def start(command: list[str], **keywords: object) -> object:
        return popen([command[0], "-c", body], **keywords)  # type: ignore[call-overload]

    monkeypatch.setattr(subprocess, "Popen", start)


@pytest.mark.long
@pytest.mark.parametrize("body", ["while True: pass", "import time; time.sleep(60)"])
def test_the_limit_of_time_ends_a_process(monkeypatch: pytest.MonkeyPatch, body: str) -> None:
    _endless(monkeypatch, body)
    assert runner.run(rival_of("numpy"), Posed(CASES[0], "joint"), Bounds(0.4)).sorry == "ended after 0 s"


def test_the_limit_of_memory_ends_a_process(monkeypatch: pytest.MonkeyPatch) -> None:
    _endless(monkeypatch, "import time; hoard = bytearray(10**8); time.sleep(60)")
    sorry = runner.run(rival_of("numpy"), Posed(CASES[0], "joint"), Bounds(60.0, 5e7)).sorry
    assert sorry == "ended beyond 0.05 GB"


@pytest.mark.long
def test_the_plain_baseline_runs_and_is_kept(tmp_path: Path) -> None:
    outcome = runner.run(rival_of("numpy"), Posed(CASES[0], "joint"), Bounds(120.0))
    assert not outcome.sorry
    assert len(outcome.positions) == 10
    assert len(outcome.processor) % 10 == 0
    assert len(outcome.processor) >= 20
    assert outcome.versions["numpy"] == np.__version__
    runner.keep(tmp_path / "new" / "outcomes", outcome)
    assert runner.kept(tmp_path / "new" / "outcomes") == {("numpy", "a", "joint"): outcome}
    assert runner.kept(tmp_path / "none") == {}
