"""Ways of measuring compared on the same virtual machines: what each gives, and what one choice changes.

A difference is taken machine by machine and then averaged, d̄ ± 2 s/√n: what machines have in common falls out of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from axiscal.study.figures_kept import FIGURES
from axiscal.study.study_case import canonical, key_of
from axiscal.study.study_file import SETUPS, TIMES, Study
from axiscal.study.work import Done

Unit = tuple[int, int]
"""Draw and machine: what is measured in every way."""
_SURE = 2.0
"""Standard errors on either side: nineteen of twenty."""
NOTHING = 0.05
"""Minutes or readings, of which nobody takes notice."""
_ROUNDING = 1e-9
"""Share of the values below which they are all the same."""
ACCURACIES, COSTS = ("U", "rms", "true_rms"), ("minutes", "readings")
"""By what ways are compared, the first one that is kept."""


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
    figures: Mapping[str, Mapping[Unit, float]]
    failed: int

    def spread(self, figure: str) -> Quartiles | None:
        """Return median and quartiles of a figure; None where there is none."""
        values = list(self.figures.get(figure, {}).values())
        return Quartiles(*map(float, np.percentile(values, (50, 25, 75)))) if values else None

    def mean(self, figure: str) -> Mean | None:
        """Return the mean of a figure; None where there is none."""
        return mean_of(list(self.figures.get(figure, {}).values()))


class ChoiceChange(NamedTuple):
    """What one choice changes beside another, all else being the same: the differences of figures, by name.

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
    ways = dict[str, MeasuringWay]()
    for choices, draw in study.ways():
        name = way_name(study, choices)
        figures: dict[str, dict[Unit, float]] = {each: {} for each in study.keep}
        way = ways.setdefault(canonical(choices), MeasuringWay(name, choices, figures, 0))
        failed = way.failed
        for machine in range(study.machines):
            done = found.get(key_of(choices, draw, machine))
            if done is None or done.result is None:
                failed += done is not None
                continue
            _enter(way.figures, (draw, machine), done.result)
        ways[canonical(choices)] = MeasuringWay(name, choices, way.figures, failed)
    return list(ways.values())


def _enter(figures: Any, unit: Unit, result: Mapping[str, Any]) -> None:
    for name, of in figures.items():
        value = result.get(FIGURES[name].column)
        if isinstance(value, bool | int | float):
            of[unit] = float(value)


def way_name(study: Study, choices: Mapping[str, Any]) -> str:
    """Return the choices of a way in words."""
    return "; ".join(choice_words(key, value) for key, value in choices.items()) or study.source.stem


def choice_words(key: str, value: Any) -> str:
    """Return one choice in words."""
    if key == SETUPS:
        return "all set-ups" if value == "all" else " + ".join(value)
    if key == TIMES:
        return f"stated std × {value:g}"
    return f"{key} = {value if isinstance(value, str | int | float) else canonical(value)}"


def best_kept(study: Study, among: Iterable[str]) -> str | None:
    """Return the first of some figures that is kept."""
    return next((name for name in among if name in study.keep), None)


def unbeaten(ways: Sequence[MeasuringWay], cost: str, accuracy: str) -> list[MeasuringWay]:
    """Return the ways of which no other is both as cheap and as good, the cheapest first."""
    known = [(c.middle, a.value, way) for way in ways if (c := way.spread(cost)) and (a := way.mean(accuracy))]
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
            means = {name: mean for name in study.keep if (mean := _difference(pairs, name)) is not None}
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
    of = dict[Unit, list[float]]()
    for before, after in pairs:
        first, second = before.figures[name], after.figures[name]
        for unit in first.keys() & second.keys():
            of.setdefault(unit, []).append(second[unit] - first[unit])
    return mean_of([float(np.mean(of[unit])) for unit in sorted(of)])
