"""The bill of materials: everything that is pinned stands in it, and what is not as it was pinned is named."""

from __future__ import annotations

import re

import numpy as np
import pytest

from tests.reliability.audit import ROOT, Pin, bill, faults, pins

LOCKS = ["run.txt", "dev.txt"]


@pytest.mark.parametrize("lock", LOCKS)
def test_every_pin_stands_in_the_bill_with_its_hashes(lock: str) -> None:
    text = (ROOT / "requirements" / lock).read_text()
    pinned = pins(text)
    assert len(pinned) == len(re.findall(r"^[A-Za-z].*==", text, flags=re.MULTILINE))
    assert sum(len(pin.hashes) for pin in pinned) == text.count("--hash=sha256:")
    components = bill(pinned, "0")["components"]
    assert isinstance(components, list)
    assert [each["name"] for each in components] == [pin.name for pin in pinned]
    assert all(each["hashes"] for each in components)


def test_what_is_not_as_it_was_pinned_is_named() -> None:
    assert faults([Pin("numpy", np.__version__, ("0" * 64,))]) == []
    assert "0.0.1 is pinned and" in faults([Pin("numpy", "0.0.1", ("0" * 64,))])[0]
    assert "without a hash" in faults([Pin("numpy", np.__version__, ())])[0]
    assert faults([Pin("surely-not-installed", "1", ("0" * 64,))]) == []
