"""All campaigns in all languages, by two processes; a single campaign by one, which loads the package once."""

import multiprocessing
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from tests.golden.given import given
from tests.golden.playing import load, played
from tests.golden.showing import shown

LANGUAGES = ("en", "de")
FIRST = ("five_axes", "mill", "stations", "controllers", "nonlinear")
"""Begun before the others, because they take longest."""
Texts = Mapping[str, str]


def all_played(chosen: Sequence[str], folder: Path) -> tuple[dict[str, Texts], list[str]]:
    """Return the texts of each campaign, and a line for each command that ended otherwise than its page says."""
    ordered = sorted(
        ((name, language) for name in chosen for language in LANGUAGES), key=lambda job: job[0] not in FIRST
    )
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(2, len(chosen)), mp_context=context, initializer=load) as workers:
        jobs = {job: workers.submit(_texts, *job, folder.resolve()) for job in ordered}
        answers = {job: answer.result() for job, answer in jobs.items()}
    found = {name: _together({language: answers[name, language][0] for language in LANGUAGES}) for name in chosen}
    return found, [line for _, lines in answers.values() for line in lines]


def _texts(name: str, language: str, parent: Path) -> tuple[Texts, list[str]]:
    folder = parent / language / name
    said = played(given(name), language, folder)
    wrong = [
        f"{name}: {' '.join(s.command.words)}: status {s.status}: {s.err[-300:]}" for s in said if not s.as_expected
    ]
    return shown(given(name), said, folder), wrong


def _together(spoken: Mapping[str, Texts]) -> Texts:
    """Return all English texts, and those in other languages that differ from them: most documents are the same."""
    english = spoken[LANGUAGES[0]]
    others = {
        f"{tongue}/{name}": text
        for tongue in LANGUAGES[1:]
        for name, text in spoken[tongue].items()
        if english.get(name) != text
    }
    return {**english, **others}
