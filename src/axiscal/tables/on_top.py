"""New files beside what a control held while the machine was measured: on top of it, instead of it, or nobody knows."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.language.spoken import later, said
from axiscal.tables.effect import added_by
from axiscal.tables.export_options import ExportOptions
from axiscal.tables.loaded import Loaded
from axiscal.tables.offer import Draft
from axiscal.tables.old_files import read_old

_KINDS = "a table, backlash, pitch or sag compensation, a bed mesh or skew correction"
_BEGINNING = later(
    "Is a compensation active on the control while it is measured (a table, backlash, pitch or sag compensation, a bed "
    "mesh or skew correction)? Switch it off, or say so: compensation_active = false, = true or its files in "
    "campaign.toml. New tables go on top of what was active; until it is said they are written as if nothing was, and "
    "ask."
)
REPORTS = ("csv",)
"""What is read by people or other programs, not loaded in place of something."""
_QUESTION = (
    f"WAS A COMPENSATION ACTIVE WHILE MEASURING ({_KINDS})? campaign.toml does not say. If one was, these files loaded "
    "in its place bring back all that it took away: export again with --on-top-of OLD, the files that were active. If "
    "none was, write compensation_active = false into campaign.toml, and this question is gone."
)


def informed(options: ExportOptions, description: CampaignDescription, controller: str) -> ExportOptions:
    """Return options that know what the campaign says of a compensation that was active; raises ReadingError.

    Files that campaign.toml names lie beside it; others go before them. What is only read is not put on top of them.
    """
    said = description.compensation_active
    if said is None or isinstance(said, bool):
        return replace(options, active=said)
    if options.old_files or controller in REPORTS:
        return replace(options, active=True)
    return replace(options, active=True, old_files=read_old(said, Path(description.source).parent))


def unasked(description: CampaignDescription) -> str:
    """Return the question for whoever begins, "" where campaign.toml answers it."""
    return "" if description.compensation_active is not None else said(_BEGINNING)


def on_top(estimate: Estimate, draft: Draft, old: Loaded, options: ExportOptions) -> Draft:
    """Return a draft of old and new together, whose effect counts from what was active; raises TableError."""
    if options.active is False:
        what = "campaign.toml says that no compensation was active while measuring (compensation_active = false)"
        raise TableError(what, "leave --on-top-of out, or correct campaign.toml")
    held = old.control((draft.about or estimate).machine)
    names = ", ".join(dict.fromkeys(file.name for file in options.old_files))
    note = (
        f"These files hold what was active while measuring ({names}) and on top of it what was found: load them in its "
        "place, not beside it. The figures above count from the machine as it was measured, with the old compensation."
    )
    control, wanted = (added_by(whole, held) for whole in (draft.control, draft.wanted))
    return replace(draft, control=control, wanted=wanted, notes=(note, *draft.notes))


def asked_about(controller: str, draft: Draft, options: ExportOptions) -> Draft:
    """Return a draft with the question whether something was active, where nobody said.

    Raises TableError where something was and files would take its place.
    """
    if options.active and controller not in REPORTS:
        what = "a compensation was active while measuring (compensation_active), and these files would take its place"
        raise TableError(what, "give the files that were active: axiscal export ... --on-top-of OLD")
    if options.active:
        note = "The deviations are those that were left by the compensation that was active while measuring."
        return replace(draft, notes=(note, *draft.notes))
    return draft if options.active is False else replace(draft, notes=(_QUESTION, *draft.notes))
