"""Campaign files that are wrong: each ends in one failure that names file, line, value and remedy."""

import contextlib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.description.campaign import campaign_from_texts, read_campaign
from axiscal.exceptions import InputError
from tests.refusals.reading import refusals

TEXTS = refusals("campaign").texts
MACHINE, GOOD = TEXTS["machine.toml"], TEXTS["mill"]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "machine.toml").write_text(MACHINE)
    return tmp_path


def test_a_campaign_without_end_evaluates(folder: Path) -> None:
    ends = ("rms", "worst", "readings", "budget")
    text = "\n".join(line for line in GOOD.splitlines() if line.split(" ")[0] not in ends)
    (folder / "campaign.toml").write_text(text)
    assert read_campaign(folder / "campaign.toml", target_needed=False).target.empty


@given(st.data())
def test_a_garbled_campaign_is_read_or_refused(data: st.DataObject) -> None:
    start = data.draw(st.integers(0, len(GOOD)))
    end = data.draw(st.integers(start, min(len(GOOD), start + 30)))
    middle = data.draw(st.text(st.sampled_from('"[]{}=,.\n 0123456789eE+-umsxXnaif_#\\'), max_size=12))
    with contextlib.suppress(InputError):
        campaign_from_texts(GOOD[:start] + middle + GOOD[end:], "campaign.toml", MACHINE, "machine.toml")


def test_a_compensation_that_was_active_is_in_a_file_that_is_there(folder: Path) -> None:
    (folder / "old.comp").touch()
    (folder / "campaign.toml").write_text(f'compensation_active = ["X=old.comp"]\n{GOOD}')
    assert read_campaign(folder / "campaign.toml").setups
