"""Of the mistakes that readings name, the one that a person means, the event that puts it right, and all of it said."""

from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest

from axiscal.campaign.agreement_words import (
    acceptance,
    agreement_words,
    change_words,
    mistake_words,
    named,
    odds_text,
)
from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.promise.agreement import Agreement, Checks
from axiscal.estimation.promise.mistake import Explained
from axiscal.exceptions import RecordError
from axiscal.measurement.reading import Reading
from axiscal.record.accepted import Accepted
from tests.generators.laser_axis import CAMPAIGN, MACHINE

_SECOND = CAMPAIGN[CAMPAIGN.index("[[setups]]") :].replace('"laser"', '"other"')
DESCRIBED = campaign_from_texts(CAMPAIGN + _SECOND, "c.toml", MACHINE, "m")
READINGS = [Reading(("laser", "other")[i % 2], (0.1 * i,), (1,), 0.0, number=11 + i) for i in range(6)]
PATH = Path("mill.axiscal")


def known(
    *explained: Explained, p: float = 1e-6, described: Explained | None = None, left_out: Sequence[int] = ()
) -> Estimation:
    """Return an estimation whose readings name these mistakes."""
    found = SimpleNamespace(
        stated=SimpleNamespace(description=DESCRIBED),
        readings=READINGS,
        agreement=Agreement(6, 4, 30.0, p, explained, described),
        left_out=frozenset(left_out),
        checks=Checks(),
        name_of=lambda index: f"reading {READINGS[index].number}",
    )
    return cast("Estimation", found)


MEANT = [
    (
        Explained("stuck", 9.0, (0, 1), 3),
        Accepted("stuck", ("laser", "other"), 14),
        'values of "laser", "other" that repeat the one before, from reading 14 on, are left out',
        "from reading 14 on, values repeat what was shown before. If the instrument is stuck, read there again",
    ),
    (
        Explained("jump", 9.0, (1,), 3),
        Accepted("jump", ("other",), 14, name="other, before reading 14"),
        'the readings of "other" before reading 14 have a zero of their own',
        'the zero of "other" jumped before reading 14. Take readings before and after it again',
    ),
    (
        Explained("jump", 9.0, (1,), 3, backlash=True),
        Accepted("jump", ("other",), 14, name="other, before reading 14"),
        'the readings of "other" before reading 14 have a zero of their own',
        'the zero of "other" jumped before reading 14; or X has that backlash: accept backlash',
    ),
    (
        Explained("sign", 9.0, (0,), factor=-1.0),
        Accepted("sign", ("laser",), 0, -1.0),
        'the values of "laser" so far are multiplied by -1',
        'all values of "laser" have the wrong sign. Record them anew with the other sign',
    ),
    (
        Explained("unit", 9.0, (0,), 0, 0.001),
        Accepted("unit", ("laser",), 11, 1000.0),
        'the values of "laser" from reading 11 on are multiplied by 1000',
        "from reading 11 on, values are 0.001 times what they should be. Check the display's unit",
    ),
    (
        Explained("swapped", 9.0, (0, 1)),
        Accepted("swapped", ("laser", "other"), 0, 1.0),
        '"laser" and "other" exchange their values',
        'the values of "laser" and "other" are swapped',
    ),
    (
        Explained("shifted", 9.0, (0,), factor=1.0),
        Accepted("shifted", ("laser",), 0, 1.0),
        'the values of "laser" move to the reading behind; the first one is left out',
        'the values of "laser" belong to the place before or after. Check their order',
    ),
]


@pytest.mark.parametrize(("mistake", "event", "change", "words"), MEANT)
def test_a_mistake_has_its_event_and_its_words(mistake: Explained, event: Accepted, change: str, words: str) -> None:
    whole = known(mistake)
    assert acceptance(mistake, whole) == event
    assert change_words(event) == change
    assert mistake_words(mistake, whole) == words
    assert named(whole, mistake.mistake, None, PATH) == event
    assert named(whole, mistake.mistake, event.setups[-1], PATH) == event


@pytest.mark.parametrize(
    ("log_odds", "said"), [(3.5, "33 : 1"), (0.0, "1 : 1"), (-2.5, "1 : 12"), (20.0, "more than a million : 1")]
)
def test_odds_are_said_from_the_likelier_side(log_odds: float, said: str) -> None:
    assert odds_text(Explained("jump", log_odds, (1,), 3)) == said


SIGNS = [Explained("sign", 9.0, (setup,), factor=-1.0) for setup in (0, 1)]


def test_of_several_set_ups_one_has_to_be_said() -> None:
    whole = known(*SIGNS)
    assert named(whole, "sign", "other", PATH).setups == ("other",)
    with pytest.raises(RecordError, match=r'name "sign" of "laser", "other".*--setup NAME'):
        named(whole, "sign", None, PATH)
    twice = known(SIGNS[0], SIGNS[0]._replace(log_odds=7.0))
    assert named(twice, "sign", None, PATH).setups == ("laser",)
    with pytest.raises(RecordError, match='"jump" at more than 20 : 1; they name sign of "laser", sign of "other"'):
        named(whole, "jump", None, PATH)
    with pytest.raises(RecordError, match='"jump" of "other" at more than 20 : 1'):
        named(whole, "jump", "other", PATH)
    with pytest.raises(RecordError, match="they name no mistake"):
        named(known(), "jump", None, PATH)


def test_what_is_said_of_all_readings_together() -> None:
    assert agreement_words(known(p=0.4)) == "4 of 6 readings agree with the others"
    unused = '4 of 6 readings agree; not used: 11 ("laser")'
    assert agreement_words(known(p=0.4, left_out=[0])) == unused
    several = f'{unused}, 12 ("other"), 13 ("laser") and 2 more'
    assert agreement_words(known(p=0.4, left_out=range(5))) == several
    none = agreement_words(known())
    assert none == (
        "The readings contradict each other (p = 1e-06), and no single mistake explains it: "
        "4 of 6 readings agree with the others"
    )
    both = agreement_words(known(*SIGNS))
    assert both.startswith('The readings contradict each other (p = 1e-06): all values of "laser" have the wrong sign')
    assert '; or all values of "other" have the wrong sign' in both
    assert agreement_words(known(*SIGNS), PATH) == f"{both}. If so: axiscal step accept {PATH} sign"
    place = known(described=Explained("place", 9.0, (1,), 1))
    assert '"other" does not stand where the campaign says' in agreement_words(place)
    assert agreement_words(known(described=Explained("direction", 9.0, (), axes=("B", "C")))) == (
        "The readings contradict each other (p = 1e-06): correct direction of B, C in the machine's file"
    )
