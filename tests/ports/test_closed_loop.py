"""A case that plans anew while readings come is a campaign: reading by reading what `run` asks the same machine."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.sources.simulated import SimulatedSource
from axiscal.campaign.sources.source import Answer, Request
from axiscal.measurement.place import Place
from axiscal.planning.next_readings import next_places
from axiscal.ports.study.outcome import outcome, prepared, replanned
from axiscal.ports.study.study_case import Stop
from axiscal.ports.study.study_file import read_study
from tests.ports.texts import CAMPAIGN, STUDY, written

REPLANNED = STUDY.split("[grid]")[0] + 'method = "replanned"\n'
LEARNT = CAMPAIGN.replace('sure = "exactly"', 'sure = "roughly"')
FAR = CAMPAIGN.replace('"3 um"', '"1 nm"')
"""No readings reach it: what ends it is that some in a row hardly help."""
DRIFTING = CAMPAIGN.replace('noise = "0.5 um"', 'noise = "0.5 um"\ndrift = "20 um/h"')


class Wild(SimulatedSource):
    """Every seventh reading is off by 60 um, as where a probe met a chip."""

    def read(self, request: Request) -> Answer:
        found = super().read(request)
        return found if request.reading % 7 else replace(found, value=found.value + 60e-6)


@pytest.mark.long
@pytest.mark.parametrize(
    ("campaign", "stop", "source"),
    [
        (CAMPAIGN, '"target"', SimulatedSource),
        (FAR, '"target"', SimulatedSource),
        (LEARNT, "{ readings = 10 }", SimulatedSource),
        (DRIFTING, '{ budget = "14 min" }', SimulatedSource),
        (CAMPAIGN, "{ readings = 16 }", Wild),
    ],
)
def test_a_case_reads_what_a_campaign_reads(
    tmp_path: Path, campaign: str, stop: str, source: type[SimulatedSource], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("axiscal.ports.study.outcome.SimulatedSource", source)
    if campaign == FAR:  # four readings that help by less than a fifth do, in place of fifty and a hundredth
        monkeypatch.setattr("axiscal.campaign.ending.FUTILE", 4)
        monkeypatch.setattr("axiscal.campaign.ending._HARDLY", 0.8)
    plans = list[object]()

    def counted(*of: Any) -> tuple[Place, ...]:
        plans.append(of)
        return next_places(*of)

    monkeypatch.setattr("axiscal.ports.study.outcome.next_places", counted)
    study = read_study(written(tmp_path, REPLANNED.replace("{ readings = 6 }", stop), campaign))
    (ready,) = {prepared(case.variant) for case in study.cases()}
    truth, described = ready.simulator.drawn(12), ready.case.description
    found = replanned(ready.case, study.stop, truth, 12)
    stop_at = study.stop
    if stop_at != Stop():
        plain = replace(described.target, rms=None, worst=None, expanded=None)
        described = replace(described, target=replace(plain, readings=stop_at.readings, budget=stop_at.budget))
    with Campaign.create(tmp_path / "it.axiscal", described) as of:
        of.description = described  # what ends it is the study's, and not in the text
        of.run(source(truth, 12), lambda _: None)
        assert [(r.place, r.value) for r in of.state.readings] == [(r.place, r.value) for r in found]
    assert len(found) > 3
    assert len(plans) > 1 or source is not Wild  # bad readings let the rest be planned anew


@pytest.mark.long
def test_a_case_is_a_function_of_itself(tmp_path: Path) -> None:
    study = read_study(written(tmp_path, REPLANNED.replace("{ readings = 6 }", '"target"')))
    case = next(study.cases())
    assert outcome(case) == (found := outcome(case))
    assert found["reached"]
