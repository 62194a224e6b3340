"""The table says what was measured, and what could not be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.numerics import Array
from benchmarks.peers import runner
from benchmarks.peers.field import rival_of
from benchmarks.peers.judge import Judge, Outcomes, Picker, Verdict
from benchmarks.peers.problems import CASES, Posed
from benchmarks.peers.rivals import ours
from benchmarks.peers.runner import Bounds, Outcome
from benchmarks.peers.table import table

Places = tuple[tuple[float, ...], ...]
EXACT = ((5.8730,), (2.3144,), (8.7285,))
POOR = ((5.0,), (5.0,), (5.0,))


def _outcome(key: str, places: Places, pick: float, letter: str = "a") -> Outcome:
    positions = [list(place) for place in places]
    return Outcome(key, letter, "joint", positions, [pick] * len(places), [pick] * len(places), 1e8, {"x": "1.0"})


def _known(*outcomes: Outcome) -> Outcomes:
    return {(outcome.key, outcome.letter, outcome.criterion): outcome for outcome in outcomes}


def _one(words: str, *outcomes: Outcome, picker: Picker = ours.picker) -> Verdict:
    return next(each for each in Judge(_known(*outcomes), "joint", picker).verdicts() if words in each.text)


def _planned(places: Places, seconds: float, letter: str = "a") -> Outcome:
    return replace(_outcome("axiscal-together", places, 0.1, letter), processor=[seconds])


OURS, LISTED = _outcome("axiscal", EXACT, 0.001), _outcome("axiscal-candidates", EXACT, 0.001)
OTHERS = _outcome("emukit", POOR, 0.1), _outcome("pyoptex", EXACT, 0.1)


@pytest.mark.parametrize(
    ("words", "outcomes", "reached", "says"),
    [
        ("(a) a pick", [OURS, _outcome("trieste", EXACT, 0.051)], True, "51 times"),
        ("(a) a pick", [OURS, _outcome("trieste", EXACT, 0.049)], False, "49 times"),
        ("every state that Emukit", [_outcome("emukit", EXACT, 0.1)], True, ""),
        ("every state that Emukit", [_outcome("emukit", POOR, 0.1)], True, ""),
        ("(a) J of our plan", [_planned(EXACT, 0.1), *OTHERS], True, ""),
        ("(a) J of our plan", [_planned(POOR, 0.1), *OTHERS], False, "pyoptex"),
        ("(a) the whole plan", [_planned(EXACT, 0.4), _outcome("trieste", EXACT, 0.05)], True, ""),
        ("(a) the whole plan", [_planned(EXACT, 0.4), _outcome("trieste", EXACT, 0.03)], False, ""),
        ("(c) the whole plan", [_planned(EXACT, 31.0, "c")], False, ""),
        ("(a) a pick from", [LISTED, _outcome("pyapprox", EXACT, 0.001)], True, ""),
        ("(a) a pick from", [LISTED, _outcome("pyapprox", POOR, 0.0009)], False, "another J"),
    ],
)
def test_a_verdict_is_that_of_what_was_measured(
    words: str, outcomes: Sequence[Outcome], reached: bool, says: str
) -> None:
    verdict = _one(words, *outcomes)
    assert verdict.reached is reached
    assert says in verdict.text


def test_a_pick_that_gains_less_is_not_reached() -> None:
    def lazy(posed: Posed) -> Callable[[Array], Array]:
        return lambda taken: np.full(posed.case.axes, 5.0)

    assert _one("Emukit", _outcome("emukit", EXACT, 0.1), picker=lazy).reached is False


def test_nothing_to_compare_is_no_verdict() -> None:
    verdicts = list(Judge({}, "joint", ours.picker).verdicts())
    assert {verdict.reached for verdict in verdicts} == {None}
    assert str(verdicts[0]).startswith("- not judged: ")


def test_missing_environment_is_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runner, "ENVIRONMENTS", tmp_path)
    outcome = runner.run(rival_of("trieste"), Posed(CASES[0], "joint"), Bounds())
    assert outcome.sorry == "not installed (no .venv-peers/trieste)"
    assert any("not installed (no .venv-peers/trieste)" in line for line in table(_known(outcome), "joint"))
