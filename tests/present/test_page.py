"""The report page: safe whatever the names are, self-contained, the same bytes again, and drawn by a real browser."""

from __future__ import annotations

import html
import re
from dataclasses import fields, is_dataclass, replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axiscal.answers.answer import NextStep, ResultAnswer
from axiscal.description.target import rows_of
from axiscal.errors.iso230 import words
from axiscal.estimation.promise.agreement import Agreement
from axiscal.language.spoken import LANGUAGES, speaking
from axiscal.machine import load_machine
from axiscal.present.rendering import groups, panel_figure, render
from axiscal.present.summary import (
    ConstantSummary,
    CurvePoint,
    CurveSummary,
    Finding,
    HistoryRow,
    Iso230,
    SetupUse,
    Summary,
    TableOffer,
    Uncertainty,
)
from tests.generators.answers import aim, answer, answer_row
from tests.web.browser import Browser

WORDS = 120
"""Of a first page before its picture."""
TRAVEL = {"C": (0.0, 360.0), "B": (-30.0, 110.0), "Y": (0.0, 500.0), "X": (0.0, 600.0), "Z": (0.0, 500.0)}
HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\"'`&{{ 7*7 }}\u2028javascript:alert(3)"


def _curve(name: str, axis: str, readings: int, rng: np.random.Generator) -> CurveSummary:
    """Return a smooth curve with a band around it and a few noisy readings."""
    low, high = TRAVEL[axis]
    unit, scale = ("urad", 20.0) if name[1] in "ABC" else ("um", 8.0)
    where = np.linspace(low, high, 61)
    truth = scale * np.sin(np.linspace(0, rng.uniform(3, 12), 61) + rng.uniform(0, 6))
    chosen = np.sort(rng.choice(61, readings, replace=False))
    noise = 0.06 * scale
    seen = truth[chosen] + noise * rng.standard_normal(readings)
    spread = scale * (0.1 + 0.08 * np.sin(np.linspace(0, 20, 61)))
    return CurveSummary(
        name=name,
        axis=axis,
        caption=words(name),
        position=where.tolist(),
        mean=(truth + 0.5 * spread).tolist(),
        std=np.hypot(spread, 0.1 * scale).tolist(),
        std_seen=spread.tolist(),
        prior_std=[scale] * 61,
        position_unit="deg" if axis in "BC" else "mm",
        value_unit=unit,
        truth=(where.tolist(), truth.tolist()),
        points=[
            CurvePoint(where[i], v, noise, "laser along X", 3 + n)
            for n, (i, v) in enumerate(zip(chosen, seen, strict=True))
        ],
    )


def _history(rng: np.random.Generator, readings: int) -> list[HistoryRow]:
    rows = [HistoryRow(0, None, None, None, None, None, 14.2, 31.0, 0.0)]
    for n in range(1, readings + 1):
        position = {axis: round(float(rng.uniform(*span)), 1) for axis, span in TRAVEL.items()}
        rms = 1.75 + 12.45 * float(np.exp(-n / 14))
        z = 7.3 if n == 31 else float(rng.standard_normal())
        rows.append(
            HistoryRow(
                reading=n,
                setup=f"set-up {n * 4 // (readings + 1) + 1}",
                position=position,
                value_um=float(rng.normal(0, 6)),
                innovation=2 * z,
                surprise=z,
                rms_um=rms,
                worst_um=1.9 * rms,
                minutes=0.7 * n + 12 * (1 + n * 4 // (readings + 1)),
                reason="7.3 standard deviations from what was expected." if n == 31 else "",
                approach="X+",
            )
        )
    return rows


def _answered(readings: int) -> ResultAnswer:
    built = load_machine("dmu60")
    rows = [answer_row(row, built, row.kind != "backlash") for row in rows_of(built)]
    steps = [NextStep(code="load", control="linuxcnc"), NextStep(code="verify")]
    return answer(verdict="reached", readings=readings, rows=rows, aims=[aim("rms", 1.93, 2.0, 1.0)], steps=steps)


def five_axis_summary(readings: int = 60) -> Summary:
    """Return a summary such as a five-axis campaign with a known truth produces."""
    rng = np.random.default_rng(7)
    names = [(f"E{d}{a}", a) for a in TRAVEL for d in "XYZABC"]
    curves = [_curve(name, axis, int(rng.integers(0, 12)), rng) for name, axis in names]
    places = {"A0B": "urad", "C0B": "urad", "A0C": "urad", "B0C": "urad", "C0Y": "urad", "B0Z": "urad", "A0Z": "urad"}
    places |= {"X0C": "um", "Y0C": "um", "X0B": "um", "Z0B": "um", "EXX_reversal": "um", "EYY_reversal": "um"}
    constants = [
        ConstantSummary(
            n,
            words(n),
            float(rng.normal(0, 12)),
            float(rng.uniform(0.5, 4)),
            20.0,
            u,
            n != "C0B",
        )
        for n, u in places.items()
    ]
    block = Iso230(
        axis="X",
        value_unit="um",
        figures={"A": 11.2, "A_up": 9.8, "E": 10.0, "R": 4.2, "B": 2.0, "B_mean": 2.0, "M": 8.1},
        uncertainties={"A": 1.1, "E": 0.9, "R": 0.7, "B": 0.4, "M": 0.6},
    )
    history = _history(rng, readings)
    return Summary(
        title="Calibration before the aerospace order",
        machine="Five-axis machine, 600 × 500 × 500",
        chain="w-C'-B'-b-Y-X-Z-t",
        campaign_file="campaign.toml",
        date="2026-03-14",
        setups=[
            SetupUse("set-up 1", "interferometer", "x", ("X",), "0.3 µm", 15),
            SetupUse("set-up 2", "straightedge", "y", ("X", "Z"), "0.5 µm", 15),
            SetupUse("set-up 3", "rtest", "x y z", ("B", "C"), "0.6 µm", 15),
            SetupUse("set-up 4", "level", "about x", ("X", "Y"), "1 µrad", 15),
        ],
        stopped_because="rms target reached",
        readings=readings,
        expanded=Uncertainty(3.3, (1.9, 1.8, 1.7), 6.1, 1.7, "for a tool of 120 mm"),
        minutes=history[-1].minutes,
        rms_um=history[-1].rms_um,
        worst_um=history[-1].worst_um,
        unseen_rms_um=0.82,
        history=history,
        answer=_answered(readings),
        curves=curves,
        constants=constants,
        observability=[
            "The constant part of EXX, EXY and EXZ cannot be told apart; a probe on a fixed ball would separate them."
        ],
        warnings=[Finding("prior-misfit", "EXX", "EXX, size: 2.4 times as large as stated or usual.")],
        tables=[
            TableOffer("LinuxCNC", {"x.comp": "X"}, "0.4 µm between its rows"),
            TableOffer("any", {"curves.csv": "all"}),
        ],
        target_rms_um=2.0,
        target_worst_um=4.0,
        iso230=[block],
        agreement=Agreement(60, 59, 1.03, 0.4),
        agreement_words="59 of 60 readings agree with the others",
        versions={"axiscal": "0.1.0", "numpy": "2.2.0"},
    )


def _with_every_text(value: Any, text: str) -> Any:
    """Return value with every piece of text in it replaced, keys of mappings included."""
    if isinstance(value, str):
        return text
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{f.name: _with_every_text(getattr(value, f.name), text) for f in fields(value)})
    if isinstance(value, dict):
        return {f"{text}{n}": _with_every_text(item, text) for n, item in enumerate(value.values())}
    if isinstance(value, list | tuple):
        return type(value)(_with_every_text(item, text) for item in value)
    return value


class _Page(HTMLParser):
    """The elements and attributes of a page, and the contents of its scripts."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str, str]] = []
        self.scripts: list[str] = []
        self.text: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]

    def handle_data(self, data: str) -> None:
        (self.scripts if self.tags and self.tags[-1] == "script" and data.strip() else self.text).append(data)


def _without_libraries(page: str) -> str:
    return page[: page.index("<script>")]


@pytest.fixture(scope="module")
def summary() -> Summary:
    return five_axis_summary()


@pytest.fixture(scope="module")
def page(summary: Summary) -> str:
    return render(summary)


HOSTILE_TEXTS = [
    HOSTILE,
    "\" onmouseover=\"alert(1) ]]><svg/onload=alert(1)> <a href='javascript:alert(1)'>x</a> <b>bold</b>%{x}$x^2$"
    "&lt;img src=x onerror=alert(1)&gt; \ud800 lone surrogate </style><style>@import url(http://x)</style>",
    "<!--<script>",
]
"""What is cut off by a comment would hide, so that one stands alone."""


@pytest.mark.parametrize("text", HOSTILE_TEXTS)
def test_no_text_can_become_markup_or_script(summary: Summary, page: str, text: str) -> None:
    """reliability.md 12: every text field holds an attack; the page must keep the elements and attributes it has."""
    attacked, honest = _Page(render(_with_every_text(summary, text))), _Page(page)
    assert set(attacked.tags) <= set(honest.tags)
    assert attacked.tags.count("script") == honest.tags.count("script") == 1
    assert attacked.tags.count("style") == 1
    assert {(tag, name) for tag, name, _ in attacked.attributes} <= {(tag, name) for tag, name, _ in honest.attributes}
    assert {value for _, name, value in attacked.attributes if name == "href"} <= {"#warnings"}


def test_the_hostile_text_is_still_shown(summary: Summary) -> None:
    shown = html.unescape(_without_libraries(render(_with_every_text(summary, HOSTILE))))
    assert HOSTILE in shown


@pytest.mark.parametrize("language", sorted(LANGUAGES))
def test_the_first_page_is_short(summary: Summary, language: str) -> None:
    with speaking(language):
        shown = render(summary)
    before = shown[shown.index("<header>") : shown.index('<div class="signs">')]
    text = html.unescape(re.sub(r"<svg.*?</svg>|<[^>]*>", " ", before, flags=re.DOTALL))
    assert sum(bool(re.search(r"[^\W\d_]{2}", word)) for word in text.split()) <= WORDS


def test_nothing_is_fetched(page: str) -> None:
    parsed = _Page(page)
    fetching = {"src", "srcset", "data", "action", "formaction", "background", "poster", "ping", "xlink:href"}
    fetching |= {"http-equiv"}
    assert {(tag, name) for tag, name, _ in parsed.attributes if name in fetching} == {("meta", "http-equiv")}
    assert not {"link", "iframe", "object", "embed", "img", "base", "form"} & set(parsed.tags)
    assert not re.search(r"https?:|@import|url\(", _without_libraries(page))


def test_policy_lets_only_these_scripts_run(page: str) -> None:
    (policy,) = (
        v for tag, name, v in _Page(page).attributes if tag == "meta" and name == "content" and "default-src" in v
    )
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    assert "unsafe-inline" not in policy.split("style-src")[0]
    assert "http" not in policy


def test_bands_are_196_standard_deviations_around_the_mean(summary: Summary) -> None:
    curve = summary.curves[0]
    whole, seen = panel_figure(curve, [-50.0, 50.0], 200)["data"][1:3]
    for trace, std in ((whole, curve.std), (seen, curve.std_seen)):
        upper = np.array(trace["y"][:61])
        lower = np.array(trace["y"][61:][::-1])
        np.testing.assert_allclose((upper + lower) / 2, curve.mean, rtol=1e-4, atol=1e-4)
        np.testing.assert_allclose((upper - lower) / 2, 1.959964 * np.array(std), rtol=1e-3)


def test_panels_of_one_row_share_their_scale_and_hold_everything(summary: Summary) -> None:
    panels = [panel for _, _, rows in groups(summary.curves[:3]) for row in rows for panel in row]
    (shared,) = {tuple(figure["layout"]["yaxis"]["range"]) for _, figure in panels}
    for curve in summary.curves[:3]:
        assert shared[0] < min(m - 1.96 * s for m, s in zip(curve.mean, curve.std, strict=True))
        assert shared[1] > max(m + 1.96 * s for m, s in zip(curve.mean, curve.std, strict=True))


def test_the_page_is_light(page: str) -> None:
    """A report of thirty curves and many readings can be mailed, and is drawn before any script runs."""
    assert len(page.encode()) < 1e6
    assert len(render(five_axis_summary(600)).encode()) < 1e6


@pytest.mark.chromium
@pytest.mark.parametrize("text", [None, HOSTILE])
def test_a_browser_shows_the_page_without_an_error(
    browser: Browser, summary: Summary, tmp_path: Path, text: str | None
) -> None:
    shown = summary if text is None else _with_every_text(summary, text)
    file = tmp_path / "report.html"
    file.write_text(render(shown), encoding="utf-8")
    drawn, errors = browser.drawn(file.as_uri())
    assert errors == []
    assert drawn.count('class="picture"') >= len(summary.curves)


@pytest.mark.chromium
@pytest.mark.parametrize("width", [1400, 768, 390])
def test_nothing_is_cut_and_no_words_lie_on_each_other(browser: Browser, page: str, tmp_path: Path, width: int) -> None:
    found = _laid_out(browser, page, tmp_path, width)
    assert found == {"width": width, "beyond": [], "overlapping": [], "cut": [], "holes": []}


@pytest.mark.chromium
def test_the_layout_check_notices_what_is_wrong(browser: Browser, page: str, tmp_path: Path) -> None:
    broken = page.replace("</main>", '<div style="width: 3000px; margin-top: 300px">x</div></main>')
    tick = re.search("<text [^>]*>", page)
    assert tick is not None
    twice = broken.replace(tick[0], f"{tick[0]}lies on the other</text>{tick[0]}", 1)
    found = _laid_out(browser, twice, tmp_path, 1400)
    assert found["beyond"]
    assert found["overlapping"]
    assert found["holes"]


_MEASURE = """(() => {
// Strips of the page, as wide as it is and higher than a heading with the room around it, where nothing stands.
function holes() {
  const seen = (each) => each.checkVisibility(), words = [];
  const drawn = [...document.querySelectorAll("main svg, main canvas, main table, main button")].filter(seen);
  const walk = document.createTreeWalker(document.querySelector("main"), NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const range = document.createRange();
    const node = walk.currentNode;
    range.selectNodeContents(node);
    if (node.textContent.trim() && seen(node.parentElement)) words.push(...range.getClientRects());
  }
  const boxes = [...drawn.map((each) => each.getBoundingClientRect()), ...words].filter((box) => box.height > 0);
  boxes.sort((one, other) => one.top - other.top);
  const found = [];
  let below = boxes[0].bottom;
  for (const box of boxes) {
    if (box.top - below > 120) found.push(Math.round(below) + " to " + Math.round(box.top));
    below = Math.max(below, box.bottom);
  }
  return found;
}
  const inner = document.documentElement.clientWidth, found = {width: innerWidth, beyond: [], overlapping: [], cut: []};
  found.holes = holes();
  for (const each of document.querySelectorAll("main *")) {
    const box = each.getBoundingClientRect();
    if (each.closest(".scroll") && !each.matches(".scroll")) continue;
    if (box.width && (box.right > inner + 1 || box.left < -1)) found.beyond.push(each.tagName + " " + each.className);
    if (each.clientWidth && each.scrollWidth > each.clientWidth + 1 && getComputedStyle(each).overflowX === "hidden")
      found.cut.push(each.tagName + " " + each.textContent.slice(0, 40));
  }
  for (const svg of document.querySelectorAll("svg.picture")) {
    const boxes = [...svg.querySelectorAll("text")].map((t) => [t.textContent, t.getBoundingClientRect()])
      .filter(([, box]) => box.width > 0);
    boxes.forEach(([text, a], i) => {
      for (const [other, b] of boxes.slice(i + 1))
        if (Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 &&
            Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 3)
          found.overlapping.push(svg.getAttribute("aria-label") + ": " + text + " | " + other);
    });
  }
  return found;
})()"""


def _laid_out(browser: Browser, page: str, folder: Path, width: int) -> dict[str, Any]:
    """Return what lies beyond the page or on something else, as the browser lays it out at a width."""
    (folder / "report.html").write_text(page, encoding="utf-8")
    shown = browser.page(width, 900)
    shown.open((folder / "report.html").as_uri())
    found: dict[str, Any] = shown.value(_MEASURE)
    return found
