"""Sizes that the readings say are far from what was stated beforehand."""

from __future__ import annotations

from collections.abc import Iterator

from axiscal.estimation.estimation import Estimation
from axiscal.language.spoken import later, said
from axiscal.promise.sizes import Kind
from axiscal.report.summary import Finding

_FAR = 3.0
"""Factor from which on a size is not as stated."""
_WORDS: dict[Kind, str] = {
    "std": later("size"),
    "length": later("length over which it varies"),
    "rest": later("detail"),
    "reversal": later("reversal"),
    "together": later("what two axes do together"),
    "drift": later("drift of the zero"),
    "cycle": later("coming and going of the zero"),
    "growth": later("growth while it was read"),
    "noise": later("noise"),
}


def learnt_sizes(estimation: Estimation) -> Iterator[Finding]:
    """Yield a sentence for each group of alike sizes that readings find far from what was stated."""
    found = estimation.posterior
    if found is None:
        return
    for size in estimation.stated.sizes.of:
        times = found.sizes[size.kind, size.owners[0]]
        if not 1 / _FAR < times < _FAR:
            text = "{names}, {what}: {times:.2g} times as large as stated or usual."
            names = ", ".join(size.owners)
            owner = size.owners[0] if size.owners[0] in estimation.case.errors.names and len(size.owners) == 1 else None
            yield Finding("prior-misfit", owner, said(text, names=names, what=said(_WORDS[size.kind]), times=times))
