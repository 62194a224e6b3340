"""The campaign as it is started by hand: every part runs, says how many cases it ran, and fails when it must."""

from __future__ import annotations

import pytest

from tests.certify import __main__ as campaign

SMALL = {"one-joint": 3, "machines": 1, "models": 2, "regressions": 4}


def started(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    """Return the status of the campaign started with these arguments."""
    monkeypatch.setattr("sys.argv", ["certify", *arguments])
    monkeypatch.setattr(campaign, "LATTICE", 1000)
    return campaign.main()


@pytest.mark.parametrize("part", SMALL)
def test_every_part_says_how_many_cases_it_ran(
    part: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert started(monkeypatch, "--part", part, "--cases", str(SMALL[part])) == 0
    said = capsys.readouterr().out
    assert said.startswith(f"{part}: {SMALL[part]} ")
    assert "holds" in said
    assert "none beyond the limit" in said


def test_a_finding_beyond_its_limit_is_a_failure(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(campaign, "LIMIT", -1.0)
    assert started(monkeypatch, "--part", "one-joint", "--cases", "2") == 1
    said = capsys.readouterr().out
    assert "FAILS" in said
    assert "2 beyond the limit" in said
