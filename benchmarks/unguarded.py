"""What becomes of promises whose readings nobody chose for what they can vouch for.

    python -m benchmarks.unguarded [MACHINES]

Plans by the criteria `joint` and `worst` (an axis, two axes), and a plane error whose std is stated or learnt, at
planned, even and random places; each with departures put in. Six machines of each unless said, or eight of a plane's.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread
from benchmarks.trust import benches
from benchmarks.trust.attack_table import beginning_with
from benchmarks.trust.attacks import ATTACKS, Attack, Outcome, outcome

_FIRST = 40_261_200
_HEAD = (
    "| read | put in | machines | ratio, geometric mean | largest | verdicts | silent |\n|---|---|---|---|---|---|---|"
)
_USUAL, _OF_PLANES = 6, 8
_PLANE = 'EZXY = { std = "STD", length = "150 mm", knots = 5, rest = "0.3 um" }\n'
_BY_CRITERION = ("nothing", "step", "bump", "drift, 10", "pitch of 10 mm", "two axes: nothing", "two axes: twist")


def _round(width: float) -> Callable[[Array, Array, float], Array]:
    def hump(x: Array, _sides: Array, c: float) -> Array:
        square = (x[:, 0] - 0.4 * c) ** 2 + (x[:, 1] - 0.4 * (1 - c)) ** 2
        return np.asarray(12 * np.exp(-square / width**2), dtype=float)

    return hump


def _named(words: str) -> Attack:
    return next(each for each in ATTACKS if each.words.startswith(words))


PLANES = (
    Attack("nothing", bench="plate"),
    Attack("step along X, 15 µm", field=lambda x, s, c: np.where(x[:, 0] > 0.4 * c, 15.0, 0.0), bench="plate"),
    Attack("round bump of 30 mm, 12 µm", field=_round(0.03), bench="plate"),
    Attack("round bump of 80 mm, 12 µm", field=_round(0.08), bench="plate"),
    Attack("ridge of 30 mm, 12 µm", field=lambda x, s, c: _ridge(x[:, 0] - 0.4 * c), bench="plate"),
    Attack("drift, 10 µm", shown=_named("drift, 10").shown, bench="plate"),
    Attack("one bad reading, 8 µm", shown=_named("one bad").shown, bench="plate"),
    Attack(
        "diagonal step, 15 µm", field=lambda x, s, c: np.where(x[:, :2].sum(axis=1) > 0.8 * c, 15.0, 0.0), bench="plate"
    ),
)


def _ridge(away: Array) -> Array:
    return np.asarray(12 * np.exp(-((away / 0.03) ** 2)), dtype=float)


def _row(read: str, attack: Attack, found: list[Outcome]) -> str:
    ratios = np.array([each.ratio for each in found])
    words = ", ".join(f"{count} {word}" for word, count in sorted(Counter(each.word for each in found).items()))
    sizes = f"{np.exp(np.mean(np.log(ratios))):.2f} | {ratios.max():.2f}"
    return f"| {read} | {attack.words} | {len(found)} | {sizes} | {words} | {sum(each.silent for each in found)} |"


def _by_criterion(machines: int) -> Iterator[str]:
    usual = benches._USUAL
    for criterion in ("joint", "worst"):
        benches._USUAL = (*usual, ("[target]", f'[target]\ncriterion = "{criterion}"'))
        benches.case_of.cache_clear()
        benches._planned.cache_clear()
        for number in beginning_with(_BY_CRITERION):
            found = [outcome(ATTACKS[number], "planned", "stated", _FIRST + index) for index in range(machines)]
            yield _row(f"planned by `{criterion}`", ATTACKS[number], found)
    benches._USUAL = usual


def _of_planes(machines: int) -> Iterator[str]:
    plate = benches.BENCHES["plate"]
    benches.BENCHES["plate"] = replace(plate, machine=plate.machine + _PLANE)
    benches.case_of.cache_clear()
    benches._planned.cache_clear()
    for scales, places in ((s, p) for s in benches.PRIORS for p in benches.PLACES):
        for attack in PLANES:
            found = [outcome(attack, places, scales, _FIRST + index) for index in range(machines)]
            yield _row(f"{places}, plane {'stated' if scales == 'stated' else 'learnt'}", attack, found)


@one_thread()
def main() -> None:
    """Print the table."""
    given = int(sys.argv[1]) if len(sys.argv) > 1 else None
    sys.stdout.write(_HEAD + "\n")
    for lines in (_by_criterion(given or _USUAL), _of_planes(given or _OF_PLANES)):
        for line in lines:
            sys.stdout.write(line + "\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
