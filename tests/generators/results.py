"""Results of golden campaigns, their long lists as short as they are kept, and one whose every text is an attack."""

import json
from typing import Any

from axiscal.present.result import Result
from tests.golden.__main__ import EXPECTED

HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\"'`&{{ 7*7 }}\u2028javascript:alert(3)"


def golden_result(name: str, **changes: Any) -> Result:
    """Return the result of a campaign, such as "mill/out", with changes."""
    found = json.loads((EXPECTED / name / "result.json").read_text(encoding="utf-8"))
    return Result.model_validate({**_whole(found), **changes})


def _whole(found: Any) -> Any:
    """Return a document whose lists stand in the place of what was kept of them."""
    if isinstance(found, dict):
        if "values" in found and found.keys() & {"length", "lengths"}:
            return _whole(found["values"])
        return {name: _whole(each) for name, each in found.items()}
    return [_whole(each) for each in found] if isinstance(found, list) else found


def with_every_text(value: Any, text: str) -> Any:
    """Return value with every piece of text in it replaced, keys of tables that are names of somebody included."""
    if isinstance(value, str):
        return text
    if hasattr(value, "model_copy"):
        return value.model_copy(update={name: with_every_text(each, text) for name, each in value})
    if isinstance(value, dict):
        names = [name if name.islower() or name[0] == "U" else f"{text}{n}" for n, name in enumerate(value)]
        return {name: with_every_text(item, text) for name, item in zip(names, value.values(), strict=True)}
    if isinstance(value, list | tuple):
        return type(value)(with_every_text(item, text) for item in value)
    return value
