"""What `--out DIR` receives."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from axiscal.cli.printing import say, say_document

if TYPE_CHECKING:
    from axiscal.campaign.campaign import Campaign, Milestone

RECORD = "campaign.axiscal"


def write_outputs(campaign: Campaign, out: Path, *, as_json: bool) -> None:
    """Write the results of a finished campaign to a folder and print them; raises OSError."""
    result = result_document(campaign)
    (out / "result.json").write_text(json.dumps(result, indent=2, ensure_ascii=False, allow_nan=False) + "\n", "utf-8")
    if as_json:
        say_document(result)
        return
    say(
        f"{result['stopped_because']}: {result['readings']} readings, {result['minutes']:.1f} minutes, "
        f"RMS {result['rms_um']:.3g} um, worst {result['worst_um']:.3g} um.\nResults are in {out}."
    )


def result_document(campaign: Campaign) -> dict[str, object]:
    """Return the document `axiscal-result/1` as far as the campaign itself knows it."""
    from axiscal.campaign.versions import versions

    history = [_row(campaign, milestone) for milestone in campaign.history()]
    last = history[-1]
    return {
        "schema": "axiscal-result/1",
        "machine": campaign.description.machine.name,
        "readings": last["reading"],
        "minutes": last["minutes"],
        "stopped_because": campaign.state.finished,
        "rms_um": last["rms_um"],
        "worst_um": last["worst_um"],
        "history": history,
        "versions": versions(),
    }


def _row(campaign: Campaign, milestone: Milestone) -> dict[str, object]:
    from axiscal.cli.wording import position_document
    from axiscal.units import to_unit

    reading = milestone.reading
    axes = campaign.description.machine.axes
    return {
        "reading": milestone.number,
        "setup": None if reading is None else reading.setup,
        "position": None if reading is None else position_document(axes, reading.pose),
        "rms_um": to_unit(milestone.accuracy.rms, "um"),
        "worst_um": to_unit(milestone.accuracy.worst, "um"),
        "minutes": to_unit(milestone.seconds, "min"),
    }
