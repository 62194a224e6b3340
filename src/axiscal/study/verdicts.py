"""Which set-up pays, in sentences: what a study has shown, and how sure that is."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from axiscal.report.sentences import figure
from axiscal.study.comparing import (
    ACCURACIES,
    COSTS,
    NOTHING,
    ChoiceChange,
    Mean,
    MeasuringWay,
    best_kept,
    changes,
    choice_words,
    mean_of,
    unbeaten,
)
from axiscal.study.figures_kept import FIGURES
from axiscal.study.study_case import Stop
from axiscal.study.study_file import Study

_REACHES = 0.5
"""Share of the machines on which a way has to reach the target for its time to count."""
_WORDS = {"U": "U", "rms": "the promised RMS", "true_rms": "the true RMS"}


def verdicts(study: Study, ways: Sequence[MeasuringWay]) -> list[str]:
    """Return what the study has shown, the answer first."""
    cost, accuracy = best_kept(study, COSTS), best_kept(study, ACCURACIES)
    said = list[str]()
    if cost is not None and accuracy is not None:
        said += _soonest_of_targets(ways, cost) if study.stop == Stop() else []
        said += _front(ways, cost, accuracy)
        said += [sentence for change in changes(study, ways) if (sentence := _change_words(change, cost, accuracy))]
    machines = study.machines * study.draws
    of = f"{_counted(len(ways), 'way')} of measuring, each on the same {_counted(machines, 'virtual machine')}"
    said.append(
        f"{of}, drawn from the errors as {study.described.machine_source} states them: for other machines it may be "
        "otherwise. What follows ± is two standard errors over the machines."
    )
    return said


def _soonest_of_targets(ways: Sequence[MeasuringWay], cost: str) -> Iterator[str]:
    for target, own in _by_target(ways):
        shares = [(way, share.value) for way in own if (share := way.mean("reached")) is not None]
        good = [way for way, share in shares if share >= _REACHES]
        if shares and not good:
            yield f"{target}: no way reaches it on half of the machines."
        if good:
            yield f"{target}: {_soonest(good, cost)}"


def _front(ways: Sequence[MeasuringWay], cost: str, accuracy: str) -> Iterator[str]:
    front = unbeaten(ways, cost, accuracy)
    if len(ways) > 1 and front:
        each = "; ".join(f"{way.name} ({_at(way, cost, accuracy)})" for way in front)
        yield (
            f"No other way is both quicker and better than: {each}."
            if len(front) < len(ways)
            else (f"Each way buys accuracy with time: {each}.")
        )


def _by_target(ways: Sequence[MeasuringWay]) -> list[tuple[str, list[MeasuringWay]]]:
    """Return the ways that have the same target, with what that is: only these are compared by when they reach it."""
    found = dict[str, list[MeasuringWay]]()
    for way in ways:
        own = [choice_words(key, value) for key, value in way.choices.items() if key.startswith("target.")]
        found.setdefault("; ".join(own) or "Target of the campaign", []).append(way)
    return list(found.items())


def _soonest(good: Sequence[MeasuringWay], cost: str) -> str:
    """Return which way reaches the target soonest, and by how much."""
    ranked = sorted((spread.middle, number, way) for number, way in enumerate(good) if (spread := way.spread(cost)))
    best = ranked[0][2]
    said = f"reached soonest by {best.name}, in {_amount(ranked[0][0], cost)}"
    if len(ranked) == 1:
        return f"{said}."
    other = ranked[1][2]
    both = sorted(best.figures[cost].keys() & other.figures[cost].keys())
    saved = mean_of([other.figures[cost][unit] - best.figures[cost][unit] for unit in both])
    if saved is None or not saved.sure:
        return f"{said}; {other.name} takes {_amount(ranked[1][0], cost)}, which is not surely more."
    return f"{said}, {_plus_minus(saved, cost)} less than {other.name}."


def _change_words(change: ChoiceChange, cost: str, accuracy: str) -> str:
    spent, gained = change.figures.get(cost), change.figures.get(accuracy)
    if spent is None or gained is None:
        return ""
    return f"{change.words}: {_more(spent, cost)}, and {_smaller(gained, accuracy)}. {_pays(spent, gained)}"


def _pays(spent: Mean, gained: Mean) -> str:
    """Return whether a choice pays: better for no more, or no worse for less."""
    better, worse = gained.sure and gained.value < 0, gained.sure and gained.value > 0
    less, more = _counts(spent) and spent.value < 0, _counts(spent) and spent.value > 0
    if math.isinf(spent.error):
        return "One machine does not tell whether it pays."
    if (better and not more) or (less and not worse):
        return "It pays."
    if (more and not better) or (worse and not less):
        return "It does not pay."
    return "Accuracy for time." if better or worse else "It makes no difference that these machines show."


def _more(found: Mean, cost: str) -> str:
    word = "more" if found.value > 0 else "less"
    return f"{_plus_minus(found, cost)} {word}" if _counts(found) else f"as many {cost}"


def _counts(spent: Mean) -> bool:
    """Return whether a difference of minutes or readings is one, surely."""
    return spent.sure and abs(spent.value) > NOTHING


def _smaller(found: Mean, accuracy: str) -> str:
    word = "larger" if found.value > 0 else "smaller"
    said = _plus_minus(found, accuracy)
    return f"{_WORDS[accuracy]} {said} {word}" if found.sure else f"{_WORDS[accuracy]} the same ({said})"


def _plus_minus(found: Mean, name: str) -> str:
    error = f" ± {figure(found.error)}" if 0 < found.error < math.inf else ""
    return f"{figure(abs(found.value))}{error} {_unit(name)}"


def _amount(value: float, name: str) -> str:
    return f"{figure(value)} {_unit(name)}"


def _at(way: MeasuringWay, cost: str, accuracy: str) -> str:
    spread, mean = way.spread(cost), way.mean(accuracy)
    assert spread is not None
    assert mean is not None
    return f"{_amount(spread.middle, cost)}, {_WORDS[accuracy]} {_amount(mean.value, accuracy)}"


def _unit(name: str) -> str:
    return FIGURES[name].unit or name


def _counted(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"
