"""The page in Debian's Chromium: a campaign by keyboard alone, at three sizes, nothing cut and nothing overlapping."""

from pathlib import Path

import pytest

from tests.generators.texts import FOUR_READINGS
from tests.web.browser import Browser, Page
from tests.web.served import Served, kept, served, serving, started

SIZES = [(390, 844), (768, 1024), (1400, 900)]
HOSTILE = "<img src=x onerror=alert(1)>\"&'</script><svg/onload=alert(2)>"
SHOWN = "(id => document.getElementById(id)?.checkVisibility() ?? false)"
FAULTS = """(() => {
  const found = [], width = document.documentElement.clientWidth;
  if (document.documentElement.scrollWidth > width) found.push("the page is wider than the window");
  const shown = [...document.querySelectorAll("button,input,h1,h2,p,dd,dt,td,label,li,figcaption,svg,#unit")]
    .filter(e => e.checkVisibility())
    .filter(e => e.textContent.trim() || e.matches("input,svg"));
  const name = e => `${e.tagName} ${e.id} "${e.textContent.trim().slice(0, 30)}"`;
  for (const e of shown) {
    const box = e.getBoundingClientRect();
    if (box.left < -0.5 || box.right > width + 0.5) found.push(`outside: ${name(e)}`);
    if (!e.matches("svg,input") && e.scrollWidth > e.clientWidth + 1 && e.clientWidth) found.push(`cut: ${name(e)}`);
  }
  for (let a = 0; a < shown.length; a += 1) for (let b = a + 1; b < shown.length; b += 1) {
    if (shown[a].contains(shown[b]) || shown[b].contains(shown[a])) continue;
    const one = shown[a].getBoundingClientRect(), two = shown[b].getBoundingClientRect();
    const across = Math.min(one.right, two.right) - Math.max(one.left, two.left);
    const down = Math.min(one.bottom, two.bottom) - Math.max(one.top, two.top);
    if (across > 1 && down > 1) found.push(`overlapping: ${name(shown[a])} and ${name(shown[b])}`);
  }
  for (const text of document.querySelectorAll("figure svg text")) {
    const box = text.getBoundingClientRect(), whole = text.ownerSVGElement.getBoundingClientRect();
    const [left, right] = [box.left - whole.left, whole.right - box.right];
    if (Math.min(left, right, box.top - whole.top, whole.bottom - box.bottom) < -1)
      found.push(`cut in the picture: ${text.textContent}`);
  }
  return found;
})()"""
STRANGE = 'img:not([data-path^="/setup.svg?"])'
"""Pictures that are not the one of the set-up."""


def focus(page: Page) -> str:
    """Return the name of what has the focus."""
    return str(page.value("document.activeElement.id"))


def tab_to(page: Page, goal: str, *keys: str) -> None:
    """Press Tab until the focus is there, then other keys."""
    for _ in range(20):
        if focus(page) != goal:
            page.press("Tab")
    assert focus(page) == goal, f"no way to {goal} by keyboard; at {focus(page)}"
    for key in keys:
        page.press(key)


def looked_at(page: Page) -> None:
    """Check what is shown at every size, light and dark, and that everything that can be pressed has a name."""
    for width, height in SIZES:
        page.resize(width, height)
        assert page.value(FAULTS) == [], (width, height)
    for dark in (True, False):
        page.shade(dark=dark)
        assert page.broken_rules() == [], dark  # contrast is one of them
    nodes = page.call("Accessibility.getFullAXTree")["nodes"]
    pressed = [n for n in nodes if n.get("role", {}).get("value") in ("button", "textbox", "link", "image")]
    assert pressed
    assert [n for n in pressed if not n.get("ignored") and not n.get("name", {}).get("value")] == []


def type_reading(page: Page, text: str) -> None:
    """Type a reading with Enter behind it, as soon as it is asked for."""
    page.until("document.activeElement.id === 'field' && document.getElementById('field').value === ''")
    number = page.value("document.getElementById('count').textContent")
    page.enter(text)
    page.until(f"document.getElementById('count').textContent !== '{number}'")


def arrived(page: Page, server: Served) -> None:
    """Open the page and wait for the first set-up to be asked for."""
    page.open(server.address)
    page.until("document.activeElement.id === 'stands'")


def stand(page: Page, warm: str = "") -> None:
    """Say that the laser stands and follows a jog, and how warm the scale is."""
    page.press("Enter")
    stood(page, warm)


def stood(page: Page, warm: str = "") -> None:
    """Type what the display shows after the jog that is asked for, and how warm the scale is."""
    page.until("['jogged', 'field', 'sentence'].includes(document.activeElement.id)")
    if focus(page) == "jogged":  # another window may have tested it
        jogged = page.value("document.getElementById('jog-words').textContent")
        page.enter("-100" if " -0.100" in jogged else "100")
        page.until("document.getElementById('jogged').value === ''")
    if focus(page) == "sentence":
        page.enter(warm)


@pytest.mark.chromium
@pytest.mark.long
def test_a_whole_campaign_by_keyboard_alone(browser: Browser, tmp_path: Path) -> None:
    record = started(tmp_path)
    page = browser.page(1400, 900)
    with served(record) as server:
        arrived(page, server)
        assert server.token not in page.value("location.href + document.referrer + document.cookie")
        looked_at(page)
        stand(page, "21.4")
        page.until("document.getElementById('due').textContent.startsWith('temperature 21.4 °C')")
        type_reading(page, "-1,7")
        page.until("/-1.70 µm.*[0-9:]{8}/.test(document.getElementById('latest').innerText.replace('−', '-'))")
        looked_at(page)
        page.enter("400")
        page.until(f"{SHOWN}('doubt')")
        looked_at(page)
        assert focus(page) == "reread"
        page.press("Enter")
        assert (focus(page), kept(record)) == ("field", [-1.7])
        page.enter("0.5")
        page.until("document.getElementById('count').textContent === 'reading 3 of 4'")
        tab_to(page, "undo", "Enter")
        page.until("document.getElementById('count').textContent === 'reading 2 of 4'")
        assert kept(record) == [-1.7]
        tab_to(page, "further", "Enter")
        tab_to(page, "skip", "Enter")
        page.until("document.activeElement.id === 'reason'")
        looked_at(page)
        page.enter("the beam is blocked")
        page.until("document.getElementById('heard').textContent.startsWith('Skipped')")
        tab_to(page, "note", "Enter")
        page.until("document.activeElement.id === 'sentence'")
        looked_at(page)
        page.enter("21.8 °C")
        page.until("document.getElementById('due').textContent.startsWith('temperature 21.8 °C')")
        page.until("document.activeElement.id === 'field'")
        tab_to(page, "stop", "Enter")
        page.until("document.getElementById('stop-words').textContent.startsWith('Now ')")
        looked_at(page)
        assert focus(page) == "not-stop"
        page.press("Enter")
        for text in ("0.4", "1.1", "0.2"):
            type_reading(page, text)
        page.until("document.activeElement.id === 'finish'")
        looked_at(page)
        page.press("Enter")
        page.until(f"{SHOWN}('report')")
        looked_at(page)
        assert page.complaints() == []
    assert kept(record) == [-1.7, 0.4, 1.1, 0.2]
    assert (tmp_path / "mill-results" / "report.pdf").is_file()


@pytest.mark.long
@pytest.mark.chromium
def test_the_page_speaks_german_and_so_do_its_answers(browser: Browser, tmp_path: Path) -> None:
    record = started(tmp_path)
    page = browser.page(1400, 900)
    with served(record, "--language", "de") as server:
        arrived(page, server)
        assert page.value("document.documentElement.lang") == "de"
        assert page.value("document.getElementById('stands').textContent") == "Es steht"
        looked_at(page)
        stand(page)
        type_reading(page, "-1,7")
        page.until(f"{SHOWN}('answer') && /^NOCH 3 MESSUNGEN, /.test(document.getElementById('first').textContent)")
        looked_at(page)
        page.enter("400")
        page.until("document.getElementById('heard').textContent.includes('neben dem Erwarteten')")
        looked_at(page)
        page.press("Enter")
        assert page.value("document.getElementById('sign').textContent").startswith("+ wo das Werkzeug")
        assert server.state()["question"]["sign"].startswith("+ wo das Werkzeug")
        refused = server.call("typed?text=zwei").document["sentence"]
        assert refused.startswith("„zwei“ ist ")
        assert page.complaints() == []


@pytest.mark.long
@pytest.mark.chromium
def test_the_token_stays_in_the_tab_that_opened_the_printed_address(browser: Browser, tmp_path: Path) -> None:
    page, other = browser.page(768, 1024), browser.page(768, 1024)
    with served(started(tmp_path)) as server:
        bare = server.address.partition("#")[0]
        other.open(bare)
        refused = "document.getElementById('trouble').textContent.startsWith('Open the address that axiscal serve')"
        other.until(refused)
        other.call("Page.navigate", url=server.address)  # in the tab that shows the page already
        other.until(f"{SHOWN}('mount')")
        arrived(page, server)
        page.open(bare)
        page.until("document.activeElement.id === 'stands'")
        assert page.value("location.href") == bare
        assert browser.call("Storage.getCookies")["cookies"] == []


@pytest.mark.long
@pytest.mark.chromium
def test_two_windows_see_each_other_and_none_answers_for_the_other(browser: Browser, tmp_path: Path) -> None:
    record = started(tmp_path)
    one, two = browser.page(1400, 900), browser.page(768, 1024)
    with served(record) as server:
        for page in (one, two):
            arrived(page, server)
            stand(page)
        two.type("9.9")
        type_reading(one, "-1.7")
        two.until("document.getElementById('count').textContent === 'reading 2 of 4'")
        assert "9.9" in two.value("document.getElementById('heard').textContent")
        assert two.value("document.getElementById('field').value") == ""
        type_reading(two, "0.5")
        one.until("document.getElementById('count').textContent === 'reading 3 of 4'")
        looked_at(two)
        assert one.complaints() + two.complaints() == []
    assert kept(record) == [-1.7, 0.5]


@pytest.mark.long
@pytest.mark.chromium
def test_what_people_write_is_text_and_nothing_else(browser: Browser, tmp_path: Path) -> None:
    name = HOSTILE.replace("\\", "\\\\").replace('"', '\\"')
    record = started(tmp_path, FOUR_READINGS.replace('name = "laser"', f'name = "{name}"'))
    page = browser.page(390, 844)
    with served(record) as server:
        arrived(page, server)
        stand(page)
        tab_to(page, "further", "Enter")
        tab_to(page, "skip", "Enter")
        page.enter(HOSTILE)
        page.until("document.getElementById('heard').textContent.startsWith('Skipped')")
        page.enter(HOSTILE)
        page.until("document.getElementById('heard').className === 'alarm'")
        assert HOSTILE in page.value("document.getElementById('setup').textContent")
        assert page.value(f"document.querySelectorAll(`{STRANGE}, script:not([src]), [onload], [onerror]`).length") == 0
        looked_at(page)
        assert page.complaints() == []


@pytest.mark.long
@pytest.mark.chromium
def test_what_is_typed_stays_where_no_answer_comes(browser: Browser, tmp_path: Path) -> None:
    page = browser.page(768, 1024)
    with serving(started(tmp_path)) as (server, process):
        arrived(page, server)
        stand(page)
        page.until("document.activeElement.id === 'field'")
        process.kill()
        page.enter("0.5")
        page.until("document.getElementById('heard').textContent.startsWith('No answer came')")
        assert page.value("document.getElementById('field').value") == "0.5"
