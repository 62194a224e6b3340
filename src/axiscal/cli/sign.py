"""`axiscal data sign`."""

from __future__ import annotations

from axiscal.cli.arguments import Json, OwnRecord
from axiscal.cli.opened import opened_to_write
from axiscal.cli.printing import say_either
from axiscal.cli.texts import signed_text
from axiscal.record.signing import key_file, make_key


def sign(record: OwnRecord, json: Json = False) -> None:
    """Sign a record with your key.

    Your key is made the first time; keep its file to yourself. From then on your records are signed when they end, when
    a prompt is paused, and before the first entry of another day.

    \b
    Example:
      axiscal data sign mill.axiscal
    """
    make_key()
    with opened_to_write(record) as campaign:
        campaign.sign()
        found = campaign.signed()
        assert found is not None
        document = {"record": str(record), "event": found.number, **found.by._asdict(), "holds": found.holds}
        words = f"{record}: {signed_text(campaign)}. Public key: {found.by.key}. Keep {key_file()} to yourself."
        say_either(json, "axiscal-signature/1", document, [words])
