"""Words of a drawing: where each lies, by a width of letters of the tests' own, and which lie over another."""

from __future__ import annotations

import itertools
from typing import NamedTuple
from xml.etree import ElementTree


class Box(NamedTuple):
    """What is covered, pixels."""

    left: float
    top: float
    right: float
    bottom: float

    def over(self, other: Box) -> bool:
        """Return whether both cover a place."""
        across = min(self.right, other.right) - max(self.left, other.left)
        return across > 0 and min(self.bottom, other.bottom) - max(self.top, other.top) > 0


def boxes_of(drawing: ElementTree.Element) -> list[tuple[str, Box]]:
    """Return the words of a drawing with what each covers."""
    found = []
    for text in (each for each in drawing.iter() if each.tag.rpartition("}")[2] == "text"):
        words, size = text.text or "", float(text.get("font-size", "0"))
        assert size in (14.0, 16.0)
        x, y = float(text.get("x", "0")), float(text.get("y", "0"))
        wide = (0.55 if text.get("font-weight") else 0.5) * size * len(words)
        left = x - {"start": 0.0, "middle": wide / 2, "end": wide}[text.get("text-anchor", "start")]
        found.append((words, Box(left, y - 0.7 * size, left + wide, y)))
    return found


def held_inside(covered: list[tuple[str, Box]], width: float, height: float) -> None:
    """Fail unless all words are inside of a drawing, and none lies over another."""
    for words, box in covered:
        assert -0.5 <= box.left <= box.right <= width + 0.5, words
        assert 0 <= box.top < box.bottom <= height, words
    assert [(one, other) for (one, a), (other, b) in itertools.combinations(covered, 2) if a.over(b)] == []
