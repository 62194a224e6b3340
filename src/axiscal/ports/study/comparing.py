"""Ways of measuring compared on the same virtual machines: what each gives, and what one choice changes.

A difference is taken machine by machine and then averaged, d̄ ± 2 s/√n: what machines have in common falls out of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from axiscal.ports.study.study_case import FIGURES, Done, Stop, canonical, key_of
from axiscal.ports.study.study_file import SETUPS, Study
from axiscal.present.sentences import figure

_REACHES = 0.5
"""Share of the machines on which a way has to reach the target for its time to count."""

_SURE = 2.0
"""Standard errors on either side: nineteen of twenty."""
NOTHING = 0.05
"""Minutes or readings, of which nobody takes notice."""
_ROUNDING = 1e-9
"""Share of the values below which they are all the same."""


class Quartiles(NamedTuple):
    """Median and quartiles."""

    middle: float
    low: float
    high: float


class Mean(NamedTuple):
    """A mean over so many machines, and two standard errors of it."""

    value: float
    error: float
    machines: int

    @property
    def sure(self) -> bool:
        """Whether it is surely not nothing."""
        return abs(self.value) > self.error


@dataclass(frozen=True, eq=False, slots=True)
class MeasuringWay:
    """One way of measuring, and what came of it.

    name : in words; choices : values of the grid; figures : by name and machine; failed : of cases
    """

    name: str
    choices: Mapping[str, Any]
    figures: Mapping[str, Mapping[int, float]]
    failed: int

    def spread(self, figure: str) -> Quartiles | None:
        """Return median and quartiles of a figure; None where there is none."""
        values = list(self.figures.get(figure, {}).values())
        return Quartiles(*map(float, np.percentile(values, (50, 25, 75)))) if values else None

    def mean(self, figure: str) -> Mean | None:
        """Return the mean of a figure; None where there is none."""
        return mean_of(list(self.figures.get(figure, {}).values()))

    @property
    def place(self) -> tuple[float, float] | None:
        """Median of the minutes and mean of U, µm; None where there are none."""
        spent, left = self.spread("minutes"), self.mean("U")
        return None if spent is None or left is None else (spent.middle, left.value)


class ChoiceChange(NamedTuple):
    """Effect of one choice compared with another, all else being the same: the differences of figures, by name.

    words : what is done instead of what; key : of the grid
    """

    words: str
    key: str
    figures: Mapping[str, Mean]


def mean_of(values: Sequence[float]) -> Mean | None:
    """Return a mean with two standard errors; of one value alone nobody knows how sure it is."""
    if not values:
        return None
    many = np.array(values, dtype=float)
    if len(many) == 1:
        return Mean(float(many[0]), math.inf, 1)
    spread = float(many.std(ddof=1))
    rounding = _ROUNDING * float(np.abs(many).max())
    return Mean(float(many.mean()), _SURE * spread / math.sqrt(len(many)) if spread > rounding else 0.0, len(many))


def ways_of(study: Study, found: Mapping[str, Done]) -> list[MeasuringWay]:
    """Return every combination of the grid with what came of it, in the order of the study."""
    ways = list[MeasuringWay]()
    for choices in study.ways():
        done = {machine: found.get(key_of(choices, machine)) for machine in range(study.machines)}
        results = {machine: each.result for machine, each in done.items() if each is not None and each.result}
        figures = {
            name: {
                machine: float(value)
                for machine, result in results.items()
                if isinstance(value := result.get(FIGURES[name].column), bool | int | float)
            }
            for name in FIGURES
        }
        failed = sum(each is not None and each.result is None for each in done.values())
        ways.append(MeasuringWay(way_name(study, choices), choices, figures, failed))
    return ways


def way_name(study: Study, choices: Mapping[str, Any]) -> str:
    """Return the choices of a way in words."""
    return "; ".join(choice_words(key, value) for key, value in choices.items()) or study.source.stem


def choice_words(key: str, value: Any) -> str:
    """Return one choice in words."""
    if key == SETUPS:
        return "all set-ups" if value == "all" else " + ".join(value)
    return f"{key} = {value if isinstance(value, str | int | float) else canonical(value)}"


def unbeaten(ways: Sequence[MeasuringWay]) -> list[MeasuringWay]:
    """Return the ways of which no other is both as quick and as good, the quickest first."""
    known = [(*place, way) for way in ways if (place := way.place)]
    return [
        way
        for spent, left, way in sorted(known, key=lambda each: each[:2])
        if not any((c <= spent + NOTHING and a < left) or (c < spent - NOTHING and a <= left) for c, a, _ in known)
    ]


def changes(study: Study, ways: Sequence[MeasuringWay]) -> list[ChoiceChange]:
    """Return what each choice changes beside the first value of its key; of set-ups, what each one more brings."""
    found = list[ChoiceChange]()
    for key, values in study.grid.items():
        for words, before, after in _steps(key, values, study):
            pairs = list(_alike(ways, key, before, after))
            means = {name: mean for name in FIGURES if (mean := _difference(pairs, name)) is not None}
            if means:
                found.append(ChoiceChange(words, key, means))
    return found


def _steps(key: str, values: Sequence[Any], study: Study) -> Iterator[tuple[str, Any, Any]]:
    """Yield which value comes instead of which, and in words."""
    if key != SETUPS:
        for value in values[1:]:
            yield f"{choice_words(key, value)} instead of {choice_words(key, values[0])}", values[0], value
        return
    every = [setup.name for setup in study.described.setups]
    used = {canonical(value): frozenset(every if value == "all" else value) for value in values}
    for before in values:
        for after in values:
            more = used[canonical(after)] - used[canonical(before)]
            if len(more) == 1 and used[canonical(before)] < used[canonical(after)]:
                yield f"{next(iter(more))} besides {choice_words(key, before)}", before, after


def _alike(
    ways: Sequence[MeasuringWay], key: str, before: Any, after: Any
) -> Iterator[tuple[MeasuringWay, MeasuringWay]]:
    """Yield pairs of ways that differ in one choice only."""
    others = {canonical(_without(way, key)): way for way in ways if way.choices[key] == before}
    for way in ways:
        if way.choices[key] == after and (other := others.get(canonical(_without(way, key)))) is not None:
            yield other, way


def _without(way: MeasuringWay, key: str) -> dict[str, Any]:
    return {name: value for name, value in way.choices.items() if name != key}


def _difference(pairs: Sequence[tuple[MeasuringWay, MeasuringWay]], name: str) -> Mean | None:
    """Return the mean difference of a figure over machines, each of which counts once, however many ways it is in."""
    of = dict[int, list[float]]()
    for before, after in pairs:
        first, second = before.figures[name], after.figures[name]
        for unit in first.keys() & second.keys():
            of.setdefault(unit, []).append(second[unit] - first[unit])
    return mean_of([float(np.mean(of[unit])) for unit in sorted(of)])


def verdicts(study: Study, ways: Sequence[MeasuringWay]) -> list[str]:
    """Return what the study has shown, the answer first."""
    said = [*_soonest_of_targets(ways)] if study.stop == Stop() else []
    said += _front(ways)
    said += [sentence for change in changes(study, ways) if (sentence := _change_words(change))]
    machines = study.machines
    of = f"{_counted(len(ways), 'way')} of measuring, each on the same {_counted(machines, 'virtual machine')}"
    said.append(
        f"{of}, drawn from the errors as {study.described.machine_source} states them: for other machines it may be "
        "otherwise. What follows ± is two standard errors over the machines."
    )
    return said


def _soonest_of_targets(ways: Sequence[MeasuringWay]) -> Iterator[str]:
    for target, own in _by_target(ways):
        shares = [(way, share.value) for way in own if (share := way.mean("reached")) is not None]
        good = [way for way, share in shares if share >= _REACHES]
        if shares and not good:
            yield f"{target}: no way reaches it on half of the machines."
        if good:
            yield f"{target}: {_soonest(good)}"


def _front(ways: Sequence[MeasuringWay]) -> Iterator[str]:
    front = unbeaten(ways)
    if len(ways) > 1 and front:
        places = [(way.name, *way.place) for way in front if way.place]
        each = "; ".join(f"{name} ({_amount(c, 'minutes')}, U {_amount(a, 'U')})" for name, c, a in places)
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


def _soonest(good: Sequence[MeasuringWay]) -> str:
    """Return which way reaches the target soonest, and by how much."""
    ranked = sorted(
        (spread.middle, number, way) for number, way in enumerate(good) if (spread := way.spread("minutes"))
    )
    best = ranked[0][2]
    said = f"reached soonest by {best.name}, in {_amount(ranked[0][0], 'minutes')}"
    if len(ranked) == 1:
        return f"{said}."
    other = ranked[1][2]
    both = sorted(best.figures["minutes"].keys() & other.figures["minutes"].keys())
    saved = mean_of([other.figures["minutes"][unit] - best.figures["minutes"][unit] for unit in both])
    if saved is None or not saved.sure:
        return f"{said}; {other.name} takes {_amount(ranked[1][0], 'minutes')}, which is not surely more."
    return f"{said}, {_plus_minus(saved, 'minutes')} less than {other.name}."


def _change_words(change: ChoiceChange) -> str:
    spent, gained = change.figures.get("minutes"), change.figures.get("U")
    if spent is None or gained is None:
        return ""
    return f"{change.words}: {_more(spent)}, and {_smaller(gained)}. {_pays(spent, gained)}"


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


def _more(found: Mean) -> str:
    word = "more" if found.value > 0 else "less"
    return f"{_plus_minus(found, 'minutes')} {word}" if _counts(found) else "as many minutes"


def _counts(spent: Mean) -> bool:
    """Return whether a difference of minutes or readings is one, surely."""
    return spent.sure and abs(spent.value) > NOTHING


def _smaller(found: Mean) -> str:
    word = "larger" if found.value > 0 else "smaller"
    said = _plus_minus(found, "U")
    return f"U {said} {word}" if found.sure else f"U the same ({said})"


def _plus_minus(found: Mean, name: str) -> str:
    error = f" ± {figure(found.error)}" if 0 < found.error < math.inf else ""
    return f"{figure(abs(found.value))}{error} {_unit(name)}"


def _amount(value: float, name: str) -> str:
    return f"{figure(value)} {_unit(name)}"


def _unit(name: str) -> str:
    return FIGURES[name].unit or name


def _counted(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"
