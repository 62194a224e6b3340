"""`examples/many_campaigns.py` goes on behind the last whole row."""

from __future__ import annotations

from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

import pytest

from examples import many_campaigns

CAMPAIGN = """machine = "one-axis"
[target]
readings = 3
[[setups]]
name = "dial"
instrument = "indicator"
direction = "x"
moves = ["X"]
"""
WORDS = ["dial.toml", "again.toml", "--machines", "3"]


class OneByOne(Executor):
    """Does each task where it is given."""

    def submit(self, task: Any, /, *given: Any, **named: Any) -> Future[Any]:
        """Return what a task comes to."""
        done = Future[Any]()
        done.set_result(task(*given, **named))
        return done


def test_it_goes_on_behind_the_last_whole_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    measured = list[int]()

    def outcome(_campaign: object, _places: object, machine: int) -> dict[str, object]:
        measured.append(machine)
        return {"readings": 3, "minutes": 7.5 + machine, "U_um": 1 / (machine + 3)}

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(many_campaigns, "ProcessPoolExecutor", OneByOne)
    monkeypatch.setattr(many_campaigns, "planned", lambda _: ())
    monkeypatch.setattr(many_campaigns, "outcome", outcome)
    for name, noise in (("dial.toml", "1 um"), ("again.toml", "2 um")):
        Path(name).write_text(f'{CAMPAIGN}noise = "{noise}"\n', encoding="utf-8")
    many_campaigns.main(WORDS)
    table = Path("cases.csv").read_bytes()
    assert measured == [0, 1, 2, 0, 1, 2]
    for end in range(0, len(table) + 1, 13):
        measured.clear()
        Path("cases.csv").write_bytes(table[:end])
        many_campaigns.main(WORDS)
        assert Path("cases.csv").read_bytes() == table
        assert len(measured) == 6 - max(table[:end].count(b"\n") - 1, 0)
    Path("again.toml").write_text(f'{CAMPAIGN}noise = "3 um"\n', encoding="utf-8")  # another campaign of that name
    measured.clear()
    many_campaigns.main(WORDS)
    assert measured == [0, 1, 2]
    Path("cases.csv").write_text("a,b\n1,2\n", encoding="utf-8")
    with pytest.raises(SystemExit, match="another table"):
        many_campaigns.main(WORDS)
