"""The same U and the same line about each target in HTML, on paper, in a terminal, on the page and in JSON."""

from __future__ import annotations

import html
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import campaign_from_texts
from axiscal.measurement.reading import Reading
from axiscal.report.headline import first_lines
from axiscal.report.page import render
from axiscal.report.printed import _Document
from axiscal.report.result_document import result_json
from axiscal.report.summarising import Extras, summarise
from axiscal.report.summary import Summary
from tests.generators.laser_axis import CAMPAIGN, MACHINE, machine, plus, read

DRIFTED = plus(read(machine(2), 24), 10e-6 * np.linspace(0, 1, 24))
SCATTERED = plus(read(machine(1), 24), 25e-6 * np.random.default_rng(1).choice([-1.0, 1.0], 24))


class Said(NamedTuple):
    """U in um as it is printed, "" where it is withheld, and what is said of targets in the order of their sizes."""

    u: str
    targets: list[str]


RECORDS: dict[str, tuple[str, list[Reading]]] = {
    "reached": ('rms = "3 um"', read(machine(2), 24)),
    "not reached": ('rms = "0.2 um"\nreadings = 12', read(machine(2), 12)),
    "withheld": ('U = "9 um"', SCATTERED),
    "by a hair": ('U = "13 um"\nrms = "6 um"', read(machine(3), 8)),
    "drifted": ('U = "2 um"\nworst = "4 um"', DRIFTED),
    "few": ('U = "9 um"', read(machine(5), 5)),
    "hardly any": ('worst = "9 um"', read(machine(5), 2)),
    "a reading of nothing": ("readings = 9", read(machine(6), 9)),
    "all three": ('U = "3 um"\nrms = "1 um"\nworst = "1.5 um"', read(machine(7), 18)),
    "more than a millimetre": ('U = "1 um"', []),
}
"""Target, and readings."""
QUICK = ("reached", "not reached", "withheld")


def summary_of(name: str, folder: Path) -> Summary:
    """Return the summary of a record that has ended."""
    target, readings = RECORDS[name]
    described = MACHINE.replace('std = "10 um"', 'std = "3 mm"') if name == "more than a millimetre" else MACHINE
    text = CAMPAIGN.replace('rms = "3 um"', target)
    with Campaign.create(folder / "c.axiscal", campaign_from_texts(text, "c.toml", described, "m")) as campaign:
        campaign.adopt(tuple(readings))
        campaign.finish()
        return summarise(campaign, campaign.concluded(), Extras())


def said(text: str) -> Said:
    """Return what a text says first of U, and of all targets."""
    plain = re.sub(r"<[^>]*>", "", html.unescape(text)).replace("µm", "um")
    plain = re.sub("[\u00a0\u202f]", " ", plain)
    known = re.search(r"U = ([0-9][0-9. ]*?) um", plain)
    targets = dict.fromkeys(re.findall(r"target [0-9.]+ um: (?:not )?reached", plain))
    return Said(known[1].replace(" ", "") if known else "", sorted(targets))


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.long) for name in RECORDS]
)
def test_every_surface_says_the_same(name: str, tmp_path: Path) -> None:
    summary = summary_of(name, tmp_path)
    paper = _Document(summary, tmp_path)._first()
    document = result_json(summary)
    page = render(summary)
    found = said(first_lines(summary))
    assert said(page[: page.index('<section id="who">')]) == found
    assert said(" ".join([paper["result"], *paper["sentences"]])) == found
    assert (document["U_um"] is None) == (found.u == "")
    if found.u:
        assert float(found.u) == pytest.approx(document["U_um"], rel=5.1e-3)
    known = {"U": document["U_um"], "rms": document["rms_um"], "worst": document["worst_um"]}
    wanted = {key: document[f"target_{key}_um"] for key in known}
    lines = [
        f"target {limit:g} um: {'not ' if document['U_um'] is None or known[key] > limit else ''}reached"
        for key, limit in wanted.items()
        if limit is not None
    ]
    assert sorted(lines) == found.targets
    reached = any(line.endswith("um: reached") for line in lines)
    assert document["target_reached"] is (reached if lines else None)
