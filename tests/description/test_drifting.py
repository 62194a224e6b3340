"""How fast a zero may wander where a set-up is silent, says that it is warm, or says that nothing drifts."""

import json
from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import campaign_from_texts
from axiscal.measurement.setup import Setup
from axiscal.present.conditions import drift_words
from axiscal.record.events import Created
from axiscal.record.payload import decode
from axiscal.record.store import Record
from tests.generators.texts import machine_text

HOUR = 3600.0
MACHINE = machine_text("w-X'-b-Y-t", {"X": (0, 300), "Y": (0, 200)}, {"EXX": "20 um", "EAX": "20 urad"})
HEAD = 'machine = "machine.toml"\n[target]\nreadings = 5\n[[setups]]\nname = "it"\n'
USUAL, STATED = "with zeros that wander as is usual, {}", "with zeros that wander as stated, {}"
DENIED = "as if nothing drifted: you said that nothing drifts"
LASER = 'instrument = "interferometer"\ndirection = "x"\n'


def described(lines: str) -> Setup:
    return campaign_from_texts(HEAD + lines, "campaign.toml", MACHINE, "machine.toml").setups[0]


@pytest.mark.parametrize(
    ("lines", "per_hour", "said", "words"),
    [
        (LASER + 'moves = ["X"]', 5e-6, "usual", [USUAL.format("5 um/h")]),
        (LASER + 'moves = ["X"]\nwarm = true', 3e-6, "usual", [USUAL.format("3 um/h")]),
        (LASER + 'moves = ["X"]\ndrift = "2 um/h"\nwarm = true', 2e-6, "stated", [STATED.format("2 um/h")]),
        (LASER + 'moves = ["X"]\ndrift = "0"', 0.0, "denied", [DENIED]),
        (LASER + 'moves = ["X"]\ndrift = "0 um/h"', 0.0, "denied", [DENIED]),
        (LASER + 'moves = ["X"]\nunknowns = {}', 0.0, "nothing", []),
        (LASER + 'moves = ["X", "Y"]', 0.0, "nothing", []),
        ('instrument = "level"\ndirection = "x"\nmoves = ["X"]', 2e-6, "usual", [USUAL.format("2 urad/h")]),
        ('instrument = "indicator"\ndirection = "x"\nmoves = ["X"]', 10e-6, "usual", [USUAL.format("10 um/h")]),
        (
            'instrument = "indicator"\ndirection = "x"\nmoves = ["X"]\nwarm = true',
            3e-6,
            "usual",
            [USUAL.format("3 um/h")],
        ),
    ],
)
def test_a_zero_wanders_as_stated_else_as_is_usual_of_its_instrument_and_a_report_says_so(
    lines: str, per_hour: float, said: str, words: list[str]
) -> None:
    setup = described(lines)
    assert setup.drift * HOUR == pytest.approx(per_hour)
    assert (setup.drift_said, drift_words([setup])) == (said, words)


def test_a_record_of_before_keeps_a_zero_that_stands_still(tmp_path: Path) -> None:
    """An event of before has no word of usual drifts: the campaign opens without them."""
    texts = {"machine_text": MACHINE, "campaign_text": f'{HEAD}{LASER}moves = ["X"]\n'}
    created = decode("created", json.dumps({**texts, "machine_source": "m", "campaign_source": "c", "versions": {}}))
    assert isinstance(created, Created)
    Record.create(tmp_path / "old.axiscal", created).close()
    with Campaign.open(tmp_path / "old.axiscal") as campaign:
        assert campaign.description.setups[0].drift == 0.0
