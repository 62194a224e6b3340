"""The tour of the documentation: a virtual lathe and a laser on the page, from the first question to the results.

python -m tests.docs.tour         # makes its pictures anew
"""

from pathlib import Path
from tempfile import TemporaryDirectory

from tests.docs.howtos import DOCS
from tests.web.browser import Browser, Page
from tests.web.served import Served, served
from tests.web.test_page import SHOWN, stood
from tests.web.test_start import Person, arrived

_WIDTH = 1120


def _kept(page: Page, name: str) -> None:
    """Keep what the page looks like once its drawing is there."""
    page.until(f"!{SHOWN}('machine-drawing') || document.querySelector('#machine-drawing img').naturalWidth > 200")
    page.picture(DOCS / "pictures" / f"tour-{name}.png")


def _read(person: Person, server: Served) -> None:
    """Type what the virtual machine's instrument shows, reading after reading, until there is none."""
    seen = " || ".join(f"{SHOWN}('{name}') && '{name}'" for name in ("stands", "field", "finish"))
    page, number = person.page, 0
    while (shown := page.until(seen)) != "finish":
        if shown == "stands":
            person.mount()
            continue
        number += 1
        person.type(server.state()["shows"])
        kept = f"!document.getElementById('count').textContent.startsWith('reading {number} ')"
        if page.until(f"{kept} ? 'kept' : {SHOWN}('doubt') && 'doubt'") == "doubt":  # any machine may surprise
            person.press("really so")
            page.until(kept)


def main() -> None:
    """Take the tour."""
    folders = TemporaryDirectory(), TemporaryDirectory()
    with folders[0] as profile, folders[1] as job, served(Path(job)) as server, Browser(Path(profile)) as browser:
        _toured(arrived(browser, server, _WIDTH), server)


def _toured(person: Person, server: Served) -> None:
    """Keep a picture of each screen."""
    page = person.page
    _kept(page, "start")
    for words in ("Virtual machine", "lathe"):
        person.press(words)
    person.sees("X, the radius")
    _kept(page, "machine")
    for words in ("Next", "laser"):
        person.press(words)
    person.until("positioning Z", there=True)
    _kept(page, "instruments")
    person.press("Plan")
    page.until("document.getElementById('buying').offsetParent !== null")
    _kept(page, "plan")
    for words in ("Begin", "It stands"):
        person.press(words)
    _kept(page, "test-of-sign")
    stood(page)
    _read(person, server)
    person.press("End the campaign")
    person.sees("Report to sign (PDF)")
    _kept(page, "results")


if __name__ == "__main__":
    main()
