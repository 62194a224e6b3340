"""A row of a table for each animal."""

from __future__ import annotations

from tests.zoo.animals import Judged

HEAD = f"{'animal':50s} {'seed':>4s} {'kept':>7s} {'inside':>7s} {'U um':>9s} {'true 95 %':>9s}  holds\n"


def row(found: Judged) -> str:
    """Return what became of one animal in a line."""
    kept = "–" if found.kept is None else f"{found.kept.share:.1%}"
    how = found.interval
    figures = f"{'–':>7s} {'–':>9s} {'–':>9s}" if how is None else f"{how.inside:7.1%} {how.half:9.3g} {how.far:9.3g}"
    ends = "named" if found.named else "yes" if found.holds else "NO, withheld" if how is None else "NO"
    return f"{found.animal.name:50s} {found.seed:4d} {kept:>7s} {figures}  {ends}"
