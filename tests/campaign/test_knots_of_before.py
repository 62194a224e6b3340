"""A record of before knots stood at a quarter of the length: it keeps its knots and its figures."""

import json
from pathlib import Path

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.record.events import Created
from axiscal.record.payload import decode, encode
from axiscal.record.store import Record
from tests.generators.texts import campaign_text, machine_text, setup_text

MACHINE = machine_text("w-b-X-t", {"X": (0, 600)}, {"EXX": "20 um"}).replace("knots = 5, ", "")
CAMPAIGN = campaign_text(
    "machine.toml",
    setup_text("laser", "interferometer", direction="x", moves=["X"], noise="0.5 um"),
    target={"readings": 9},
    usual="off",
    sure="exactly",
)
READINGS = tuple(
    Reading("laser", (x,), (1,), value)
    for x, value in ((0.0, 0.0), (0.07, 9e-6), (0.21, -4e-6), (0.28, 2e-6), (0.45, 11e-6), (0.6, 3e-6))
)
PLACES = np.array([0.1, 0.33, 0.52])
MEAN = (7.914893429797382e-06, 7.947658443731208e-06, 7.426206284250218e-06)
STD = (1.9899868604924287e-06, 3.7581953995115035e-06, 5.984487017031259e-06)
"""m, at the places, less what EXX is at 0: of this record when half of the length was usual."""


def described(knots: str = "") -> CampaignDescription:
    return campaign_from_texts(
        CAMPAIGN, "campaign.toml", MACHINE.replace('length = "200 mm"', f'length = "150 mm"{knots}'), "machine.toml"
    )


def written(path: Path, description: CampaignDescription, *, before: bool = False) -> Path:
    """Write a record of the readings.  before : its first event has no word of knots"""
    with Campaign.create(path, description) as campaign:
        campaign.adopt(READINGS)
        (first, *rest) = [stored.event for stored in campaign.log.events()]
    if before:
        kind, text = encode(first)
        fields = json.loads(text)
        assert fields.pop("fine_knots") is True
        created = decode(kind, json.dumps(fields))
        assert isinstance(created, Created)
        path.unlink()
        Record.create(path, created).close()
        with Record.open(path) as record:
            for event in rest:
                record.append(event)
    return path


def figures(path: Path) -> tuple[Array, Array]:
    """Return what is known of EXX at the places, less what it is at 0: means and stds, (3,), m."""
    with Campaign.open(path) as campaign:
        known = campaign.estimate()
    term, belief = known.case.errors.by_name["EXX"], known.knowledge.belief
    rows = term.rows(PLACES) - term.rows(np.zeros(1))
    covariance = (belief.factor @ belief.factor.T)[term.columns, term.columns]
    return rows @ belief.mean[term.columns], np.sqrt(np.diagonal(rows @ covariance @ rows.T))


def test_a_record_of_before_keeps_its_knots_and_its_figures(tmp_path: Path) -> None:
    old = written(tmp_path / "old.axiscal", described(), before=True)
    stated = written(tmp_path / "stated.axiscal", described(', spacing = "75 mm"'))
    new = written(tmp_path / "new.axiscal", described())
    mean, std = figures(old)
    np.testing.assert_allclose(mean, MEAN, rtol=1e-6)
    np.testing.assert_allclose(std, STD, rtol=1e-6)
    np.testing.assert_allclose((mean, std), figures(stated), rtol=1e-12)
    assert not np.allclose(std, figures(new)[1], rtol=1e-3)
    with Campaign.open(new) as campaign:
        assert campaign.case().errors.by_name["EXX"].spline.size == 17
