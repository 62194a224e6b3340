"""What every page of ours carries inside itself: scripts and styles. It asks the network for nothing."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Callable, Iterable
from importlib import resources
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from axiscal.language.spoken import counted, said, spoken_now
from axiscal.present.drawing.colours import IN_DARK, IN_LIGHT, variables


def environment(package: str, written: Callable[[object], object] | None = None) -> Environment:
    """Return what renders the templates of a package, which may extend `standalone.html`.

    A name that has no value is a fault, and no value is markup.
    written : how a value is written, as markup, in a template that is not HTML
    """
    made = Environment(
        loader=ChoiceLoader([PackageLoader(package), PackageLoader("axiscal.present")]),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=written,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.globals |= {"said": said, "counted": counted, "rich": _rich, "language": spoken_now}
    return made


def page_of(package: str, template: str, **values: object) -> str:
    """Return a template of a package as a page, with what every page needs beside its own values."""
    text: str = environment(package).get_template(template).render(values | inlined())
    return text


def _rich(message: str, **values: str) -> Markup:
    """Return a message with markup among its values: what is no markup is made safe, the message as well."""
    words = said(message, **{name: f"{{{name}}}" for name in values})
    return Markup(escape(words)).format(**values)


def inlined() -> dict[str, Any]:
    """Return what a template needs beside its own values: `css`, `scripts`, and the `policy` that allows just these."""
    scripts = [static_text("report.js")]
    dark = f"@media screen and (prefers-color-scheme:dark){{:root{{{variables(IN_DARK)}}}}}"
    return {
        "css": Markup(f":root{{{variables(IN_LIGHT)}}}\n{dark}\n" + static_text("report.css")),
        "scripts": [Markup(s) for s in scripts],
        "policy": policy(scripts),
    }


def policy(scripts: Iterable[str]) -> str:
    """Return a content security policy under which these scripts run, and nothing else runs or is fetched."""
    digests = (base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii") for script in scripts)
    hashes = " ".join(f"'sha256-{digest}'" for digest in digests)
    return (
        f"default-src 'none'; script-src {hashes}; style-src 'unsafe-inline'; img-src data: blob:; "
        "base-uri 'none'; form-action 'none'"
    )


def static_text(name: str) -> str:
    """Return a text file of this package."""
    return resources.files("axiscal.present").joinpath("static", name).read_text(encoding="utf-8")
