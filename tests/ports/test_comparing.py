"""Ways compared: by numpy on figures that are known, and in words."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axiscal.ports.study.comparing import changes, mean_of, unbeaten, verdicts, ways_of
from axiscal.ports.study.results import rows_of
from axiscal.ports.study.study_case import Done, Stop
from axiscal.ports.study.study_file import Study, read_study
from axiscal.ports.study.study_page import render
from tests.ports.texts import STUDY, written

GRID = 'setups = [["laser"], ["laser", "dial"], ["dial"]]\n"errors.EXX.std" = ["5 um", "15 um"]\n'
MACHINES = 12


def _study(folder: Path) -> Study:
    text = STUDY.split("[grid]")[0].replace("machines = 2", f"machines = {MACHINES}")
    return read_study(written(folder, f"{text}[grid]\n{GRID}"))


def _found(study: Study, seed: int = 1) -> dict[str, Done]:
    """Return made-up figures: a dial besides the laser takes 7 minutes and 1 um off U, whatever the machine."""
    rng = np.random.default_rng(seed)
    own = 4 + rng.normal(size=MACHINES)
    found = {}
    for choices in study.ways():
        both = len(choices["setups"]) == 2
        for case in (c for c in study.cases() if c.variant.choices == study.variant(choices).choices):
            U = (
                own[case.machine]
                - both
                + 0.5 * (choices["setups"] == ["dial"])
                + 0.01 * rng.normal()
                + 3.0 * (choices["errors.EXX.std"] == "15 um")
            )
            minutes = 40.0 + 7.0 * both + 2.0 * (choices["setups"] == ["dial"])
            figures: dict[str, Any] = {"minutes": minutes, "U_um": U, "coverage_tcp": 0.95, "reached": bool(U < 5)}
            found[case.key] = Done(case.key, figures)
    return found


def test_differences_are_taken_machine_by_machine(tmp_path: Path) -> None:
    study = _study(tmp_path)
    found = _found(study)
    every = changes(study, ways_of(study, found))
    assert [change.words for change in every] == [
        "dial besides laser", "laser besides dial", "errors.EXX.std = 15 um instead of errors.EXX.std = 5 um",
    ]  # fmt: skip
    rows = rows_of(study, found)

    def of(setups: str, std: str) -> list[float]:
        return [row["U_um"] for row in rows if row["setups"] == setups and row["errors.EXX.std"] == std]

    by_machine = np.mean(
        [np.subtract(of('["laser","dial"]', n), of('["laser"]', n)) for n in ("5 um", "15 um")], axis=0
    )
    U = every[0].figures["U"]
    assert U.value == pytest.approx(by_machine.mean())
    assert U.error == pytest.approx(2 * by_machine.std(ddof=1) / MACHINES**0.5)
    assert U.sure
    assert every[0].figures["minutes"][:2] == (7.0, 0.0)
    unpaired = 2 * (np.var(of('["laser"]', "5 um"), ddof=1) * 2 / MACHINES) ** 0.5
    assert U.error < unpaired / 10


def test_the_answer_is_in_words_and_first(tmp_path: Path) -> None:
    study = replace(_study(tmp_path), stop=Stop())
    said = verdicts(study, ways_of(study, _found(study)))
    assert said[0].startswith("Target of the campaign: reached soonest by laser")
    (dial,) = (sentence for sentence in said if sentence.startswith("dial besides laser"))
    assert "7.00 min more, and U 1.0" in dial
    assert dial.endswith("smaller. Accuracy for time.")
    (times,) = (sentence for sentence in said if sentence.startswith("errors.EXX.std"))
    assert "as many minutes, and U 3.0" in times
    assert times.endswith("larger. It does not pay.")


def test_ways_that_another_beats_are_not_among_the_unbeaten(tmp_path: Path) -> None:
    study = _study(tmp_path)
    names = [way.name for way in unbeaten(ways_of(study, _found(study)))]
    assert names == ["laser; errors.EXX.std = 5 um", "laser + dial; errors.EXX.std = 5 um"]


def test_one_machine_is_not_sure_and_none_says_nothing() -> None:
    assert mean_of([]) is None
    alone, alike = mean_of([1.0]), mean_of([1.0, 1.0])
    assert alone is not None
    assert alike is not None
    assert (alone.sure, alike.sure) == (False, True)


def test_the_page_has_the_answer_the_pictures_and_what_failed(tmp_path: Path) -> None:
    study = _study(tmp_path)
    found = _found(study)
    broken = next(iter(found))
    found[broken] = Done(broken, None, "the <places> ran out")
    del found[list(found)[-1]]
    page = render(study, found)
    assert page.count('<svg class="picture"') == 3
    assert "the &lt;places&gt; ran out" in page
    assert "1 case is missing" in page
    assert "http://" not in page.replace("http://www.w3.org", "")
    assert page == render(study, dict(reversed(found.items())))
