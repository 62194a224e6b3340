"""The tables of the zoo and of widths: a row for each kind, from figures that were kept."""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks.trust.__main__ import tight
from benchmarks.trust.kept import Found, Solve, Trial
from benchmarks.trust.zoo import foreign_rows, width_rows, zoo_rows
from tests.zoo.curves import FOREIGN
from tests.zoo.every import EVERY

_OURS = {"half": 3.0, "far": 2.0, "inside": 0.96, "score": 6.0}
_THEIRS = {"half": 2.0, "far": 2.0, "inside": 0.95, "score": 4.0}


def _tried(_: Solve, trials: Sequence[Trial]) -> list[Found]:
    return [{"interval": _OURS, "kept": None, "named": False, "oracle": _THEIRS} for _ in trials]


def test_the_zoo_has_a_row_for_each_kind() -> None:
    rows = [row for row in zoo_rows(2, _tried) if row.startswith("|")]
    assert [row.split(" | ")[0][2:] for row in rows] == list(dict.fromkeys(each.kind for each in EVERY))
    assert "| pitch | 8 | – | 96% | 0% | 100% |" in rows


def test_widths_stand_beside_the_oracles() -> None:
    rows = list(width_rows(5, _tried))
    assert rows[4] == "| as read | planned | 5 | 96% | 95% | 1.50 | 1.50 | 1.5 |"


def test_a_foreign_truth_has_a_cell_for_each_kind_of_places() -> None:
    rows = list(foreign_rows(3, _tried))
    assert rows[0] == f"| {FOREIGN[0].kind} | " + " | ".join(4 * ["96%, 1.50, 6.0"]) + " |"


def test_rows_have_no_room_beside_their_bars() -> None:
    assert tight("| a | b |\nsaid | so") == "|a|b|\nsaid | so"
