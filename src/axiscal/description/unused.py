"""Artefacts that are described and that no set-up reads."""

from __future__ import annotations

from axiscal.description.campaign import CampaignDescription
from axiscal.document import Document, shown


def unused_artefacts(description: CampaignDescription) -> str | None:
    """Return a sentence about artefacts that no set-up names; None where all are read."""
    data = Document.parse(description.text, description.source).data
    read = {table.get("artefact") for table in data.get("setups", [])}
    left = [shown(table["name"]) for table in data.get("artefacts", []) if table["name"] not in read]
    if not left:
        return None
    names = " and ".join(left)
    return f"nothing reads {names}: write artefact = {left[0]} in a set-up, or take its table out."
