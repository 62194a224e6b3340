"""An axis with one curve, for tests of what readings say."""

from collections.abc import Iterable

from axiscal.description.campaign import campaign_from_texts
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from tests.generators.texts import machine_text

MACHINE = machine_text("w-b-X-t", {"X": (0, 1000)}, {"EXX": 'std = "10 um", length = "200 mm"'})


def observed(setup: str) -> Observation:
    """Return what an indicator along X with these further keys sees."""
    start = (
        'machine = "m"\n[target]\nreadings = 1\n[[setups]]\nname = "it"\ninstrument = "indicator"\ndirection = "x"\n'
    )
    described = campaign_from_texts(f"{start}{setup}\n", "campaign.toml", MACHINE, "m")
    return Observation(described.machine, described.setups)


def readings_at(places: Iterable[float], value: float) -> list[Reading]:
    """Return readings of one value at places, m."""
    return [Reading("it", (place,), (1,), value) for place in places]
