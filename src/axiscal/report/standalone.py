"""What every page of ours carries inside itself: figures, scripts and styles. It asks the network for nothing."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Iterable
from functools import cache
from importlib import resources
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from axiscal.report.figures import Figure


def environment(package: str) -> Environment:
    """Return what renders the templates of a package, which may extend `standalone.html`.

    A name that has no value is a fault, and no value is markup.
    """
    return Environment(
        loader=ChoiceLoader([PackageLoader(package), PackageLoader("axiscal.report")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def inlined() -> dict[str, Any]:
    """Return what a template needs beside its own values: `css`, `scripts`, and the `policy` that allows just these."""
    scripts = [_plotly(), _static("report.js")]
    return {"css": Markup(_static("report.css")), "scripts": [Markup(s) for s in scripts], "policy": policy(scripts)}


class Drawings:
    """The figures of a page in the order in which the template places them."""

    def __init__(self) -> None:
        self._figures: list[Figure] = []

    def add(self, figure: Figure) -> int:
        """Take a figure and return the number under which the page finds it."""
        self._figures.append(figure)
        return len(self._figures) - 1

    def json(self) -> Markup:
        """Return all figures taken so far as JSON that is safe inside a script element."""
        return script_json(self._figures)


def script_json(value: Any) -> Markup:
    """Return JSON without any character that could end a script element or a line of script."""
    text = json.dumps(value, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"))


def policy(scripts: Iterable[str]) -> str:
    """Return a content security policy under which these scripts run, and nothing else runs or is fetched."""
    hashes = " ".join(f"'sha256-{_hash(script)}'" for script in scripts)
    return (
        f"default-src 'none'; script-src {hashes}; style-src 'unsafe-inline'; img-src data: blob:; "
        "base-uri 'none'; form-action 'none'"
    )


@cache
def _hash(script: str) -> str:
    return base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")


@cache
def _plotly() -> str:
    source = resources.files("plotly").joinpath("package_data", "plotly.min.js").read_text(encoding="utf-8")
    return source.replace("\r\n", "\n")  # as the HTML parser will, or the hash would not fit


def _static(name: str) -> str:
    return resources.files("axiscal.report").joinpath("static", name).read_text(encoding="utf-8")
