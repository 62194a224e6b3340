"""How well the machine was known after each reading, kept from one question to the next."""

from __future__ import annotations

from axiscal.campaign.campaign import Campaign
from axiscal.measurement.reading import Reading
from axiscal.units import to_unit
from axiscal.web.shapes import MomentShape


class KnownSoFar:
    """The course of one campaign: it grows with it, and is cut where readings are taken back."""

    def __init__(self, campaign: Campaign) -> None:
        self._campaign = campaign
        self._readings: tuple[Reading, ...] = ()
        self._moments: list[MomentShape] = []

    def moments(self) -> list[MomentShape]:
        """Return the course as far as it is known without computing: from the beginning, in the order of readings."""
        readings = self._campaign.state.readings
        same = _alike(readings, self._readings)
        self._moments, self._readings = self._moments[: same + 1], readings[:same]
        if len(readings) == same + 1 and self._moments:
            self._moments.append(_moment(self._campaign.seconds(), self._campaign.known().accuracy.rms))
            self._readings = readings
        return list(self._moments)

    def completed(self) -> bool:
        """Compute what is missing, and return whether that was anything."""
        if self._moments and self._readings == self._campaign.state.readings:
            return False
        self._readings = self._campaign.state.readings
        self._moments = [_moment(each.seconds, each.accuracy.rms) for each in self._campaign.history()]
        return True


def _alike(ones: tuple[Reading, ...], others: tuple[Reading, ...]) -> int:
    """Return how many readings at the beginning are the same."""
    pairs = enumerate(zip(ones, others, strict=False))
    return next((n for n, (one, other) in pairs if one != other), min(len(ones), len(others)))


def _moment(seconds: float, rms: float) -> MomentShape:
    return MomentShape(minutes=to_unit(seconds, "min"), rms_um=to_unit(rms, "um"))
