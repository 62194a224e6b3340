"""Campaigns give what they gave: one of them in the quick tests, all of them in the long ones."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def _compared(*words: str) -> subprocess.CompletedProcess[str]:
    """Return how the comparison ended, with the sources of this checkout."""
    path = {"PYTHONPATH": str(ROOT / "src")}
    command = [sys.executable, "-m", "tests.golden", *words]
    return subprocess.run(command, cwd=ROOT, env=os.environ | path, capture_output=True, text=True, check=False)


def test_a_small_campaign_gives_what_it_gave() -> None:
    found = _compared("--only", "programs")
    assert found.returncode == 0, found.stdout + found.stderr


@pytest.mark.long
def test_all_campaigns_give_what_they_gave() -> None:
    found = _compared()
    assert found.returncode == 0, found.stdout + found.stderr
