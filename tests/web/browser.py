"""Debian's Chromium, driven by its own protocol through two pipes: keys pressed, pages measured, no other program."""

from __future__ import annotations

import base64
import fcntl
import json
import os
import select
import shutil
import subprocess
import time
from contextlib import suppress
from importlib import resources
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import pytest

PATIENCE = 150.0
"""s: for a page on a busy computer."""
_OPTIONS = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]
_OPTIONS += ["--disable-component-update", "--disable-sync", "--remote-debugging-pipe", "--hide-scrollbars"]
_KEYS = {
    "Enter": ("\r", 13),
    "Tab": ("", 9),
    "Escape": ("", 27),
    "Backspace": ("", 8),
    "ArrowRight": ("", 39),
    " ": (" ", 32),
}
_NAVIGATED = {"Inspected target navigated or closed", "Cannot find default execution context"}
"""What the browser answers of a page that has just gone for the next one."""


class NavigatedError(AssertionError):
    """The page that was asked has gone for the next one."""


class Browser:
    """One Chromium; a context manager."""

    def __init__(self, folder: Path) -> None:
        found = shutil.which("chromium")
        if found is None:
            pytest.skip("Debian package chromium is not installed")
        to_browser, self._send = (_lifted(each) for each in os.pipe())
        self._receive, from_browser = (_lifted(each) for each in os.pipe())
        command = [
            "/bin/sh",
            "-c",
            f'exec "$0" "$@" 3</proc/self/fd/{to_browser} 4>/proc/self/fd/{from_browser}',
            found,
            *_OPTIONS,
        ]
        command += [f"--user-data-dir={folder / 'profile'}", "about:blank"]
        self._process = subprocess.Popen(command, pass_fds=(to_browser, from_browser), stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self._left, self._number = b"", 0
        self.events: list[dict[str, Any]] = []

    def page(self, width: int, height: int, *, dark: bool = False) -> Page:
        """Return a new empty page of this size."""
        target = self.call("Target.createTarget", url="about:blank", newWindow=True)["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        page = Page(self, session)
        for domain in ("Page", "Runtime", "Log", "Accessibility"):
            page.call(f"{domain}.enable")
        page.resize(width, height)
        page.shade(dark=dark)
        return page

    def drawn(self, url: str, there: str = "true") -> tuple[str, list[str]]:
        """Return a page as drawn once an expression is true in it, and what its console complains of."""
        page = self.page(800, 600)
        page.open(url)
        page.until(there)
        return str(page.value("document.documentElement.outerHTML")), page.complaints()

    def call(self, method: str, session: str = "", **parameters: Any) -> dict[str, Any]:
        """Return what the browser answers to a command."""
        self._number += 1
        message: dict[str, Any] = {"id": self._number, "method": method, "params": parameters}
        os.write(self._send, json.dumps(message | ({"sessionId": session} if session else {})).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") != self._number:
                self.events.append(answer)
                continue
            if answer.get("error", {}).get("message") in _NAVIGATED:
                raise NavigatedError(method)
            assert "error" not in answer, f"{method}: {answer['error']}"
            result: dict[str, Any] = answer["result"]
            return result

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._left:
            ready, _, _ = select.select([self._receive], [], [], PATIENCE)
            assert ready, "the browser says nothing"
            came = os.read(self._receive, 1 << 20)
            assert came, "the browser has ended"
            self._left += came
        message, _, self._left = self._left.partition(b"\0")
        decoded: dict[str, Any] = json.loads(message)
        return decoded

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> None:
        self._process.kill()
        self._process.wait()
        os.close(self._send)
        os.close(self._receive)


def _lifted(handle: int) -> int:
    """Return another handle of the same pipe, above those that the browser is given by number."""
    try:
        return fcntl.fcntl(handle, fcntl.F_DUPFD_CLOEXEC, 10)
    finally:
        os.close(handle)


class Page:
    """One page of the browser."""

    def __init__(self, browser: Browser, session: str) -> None:
        self._browser, self._session = browser, session

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Return what the page answers to a command."""
        return self._browser.call(method, self._session, **parameters)

    def resize(self, width: int, height: int) -> None:
        """Give the page a size in CSS pixels."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.call("Emulation.setDeviceMetricsOverride", **size)

    def shade(self, *, dark: bool) -> None:
        """Let the page think that the computer is set to dark or light."""
        features = [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]
        self.call("Emulation.setEmulatedMedia", features=features)

    def open(self, address: str) -> None:
        """Go to an address and wait until the page is there."""
        for each in ("about:blank", address):  # an address that differs behind the # alone loads nothing
            self.call("Page.navigate", url=each)
        self.until("document.body && document.readyState === 'complete'")

    def saves_into(self, folder: Path) -> None:
        """Save downloads in this folder."""
        self.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(folder))

    def value(self, expression: str) -> Any:
        """Return the value of an expression in the page."""
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def until(self, expression: str) -> Any:
        """Wait until an expression is true in the page, and return it."""
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            with suppress(NavigatedError):  # the next page is asked
                if found := self.value(expression):
                    return found
            time.sleep(0.03)
        raise AssertionError(f"never came: {expression}\n{self.value('document.body?.innerText')}")

    def type(self, text: str) -> None:
        """Type letters where the focus is."""
        self.call("Input.insertText", text=text)

    def enter(self, text: str) -> None:
        """Type letters where the focus is, and Enter."""
        self.type(text)
        self.press("Enter")

    def press(self, key: str) -> None:
        """Press and release a key."""
        text, code = _KEYS[key]
        pressed = {"key": key, "code": key.replace(" ", "Space"), "windowsVirtualKeyCode": code}
        self.call("Input.dispatchKeyEvent", type="keyDown", **pressed, **({"text": text} if text else {}))
        self.call("Input.dispatchKeyEvent", type="keyUp", **pressed)

    def broken_rules(self) -> list[str]:
        """Return the rules of accessibility that axe finds broken in what is shown, each with the elements."""
        rules = resources.files("axe_core_python").joinpath("axe.min.js").read_text(encoding="utf-8")
        self.value(f"{rules}; 0")
        named = "v => `${v.id}: ${v.nodes.map(n => n.html.slice(0, 80)).join(' ')}`"
        looked = self.value(f"axe.run(document).then(r => [r.passes.length, r.violations.map({named})])")
        assert looked[0] > 20, "axe has not looked"
        return [str(each) for each in looked[1]]

    def picture(self, file: Path) -> None:
        """Save what the page looks like, all of it."""
        shot = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=True)
        file.write_bytes(base64.b64decode(shot["data"]))

    def complaints(self) -> list[str]:
        """Return what the console said of errors so far."""
        self.value("0")
        own = [each for each in self._browser.events if each.get("sessionId") == self._session]
        entries = [each["params"]["entry"] for each in own if each["method"] == "Log.entryAdded"]
        logged = [f"{each['text']} {each.get('url', '')}".rstrip() for each in entries]
        thrown = [str(each["params"]) for each in own if each["method"] == "Runtime.exceptionThrown"]
        said = [each for each in own if each["method"] == "Runtime.consoleAPICalled"]
        return logged + thrown + [str(each["params"]["args"]) for each in said if each["params"]["type"] == "error"]
