"""`axiscal finish`."""

from __future__ import annotations

from axiscal.cli.options import Json, Out, RecordFile
from axiscal.cli.printing import tell


def finish(record: RecordFile, out: Out, json: Json = False) -> None:
    """End a campaign and write its results.

    A campaign that is finished already is written again; `axiscal undo` takes the end back.

    \b
    Example:
      axiscal finish mill.axiscal --out results
    """
    from axiscal.campaign.campaign import Campaign
    from axiscal.cli.outputs import RECORD, write_outputs

    with Campaign.open(record) as campaign:
        out.mkdir(parents=True, exist_ok=True)
        campaign.finish()
        copy = out / RECORD
        if copy.exists() and not copy.samefile(record):
            tell(f"{copy} is there already and stays as it is.")
        elif not copy.exists():
            campaign.copy(copy)
        write_outputs(campaign, out, as_json=json)
