"""From the volume and the plan to the document that the page draws in space."""

from __future__ import annotations

from axiscal.campaign.campaign import Campaign
from axiscal.guide.stopping import TableLeft, controls_of
from axiscal.guide.volume_scene import forecast, volume_scene
from axiscal.numerics import Array
from axiscal.units import to_unit
from axiscal.web.shapes import BallShape, MomentShape, OutlookShape, Point, TableShape


def outlook_shape(campaign: Campaign, version: int) -> OutlookShape:
    """Return the volume as it is known now, and what the plan will reach."""
    drawn = volume_scene(campaign)
    return OutlookShape(
        version=version,
        points=_points(drawn.points),
        error_um=_micrometres(drawn.error),
        std_um=_micrometres(drawn.std),
        box=_points(drawn.box),
        edges=list(drawn.edges),
        way=_points(drawn.way),
        taken=drawn.taken,
        balls=[BallShape(name=name, at=_points(at[None])[0]) for name, at in drawn.balls],
        forecast=[
            MomentShape(minutes=to_unit(seconds, "min"), rms_um=to_unit(rms, "um"))
            for seconds, rms in forecast(campaign)
        ],
        controls=list(controls_of(campaign)),
    )


def table_shape(left: TableLeft) -> TableShape:
    """Return what the table of a control would do."""
    before, expected = to_unit(left.before, "um"), to_unit(left.expected, "um")
    return TableShape(control=left.controller, before_um=before, expected_um=expected, refusal=left.refusal)


def _points(at: Array) -> list[Point]:
    rows = to_unit(at, "mm").round(2).tolist()
    return [(x, y, z) for x, y, z in rows]


def _micrometres(lengths: Array) -> list[float]:
    rounded: list[float] = to_unit(lengths, "um").round(3).tolist()
    return rounded
