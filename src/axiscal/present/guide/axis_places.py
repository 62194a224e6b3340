"""The position of each axis for a reading, and the side from which it comes there."""

from __future__ import annotations

from dataclasses import dataclass

from axiscal.campaign.campaign import Campaign
from axiscal.measurement.place_texts import shown_coordinate
from axiscal.record.events import Asked

_DIGITS = 4
"""Behind the point: one more than controls show; a reading there differs by less than its noise."""


@dataclass(frozen=True, slots=True)
class AxisPlace:
    """axis : its name; value : in its unit, mm or deg; moves : whether the set-up moves it

    changed : whether it stood elsewhere at the reading before, or there was none
    side : "+" where it comes from below, "-" from above, "" where that does not matter
    """

    axis: str
    value: float
    unit: str
    moves: bool
    changed: bool
    side: str

    @property
    def shown(self) -> str:
        """The coordinate to a tenth of a micrometre, or of a thousandth of a degree, without zeros behind."""
        return f"{round(self.value, _DIGITS) + 0.0:.{_DIGITS}f}".rstrip("0").rstrip(".")


def axis_places(campaign: Campaign, asked: Asked) -> tuple[AxisPlace, ...]:
    """Return where the axes are to stand, linear axes first, by their letters, as a control shows them."""
    setup, readings = campaign.description.setup(asked.place.setup), campaign.state.readings
    before = readings[-1].pose if readings else None
    found = (
        AxisPlace(
            axis=axis.name,
            value=shown_coordinate(asked.place.pose[k], axis),
            unit=axis.unit,
            moves=k in setup.moves,
            changed=before is None or before[k] != asked.place.pose[k],
            side={1: "+", -1: "-"}.get(asked.place.approach[k], ""),
        )
        for k, axis in enumerate(campaign.description.machine.axes)
    )
    return tuple(sorted(found, key=lambda place: (place.unit != "mm", place.axis)))
