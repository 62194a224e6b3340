"""`axiscal shop type learn / explain`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from axiscal.cli.arguments import Json
from axiscal.cli.printing import say_either
from axiscal.description.campaign import read_campaign
from axiscal.description.type_text import TypePrior, type_prior
from axiscal.document.durable import write_whole
from axiscal.errors.model import ErrorModel
from axiscal.exceptions import RecordError
from axiscal.language.spoken import decimals, later, listed, said
from axiscal.machine import load_machine
from axiscal.planning.plan.plan import Plan
from axiscal.ports.fleet.type_learning import DIRECTIONS, DOUBT, learnt_type, saving
from axiscal.ports.fleet.type_words import summary_sentences
from axiscal.record.copies import carried_text, gathered
from axiscal.units import format_quantity, to_unit

app = typer.Typer(no_args_is_help=True, rich_markup_mode=None, add_completion=False)


@app.callback()
def type() -> None:
    """Learn from machines of one type what the next is like."""


@app.command("learn")
def learn(
    records: Annotated[
        list[Path],
        typer.Argument(metavar="RECORD|FOLDER...", help="Records of machines, folders that hold them, store: for all."),
    ],
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE.type.json", help="Keep what was learnt.")] = None,
    machine: Annotated[
        str | None, typer.Option(metavar="FILE|NAME", help="Learn over these errors; default: those most records have.")
    ] = None,
    named: Annotated[
        str | None, typer.Option("--of", metavar="NAME", help="Of machines that machine.toml calls so alone.")
    ] = None,
    directions: Annotated[
        int, typer.Option(metavar="N", help="In which sisters differ together.", min=0, max=10)
    ] = DIRECTIONS,
    doubt: Annotated[
        float, typer.Option(metavar="P", help="That a machine is no sister, before it is measured.")
    ] = DOUBT,
    json: Json = False,
) -> None:
    """Learn from records what the next machine will be like.

    What counts are the readings, never what was concluded from them: a record measured with such a prior teaches the
    same. Records that cannot be used are left out and named. The file goes into a campaign: prior = "vmc600.type.json".

    \b
    Examples:
      axiscal shop type learn records --out vmc600.type.json
      axiscal shop type learn records/*.axiscal --out vmc600.type.json
      axiscal shop type learn store: --of VMC-600 --out vmc600.type.json
    """
    if not 0 < doubt < 1:
        raise typer.BadParameter(said("a doubt lies between 0 and 1"), param_hint="--doubt")
    of = None if machine is None else load_machine(machine)
    prior = learnt_type(_files(records), of, directions, doubt, named)
    if out is not None:
        write_whole(out, prior.text().encode())
    _show(prior, [], out, json)


@app.command("explain")
def explain(
    source: Annotated[
        list[Path], typer.Argument(metavar="FILE.type.json|RECORD|FOLDER...", help="What was learnt, or the records.")
    ],
    campaign: Annotated[
        Path | None,
        typer.Option(metavar="CAMPAIGN", help="Plan this campaign with and without it: readings and minutes saved."),
    ] = None,
    json: Json = False,
) -> None:
    """Say what was learnt from which records.

    It says, too, why other records do not count, and what a campaign saves.

    \b
    Examples:
      axiscal shop type explain vmc600.type.json
      axiscal shop type explain vmc600.type.json --campaign campaign.toml
    """
    described = None if campaign is None else read_campaign(campaign)
    if len(source) == 1 and source[0].suffix == ".json":
        prior = type_prior(carried_text(source[0]))
    else:
        prior = learnt_type(_files(source), None if described is None else described.machine)
    saved = []
    if described is not None:
        saved = [saving_words(*saving(described, prior.text()))]
    _show(prior, saved, None, json)


def saving_words(stated: Plan, taught: Plan) -> str:
    """Return in a sentence what a type saves a campaign, by the plans as stated and by its type."""
    minutes = [to_unit(plan.seconds, "min") for plan in (stated, taught)]
    rms = [to_unit(plan.accuracy.rms, "um") for plan in (stated, taught)]
    counts = {"before": len(stated.readings), "after": len(taught.readings)}
    what = (
        "{before} readings in {minutes:.1f} min become {after} in {then:.1f}: RMS {rms:.3g} um as stated, {known:.3g} "
        "um by its type."
    )
    both = said(what, **counts, minutes=minutes[0], then=minutes[1], rms=rms[0], known=rms[1])
    saved = counts["before"] > counts["after"] or stated.seconds > taught.seconds
    better = said("Nothing is saved." if rms[1] >= rms[0] else "No reading is saved, but it is known better.")
    return both if saved else listed(" ", [better, both])


def _files(given: Sequence[Path]) -> list[Path]:
    """Return records, those in folders, and those of the store; raises RecordError where there are none."""
    found = gathered(given)
    if not found:
        raise RecordError("There is no record in it", "Name records, files *.axiscal, or a folder of them", given[0])
    return found


def _show(prior: TypePrior, saved: Sequence[str], written: Path | None, as_json: bool) -> None:
    rows, errors = list[str](), dict[str, object]()
    for term in ErrorModel(prior.machine).terms:
        learned, variances = prior.learned[term.name], np.diagonal(prior.covariance)[term.columns]
        unit, share = "urad" if term.angular else "um", f"{learned.share:.0%} ± {learned.share_std:.0%}"
        std = [float(np.sqrt(np.mean(each))) for each in (np.diagonal(term.covariance), variances)]
        factor, (stated, known) = float(np.sqrt(learned.scale)), (format_quantity(each, unit, 3) for each in std)
        rows.append(decimals(f"{term.name:14} {stated:>12} {known:>12} {factor:>13.2f} {share:>12}"))
        errors[term.name] = {
            "unit": unit,
            "stated_std": to_unit(std[0], unit),
            "std": to_unit(std[1], unit),
            "times_stated": factor,
            "in_common": learned.share,
            "in_common_std": learned.share_std,
        }
    records = [
        {"file": each.file, "readings": each.readings, "counts": not each.left_out, "why_not": each.left_out or None}
        for each in prior.records
    ]
    spoken, files = [*saved, *summary_sentences(prior)], [] if written is None else [str(written)]
    names = later("error"), later("std stated"), later("by its type"), later("times stated"), later("in common")
    heads = "{:14} {:>12} {:>12} {:>13} {:>12}".format(*map(said, names))
    document = {"records": records, "errors": errors, "said": spoken, "written": files}
    lines = (*spoken, heads, *rows, *(said("Written: {file}", file=file) for file in files))
    say_either(as_json, "axiscal-type-learnt/1", document, lines)
