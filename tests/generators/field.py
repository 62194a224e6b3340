"""Files of people on which the program failed, beside the checkout; tests hold without them, by files of their own."""

from __future__ import annotations

from pathlib import Path

FIELD = Path(__file__).resolve().parents[3] / "shared" / "field"
