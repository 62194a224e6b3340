"""Directions that count: of a printer's bed the height alone, in RMS and U, in a plan, in files, in words."""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from axiscal.cli import app
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.description.first_campaign import Purpose
from axiscal.description.first_files import first_files, of_builtin
from axiscal.errors.volume import volume_moments
from axiscal.estimation.accuracy.alignment import Alignment, sampled_moments
from axiscal.estimation.accuracy.expanded import expanded
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.estimation.estimation import Estimation
from axiscal.exceptions import InputError
from axiscal.measurement.reading import Reading
from axiscal_core.points import even_points
from tests.commands import Command

_EVERY_LINE = 'directions = ["z"]'
_EVERY = "aligned = false"


def texts() -> tuple[str, str]:
    """Return campaign.toml and machine.toml as `init` writes them for the probe of a printer."""
    found = first_files(of_builtin("printer-gantry"), ["probe"], Purpose("30 um")).texts
    return found["campaign.toml"], found["machine.toml"]


def described(directions: str = _EVERY_LINE) -> CampaignDescription:
    campaign, machine = texts()
    assert _EVERY_LINE in campaign
    return campaign_from_texts(campaign.replace(_EVERY_LINE, directions), "campaign.toml", machine, "machine.toml")


@cache
def known(directions: str = _EVERY_LINE) -> Estimation:
    """Return what a grid of made-up heights makes known."""
    grid = [(x, y) for x in np.linspace(0.02, 0.28, 5) for y in np.linspace(0.02, 0.28, 5)]
    rng = np.random.default_rng(2)
    case = Case(described(directions))
    names = [axis.name for axis in case.description.machine.axes]
    poses = [tuple({"X": x, "Y": y}.get(name, 0.0) for name in names) for x, y in grid]
    return estimated(case, [Reading("probe", pose, (1, 1, 1), 60e-6 * rng.standard_normal()) for pose in poses])


def test_rms_and_worst_are_those_of_heights_of_the_belief() -> None:
    found = known()
    errors, yardstick, rng = found.case.errors, found.case.yardstick, np.random.default_rng(1)
    low, high = np.array(yardstick.box).T
    poses = rng.uniform(low, high, (500, len(low)))
    rows = errors.rows(poses, rng.choice([-1.0, 1.0], poses.shape))[:, 2]
    belief = found.printed.belief
    coefficients = (belief.sample(rng, 3000) - belief.mean)[:, : errors.size]
    heights = coefficients @ rows.T
    shift = heights.mean(axis=1, keepdims=True) if yardstick.zeroed[2] else 0.0
    rests = np.mean(np.einsum("fm,f->m", errors.levers(poses)[:, :, 2] ** 2, errors.rests**2))
    assert found.accuracy.rms == pytest.approx(np.sqrt(np.mean((heights - shift) ** 2) + rests), rel=0.04)
    assert found.accuracy.rms < 0.3 * known(_EVERY).accuracy.rms
    assert found.accuracy.worst >= found.accuracy.rms


def test_u_is_that_of_the_height_and_every_direction_keeps_its_own() -> None:
    """A distance along one direction is a ±: U in space is then U along z; what does not count is not called known."""
    found, whole = known(), known(_EVERY)
    alone = expanded(found.case.yardstick, found.knowledge.belief)
    every = expanded(whole.case.yardstick, found.knowledge.belief)
    assert alone.space == pytest.approx(alone.axes[2], rel=1e-6)
    assert alone.axes == pytest.approx(every.axes, rel=1e-12)
    assert alone.axes[0] > 3 * alone.axes[2]
    assert every.space > 3 * alone.space


def test_the_criterion_is_blind_to_what_moves_the_nozzle_sideways() -> None:
    of = known().case.errors.names
    alone, every = (each.case.yardstick.root.weights for each in (known(), known(_EVERY)))
    sideways, up = of["EXX"].columns, of["EZX"].columns
    assert np.abs(alone[sideways, sideways]).max() == 0.0
    np.testing.assert_allclose(alone[up, up], every[up, up], atol=1e-12)


def test_a_part_is_levelled_by_heights_alone() -> None:
    """Against a plane fitted to the heights of drawn machines by least squares."""
    errors, rng = known().case.errors, np.random.default_rng(4)
    low, high = np.array(known().case.yardstick.box).T
    poses = low + (high - low) * even_points(200, len(low))
    alignment = Alignment(errors, poses, (False, False, True))
    gram = sampled_moments(errors, poses, alignment, alignment.counted).gram
    drawn = errors.prior_root() @ rng.standard_normal(errors.size)
    for function in errors.functions:
        if function.kind == "reversal":
            drawn[function.columns] = 0.0
    deviations = errors.rows(poses, np.zeros_like(poses)) @ drawn
    names = [axis.name for axis in errors.machine.axes]
    plane = np.column_stack([np.ones(200), poses[:, names.index("X")], poses[:, names.index("Y")]])
    fitted = np.linalg.lstsq(plane, deviations[:, 2], rcond=None)[0]
    left = deviations[:, 2] - plane @ fitted
    assert drawn @ gram @ drawn == pytest.approx(float(np.mean(left**2)), rel=1e-6)
    np.testing.assert_allclose(alignment.left(poses, deviations)[:, 2], left, atol=1e-9)


def test_sampled_means_are_those_in_closed_form() -> None:
    errors, box = known().case.errors, known().case.yardstick.box
    low, high = np.array(box).T
    counted = (False, False, True)
    sampled = sampled_moments(errors, low + (high - low) * even_points(3000, 3), None, counted)
    closed = volume_moments(errors, box, counted)
    spread = errors.prior_covariance()
    assert np.sum(sampled.gram * spread) == pytest.approx(float(np.sum(closed.gram * spread)), rel=0.01)
    assert sampled.rest == pytest.approx(closed.rest, rel=0.01, abs=0)


@pytest.mark.parametrize("line", ["directions = []", 'directions = ["up"]', 'directions = "z"'])
def test_directions_that_are_none_are_refused(line: str) -> None:
    with pytest.raises(InputError, match="direction"):
        described(line)


@pytest.mark.long
def test_plan_run_and_files_of_a_bed_say_that_the_height_counts(tmp_path: Path, command: Command) -> None:
    words = ["--machine", "printer-gantry", "--instrument", "probe", "--target", "60 um"]
    assert app.run(["init", str(tmp_path / "bed"), *words]) == 0
    campaign, out = str(tmp_path / "bed" / "campaign.toml"), tmp_path / "out"
    said = command("run", campaign, "--source", "sim:3", "--out", out, "--details").printed
    assert re.search(r"^Expanded uncertainty U along z alone: [\d.]+ um$", said, re.MULTILINE)
    assert "counted along z alone" in said
    result = json.loads((out / "result.json").read_text())
    assert result["U_um"] == pytest.approx(result["U_axis_um"]["z"], rel=1e-3)
    assert result["target_reached"] is (result["U_um"] <= 60)
    assert result["target_reached"] == ("U target reached" in said)
    assert result["readings"] < 30
    page = (out / "report.html").read_text()
    assert "along z alone" in page
    assert "e+02" not in said + page
    assert (out / "tables" / "klipper").is_dir()
