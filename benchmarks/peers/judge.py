"""What is asked of our side, as sentences: reached or not, and by which figure."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks.peers import evaluator
from benchmarks.peers.field import FIELD, Rival, rival_of
from benchmarks.peers.problems import CASES, Array, CriterionName, Posed, Stacked
from benchmarks.peers.runner import Outcome

FASTER = {"a": 50.0, "b": 30.0, "c": 20.0}
"""So many times faster than Trieste is a pick to be."""
LONGEST = {"c": 30.0}
"""So many seconds may a whole plan take where Trieste's time is no measure."""
_ROUNDING = 1e-9

Outcomes = dict[tuple[str, str, str], Outcome]
Picker = Callable[[Posed], Callable[[Array], Array]]


@dataclass(frozen=True, slots=True)
class Verdict:
    """A sentence; reached is None where a library is missing."""

    text: str
    reached: bool | None

    def __str__(self) -> str:
        words = {True: "reached", False: "**not reached**", None: "not judged"}
        return f"- {words[self.reached]}: {self.text}"


@dataclass(frozen=True, slots=True)
class Judge:
    """Looks at the outcomes under one criterion.  ours : our `picker`, for the states that others reach"""

    outcomes: Outcomes
    criterion: CriterionName
    ours: Picker

    def verdicts(self) -> Iterator[Verdict]:
        """Yield every sentence."""
        for case in CASES:
            yield self._faster(case)
        yield from (self._gains(rival) for rival in FIELD if rival.manner == "one at a time" and not rival.ours)
        for case in CASES:
            yield self._lower(case)
            yield self._sooner(case)
        for case in CASES:
            yield self._listed(case)

    def _of(self, key: str, case: Stacked) -> Outcome | None:
        found = self.outcomes.get((key, case.letter, self.criterion))
        return found if found and not found.sorry else None

    def _faster(self, case: Stacked) -> Verdict:
        mine, theirs = self._of("axiscal", case), self._of("trieste", case)
        asked = f"({case.letter}) a pick {FASTER[case.letter]:.0f} times faster than Trieste's"
        if mine is None or theirs is None:
            return Verdict(f"{asked}; there is nothing to compare.", None)
        ratio = call_seconds(theirs) / call_seconds(mine)
        fewest = self._of("trieste-fewest", case)
        beside = f", {call_seconds(fewest) / call_seconds(mine):.0f} over the fewest places" if fewest else ""
        return Verdict(f"{asked}: {ratio:.0f} times{beside}.", ratio >= FASTER[case.letter])

    def _gains(self, rival: Rival) -> Verdict:
        known = [(case, self._of(rival.key, case)) for case in CASES]
        found = {case.letter: self._worst(case, outcome) for case, outcome in known if outcome is not None}
        asked = f"at every state that {rival.label} reaches, our next pick gains at least as much"
        if not found:
            return Verdict(f"{asked}; there is nothing to compare.", None)
        figures = ", ".join(f"({letter}) {worst:.9g}" for letter, worst in found.items())
        return Verdict(f"{asked}: at worst its gain times {figures}.", min(found.values()) >= 1.0 - _ROUNDING)

    def _worst(self, case: Stacked, outcome: Outcome) -> float:
        """Return the smallest ratio of our gain to theirs over the states that they reach."""
        posed, places = Posed(case, self.criterion), outcome.places
        pick = self.ours(posed)
        ratios = []
        for i, theirs in enumerate(places):
            taken = places[:i]
            mine = evaluator.gain(posed, taken, pick(taken))
            ratios.append(mine / evaluator.gain(posed, taken, theirs))
        return min(ratios)

    def _lower(self, case: Stacked) -> Verdict:
        mine = self._of("axiscal-together", case)
        asked = f"({case.letter}) J of our plan no higher than any other's"
        others = {r.key: self._of(r.key, case) for r in FIELD if not r.ours}
        values = {key: self._value(case, outcome) for key, outcome in others.items() if outcome is not None}
        if mine is None or not values:
            return Verdict(f"{asked}; there is nothing to compare.", None)
        best = min(values, key=lambda key: values[key])
        value = self._value(case, mine)
        text = f"{asked}: {value:.6g} against {values[best]:.6g} of {rival_of(best).label}."
        return Verdict(text, value <= values[best] * (1.0 + _ROUNDING))

    def _value(self, case: Stacked, outcome: Outcome) -> float:
        return evaluator.value(Posed(case, self.criterion), outcome.places)

    def _sooner(self, case: Stacked) -> Verdict:
        mine, theirs = self._of("axiscal-together", case), self._of("trieste", case)
        if case.letter in LONGEST:
            asked = f"({case.letter}) the whole plan in less than {LONGEST[case.letter]:.0f} s"
            if mine is None:
                return Verdict(f"{asked}; there is nothing to judge.", None)
            return Verdict(f"{asked}: {call_seconds(mine):.2f} s.", call_seconds(mine) < LONGEST[case.letter])
        asked = f"({case.letter}) the whole plan in less time than Trieste's picks one by one"
        if mine is None or theirs is None:
            return Verdict(f"{asked}; there is nothing to compare.", None)
        usual = call_seconds(theirs) * case.readings
        figures = f"{call_seconds(mine):.2f} s against {usual:.2f} s, without Trieste's first pick"
        text = f"{asked}: {figures} ({sum(theirs.processor[: case.readings]):.1f} s with it)."
        return Verdict(text, call_seconds(mine) < usual)

    def _listed(self, case: Stacked) -> Verdict:
        mine, theirs = self._of("axiscal-candidates", case), self._of("pyapprox", case)
        asked = f"({case.letter}) a pick from 2,000 candidates as fast as pyapprox's"
        if mine is None or theirs is None:
            return Verdict(f"{asked}; there is nothing to compare.", None)
        same = np.isclose(self._value(case, mine), self._value(case, theirs), rtol=1e-9)
        chosen = "with the same J" if same else "with another J"
        figures = f"{1e3 * call_seconds(mine):.2f} ms against {1e3 * call_seconds(theirs):.2f} ms, {chosen}"
        return Verdict(f"{asked}: {figures}.", call_seconds(mine) <= call_seconds(theirs))


def call_seconds(outcome: Outcome) -> float:
    """Return the median time of a call, s of the processor."""
    return statistics.median(outcome.processor)
