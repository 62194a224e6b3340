"""`axiscal finish`."""

from __future__ import annotations

from axiscal.campaign.campaign import Campaign
from axiscal.cli.arguments import Json, Out, OwnRecord
from axiscal.cli.outputs import RECORD, write_outputs


def finish(record: OwnRecord, out: Out, json: Json = False) -> None:
    """End a campaign and write its results.

    A campaign that is finished already is written again, into the same folder if you like; `axiscal undo` takes the end
    back.

    \b
    Example:
      axiscal finish mill.axiscal --out results
    """

    with Campaign.open(record) as campaign:
        out.mkdir(parents=True, exist_ok=True)
        campaign.refuse_other(out / RECORD)
        campaign.finish()
        campaign.copy(out / RECORD)
        write_outputs(campaign, out, as_json=json)
