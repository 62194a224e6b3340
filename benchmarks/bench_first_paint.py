"""How soon report and operator's page are there in Debian's Chromium, how large they are, and whether anything moves.

    python -m benchmarks.bench_first_paint

The report is that of the demo's campaign (axiscal demo), opened from the disk; the page is served for a campaign that
has just begun on the five-axis machine of the demo. The first paint with content is the browser's own figure,
the median of five, each in a window of its own; shifts are the sum of its layout-shift scores while the report is
scrolled to its end.
"""

from __future__ import annotations

import statistics
from importlib import resources
from pathlib import Path
from tempfile import TemporaryDirectory

from axiscal.cli.app import run
from tests.web.browser import Browser
from tests.web.served import served, started

TIMES = 5
SIZES = {"screen": (1400, 900), "tablet": (768, 1024), "telephone": (390, 844)}
_PAINTED = "performance.getEntriesByName('first-contentful-paint').map((entry) => entry.startTime)[0] ?? null"
_WATCH = """window.moved = 0;
new PerformanceObserver((list) => { for (const each of list.getEntries()) window.moved += each.value; })
  .observe({ type: "layout-shift", buffered: true });"""
_SCROLL = """(async () => {
  for (let top = 0; top < document.documentElement.scrollHeight; top += 400) {
    window.scrollTo(0, top);
    await new Promise((done) => requestAnimationFrame(done));
  }
  return window.moved;
})()"""


def painted(browser: Browser, address: str, size: tuple[int, int]) -> float:
    """Return the median time to the first paint with content, ms."""
    found = []
    for _ in range(TIMES):
        page = browser.page(*size)
        page.open(address)
        page.until(f"({_PAINTED}) !== null")
        found.append(float(page.value(_PAINTED)))
    return statistics.median(found)


def moved(browser: Browser, address: str, size: tuple[int, int]) -> float:
    """Return the sum of layout shifts while a page is scrolled to its end; 0 is none."""
    page = browser.page(*size)
    page.open(address)
    page.value(_WATCH)
    return float(page.value(_SCROLL))


def asking(browser: Browser, address: str, size: tuple[int, int]) -> float:
    """Return the median time until the operator's page shows where to go, ms; up to 30 ms too long."""
    found = []
    for _ in range(TIMES):
        page = browser.page(*size)
        page.open(address)
        page.until("document.getElementById('count').textContent !== '–'")
        found.append(float(page.value("performance.now()")))
    return statistics.median(found)


def demo_campaign() -> str:
    """Return the demo's campaign.toml."""
    return resources.files("axiscal.present.demo").joinpath("campaign.toml").read_text(encoding="utf-8")


def main() -> None:
    """Print the table."""
    with TemporaryDirectory() as name, Browser(Path(name)) as browser:
        folder = Path(name)
        run(["demo", "--out", str(folder / "demo")])
        report = folder / "demo" / "report.html"
        print(f"report of the demo: {report.stat().st_size / 1e6:.2f} MB (asked: less than 1 MB)")
        for size, pixels in SIZES.items():
            first, shift = (how(browser, report.as_uri(), pixels) for how in (painted, moved))
            print(f"  {size:9} first paint {first:4.0f} ms (asked: 1000 ms), shifts while scrolling {shift:.3f}")
        with served(started(folder, demo_campaign())) as running:
            for size, pixels in SIZES.items():
                first, asked = painted(browser, running.address, pixels), asking(browser, running.address, pixels)
                print(
                    f"page, {size:9} first paint {first:4.0f} ms, the point to go to {asked:4.0f} ms (asked: 1000 ms)"
                )


if __name__ == "__main__":
    main()
