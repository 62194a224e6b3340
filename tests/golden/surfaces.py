"""Surfaces that show an answer, read back: the first line, the rows as cells, the sentences below them."""

import math
import re
import shutil
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import pytest

Row = Mapping[str, Any]
"""A row of a document: of `result.json`, of `status --json`, of the page's state."""
_NEXT = ("Next", "Report", "No table for", "Weiter", "Bericht", "Keine Tabelle für")


class Shown(NamedTuple):
    """first : without spaces; cells : of each line of the table, its heading first; below : sentences, no spaces"""

    first: str
    cells: list[list[str]]
    below: str


def plain(text: str) -> str:
    """Return a text with one spelling of units, and no space."""
    return re.sub(r"[\s\u00a0\u202f]", "", text).replace("µ", "u").replace("μ", "u")


def of_screen(text: str) -> Shown:
    """Return what a terminal shows."""
    lines = text.splitlines()
    end = next((n for n, line in enumerate(lines) if line.startswith(_NEXT)), len(lines))
    first = 2 if len(lines) > 1 and lines[1].startswith("  ") and lines[1][2] != " " and "±" not in lines[1] else 1
    table = first
    while table < end and lines[table].startswith("  "):
        table += 1
    return Shown(plain("".join(lines[:first])), _columns(lines[first:table]), plain("".join(lines[table:end])))


def of_paper(path: Path, page: int | None = None) -> str:
    """Return what a PDF says, or one page of it, without spaces."""
    return plain(lines_of(path, page))


def words_of(path: Path, page: int) -> list[str]:
    """Return the words on a page of a PDF, without numbers and units."""
    return re.findall(r"[^\W\d_]{2,}", lines_of(path, page))


def lines_of(path: Path, page: int | None = None) -> str:
    """Return what a PDF says, or one page of it, as its lines are laid out."""
    if shutil.which("pdftotext") is None:
        pytest.skip("needs Debian's poppler-utils")
    pages = [] if page is None else ["-f", f"{page}", "-l", f"{page}"]
    command = ["pdftotext", "-layout", *pages, str(path), "-"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


class Printed(NamedTuple):
    """A number as it is printed.  half : of its last digit, by which it may be off"""

    value: float
    half: float


class Redone(NamedTuple):
    """What a statement of uncertainty says of u, U and k, beside its parts."""

    parts: list[Printed]
    u: Printed
    k: Printed
    expanded: Printed

    @property
    def faults(self) -> list[str]:
        """What whoever redoes it with a pocket calculator finds otherwise than rounding allows."""
        u = math.sqrt(sum(part.value**2 for part in self.parts))
        off = sum(part.value * part.half for part in self.parts) / u + self.u.half
        found = [] if abs(u - self.u.value) <= off else [f"u: {u} instead of {self.u.value}"]
        expanded = self.k.value * self.u.value
        off = self.k.value * self.u.half + self.u.value * self.k.half + self.expanded.half
        return (
            found
            if abs(expanded - self.expanded.value) <= off
            else [*found, f"U: {expanded} instead of {self.expanded.value}"]
        )


def redone(sources: Sequence[Sequence[str]], total: str) -> Redone:
    """Return what is printed of sources, of which u is the cell before the last, and of their sum."""
    u, k, again, expanded = _all_printed(total)
    assert u == again
    return Redone([each for source in sources for each in _all_printed(source[-2])], u, k, expanded)


def statement_of(path: Path) -> Redone | None:
    """Return what the second page of a report says of its sources of uncertainty; None where it says nothing."""
    text = re.sub("[\u00a0\u202f]", " ", lines_of(path, 2))
    total = re.search(r"u = √.*", text)
    sources = re.findall(r"([\d.,]+ µm) +([\d.,]+ %)$", text, re.MULTILINE)
    return None if total is None else redone(sources, total[0])


def _all_printed(text: str) -> list[Printed]:
    """Return the numbers of a text, in either language."""
    found = re.findall(r"\d+(?:[.,]\d+)?", plain(text))
    assert "×" not in text
    return [
        Printed(float(each.replace(",", ".")), 0.5 * 10.0 ** -len(each.replace(",", ".").partition(".")[2]))
        for each in found
    ]


def of_state(answer: Row) -> Shown:
    """Return what the operator's page shows of its state."""
    return Shown(plain("".join(answer["first"])), answer["rows"], plain("".join(answer["sentences"])))


def written_screens(text: str) -> Iterator[tuple[str, Shown]]:
    """Yield the folder of each results that commands wrote, and the screen that they ended with."""
    for block in text.split("$ axiscal "):
        command, _, said = block.partition("\n")
        out = re.match(r"(?:estimate|finish|run) .*--out (\S+)(?!.*--details)", command)
        screen = said.partition("--- stdout\n")[2].partition("\n--- stderr")[0].partition("\nstatus ")[0]
        if out and "±" in screen:
            yield out[1], of_screen(screen)


def differing(shown: Shown, rows: Sequence[Row], answer: Mapping[str, Any]) -> Iterator[str]:
    """Yield the cells and the first line of a surface where they do not show the figures of a document."""
    wanted = _wanted(rows, shown.cells) if shown.cells else []
    if len(wanted) != max(len(shown.cells) - 1, 0) or bool(wanted) != any(row["measured"] for row in rows):
        yield f"{len(shown.cells) - 1} lines of {len(wanted)}"
    for (_, *cells), figures in zip(shown.cells[1:], wanted, strict=False):
        for cell, values in zip(cells, figures, strict=True):
            if isinstance(values, Signed):
                yield from values.differing(cell)
                continue
            found = numbers(cell)
            several = values[: max(len(found), 1)] if "-" not in cell else values  # ends of a range that look alike
            if len(found) != len(several) or not all(map(_is_shown, several, found)):
                yield f"{cell}: {values}"
    sizes = [answer["readings"], answer["more"], *(aim[name] for aim in answer["aims"] for name in ("now", "limit"))]
    whole = [max(answer["minutes"], 1.0), max(answer["more_minutes"], 1.0), *range(len(answer["aims"]) + 1)]
    for number in numbers(shown.first):
        if not any(_is_shown(size, number) for size in sizes) and number not in map(round, whole):
            yield f"{shown.first}: {number}"


class Signed(list[Row]):
    """Numbers of rows that have a sign."""

    def differing(self, cell: str) -> Iterator[str]:
        """Yield the cell where it does not show them: rounded to a sixth of U, alone several with U of each."""
        words = [word.rstrip(",;") for word in cell.split()]
        told = [(before, _number(word)) for before, word in pairwise(["", *words]) if re.match(r"[+−]?[0-9]", word)]
        bands = [size for before, size in told if before == "±"]
        sizes = [size for before, size in told if before != "±"]
        near = [abs(size - each["value"]) <= each["U"] / 6 for size, each in zip(sizes, self, strict=False)]
        known = [abs(band - each["U"]) <= each["U"] / 6 for band, each in zip(bands, self, strict=False)]
        if len(sizes) != len(self) or len(bands) not in (0, len(self)) or not all([*near, *known]):
            yield f"{cell}: {list(self)}"


def _wanted(rows: Sequence[Row], lines: Sequence[Sequence[str]]) -> list[list[list[float] | Signed]]:
    """Return the figures of each line of a table by the rows of a document: found, known to, and left by each control.

    lines : of the table, which says how rows stand together, and which controls it has room for
    """
    measured = [row for row in rows if row["measured"]]
    groups = [[row] for row in measured] if len(lines) - 1 == len(measured) else list(_by_kind(measured))
    if 0 < len(lines) - 1 < len(groups):
        groups = [*groups[: len(lines) - 2], groups[-1]]
    offered = {name for row in measured for name in row["left"]}
    controls = [name.rpartition(" ")[2] for name in lines[0][3:]]
    assert bool(controls) == bool(offered)
    return [_figures(group, controls) for group in groups]


def numbers(cell: str) -> list[float]:
    """Return the numbers of a cell, or of a line without spaces."""
    return [float(each.replace(",", ".")) for each in re.findall(r"\d+(?:[.,]\d+)?", cell)]


def _number(word: str) -> float:
    return float(word.replace(",", ".").replace("−", "-"))


def _is_shown(value: float, number: float) -> bool:
    """Return whether a value is shown by a number of two or of three digits; on their edge processors differ."""
    near = (value * turn for turn in (1 - 3e-5, 1.0, 1 + 3e-5))
    return any(abs(float(f"{each:.{digits}e}") - number) < 1e-9 * (1 + number) for each in near for digits in (1, 2))


def _figures(rows: Sequence[Row], controls: Sequence[str]) -> list[list[float] | Signed]:
    """Return the figures of a line: the range found, the largest U with a limit, the largest that is left."""
    sizes = [row["found"] for row in rows]
    signed = Signed(each for row in rows for each in row.get("signed", []))  # none in a document of an earlier version
    found: list[float] | Signed = signed or [min(sizes), max(sizes)]
    worst = max(rows, key=lambda row: float(row["known_to"]))
    limit = [worst["limit"]] if len(rows) == 1 and worst["limit"] is not None else []
    lefts = [[row["left"][name] for row in rows if name in row["left"]] for name in controls]
    return [found, [worst["known_to"], *limit], *([max(left)] if left else [] for left in lefts)]


def _by_kind(rows: Sequence[Row]) -> Iterator[list[Row]]:
    for kind in dict.fromkeys((row["kind"], row["unit"]) for row in rows):
        yield [row for row in rows if (row["kind"], row["unit"]) == kind]


def _columns(lines: Sequence[str]) -> list[list[str]]:
    """Return the cells of lines whose columns are set off by two spaces, an empty name before those of the heading."""
    split = [re.split(r" {2,}", line.strip()) for line in lines if line.strip()]
    return [["", *split[0]], *split[1:]] if split else []
