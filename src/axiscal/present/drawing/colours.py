"""Colours of a picture: scales from numbers to colours, and maps as small images."""

from __future__ import annotations

import base64
import re
import struct
import zlib
from collections.abc import Mapping, Sequence

import numpy as np

from axiscal.numerics import Array

ColourScale = Sequence[tuple[float, str]]
"""(share from 0 to 1, "#rrggbb"), rising."""

_FINER = 4
"""Pixels of a map for each of its values along each side: the browser smooths the rest."""
_VARIABLE = re.compile(r'(?<==")var\((--[a-z-]+)\)(?=")')
"""As the value of an attribute; quotes in words are escaped, so that none of them is one."""

IN_LIGHT: Mapping[str, str] = {
    "--edge": "#8b96a3",
    "--bed": "#c9d0d8",
    "--table": "#dfe4ea",
    "--head": "#eef1f5",
    "--part": "#2f6fc4",
    "--stone": "#6b7683",
    "--beam": "#d1342c",
    "--read": "#0b6e4f",
    "--read-band": "rgba(11, 110, 79, 0.18)",
    "--gold": "#b7791f",
}
"""What the variables of a drawn machine are on a light ground; matters of taste."""
IN_DARK: Mapping[str, str] = {
    "--edge": "#5d6a78",
    "--bed": "#2a333d",
    "--table": "#3a4551",
    "--head": "#4a5664",
    "--part": "#7db0ff",
    "--stone": "#8fa0b3",
    "--beam": "#ff6b61",
    "--read": "#4fd1a5",
    "--read-band": "rgba(79, 209, 165, 0.18)",
    "--gold": "#f0b95a",
}
"""The same on a dark ground."""
ON_PAPER: Mapping[str, str] = {
    **IN_LIGHT,
    "--paper": "#ffffff",
    "--card": "#ffffff",
    "--ink": "#1b2328",
    "--soft": "#55606a",
    "--rule": "#c9c6bd",
    "--grid": "#ecebe6",
    "--accent": "#0b5c8a",
    "--worst": "#a3690c",
    "--truth": "#c2491d",
    "--truth-band": "rgba(194, 73, 29, 0.22)",
    "--alarm": "#b3261e",
    "--seen": "rgba(11, 92, 138, 0.42)",
    "--whole": "rgba(11, 92, 138, 0.17)",
    "--prior": "rgba(110, 108, 100, 0.09)",
    "--whisker": "rgba(27, 35, 40, 0.35)",
    "--prior-line": "#c9c6bd",
}
"""What the variables of the page are on paper; matters of taste."""


def variables(values: Mapping[str, str]) -> str:
    """Return values of variables as CSS."""
    return "".join(f"{name}:{value};" for name, value in values.items())


def on_paper(svg: str) -> str:
    """Return a picture with the colours of paper instead of the page's variables."""
    return _VARIABLE.sub(lambda found: ON_PAPER[found[1]], svg)


def colours_of(values: Array, scale: ColourScale, low: float, high: float) -> Array:
    """Return red, green and blue of values, (..., 3) from 0 to 255."""
    shares = [share for share, _ in scale]
    stops = np.array([[int(text[i : i + 2], 16) for i in (1, 3, 5)] for _, text in scale], dtype=float)
    at = np.clip((values - low) / ((high - low) or 1.0), 0.0, 1.0)
    mixed: Array = np.stack([np.interp(at, shares, stops[:, k]) for k in range(3)], axis=-1)
    return mixed


def map_image(rows: Sequence[Sequence[float]], scale: ColourScale, low: float, high: float) -> str:
    """Return a map as a data address of a PNG, its first row below.  rows : (m, n)"""
    values = np.array(rows, dtype=float)
    finer = _stretched(_stretched(values, 0), 1)[::-1]
    return f"data:image/png;base64,{base64.b64encode(_png(colours_of(finer, scale, low, high))).decode('ascii')}"


def _stretched(values: Array, axis: int) -> Array:
    """Return values with lines between them along an axis."""
    count = values.shape[axis]
    at = np.linspace(0, count - 1, (count - 1) * _FINER + 1)
    lower = np.minimum(at.astype(int), max(count - 2, 0))
    share = np.expand_dims(at - lower, 1 - axis)
    upper = np.minimum(lower + 1, count - 1)
    mixed: Array = (1 - share) * np.take(values, lower, axis) + share * np.take(values, upper, axis)
    return mixed


def _png(colours: Array) -> bytes:
    """Return an image in the format PNG (ISO/IEC 15948).  colours : (height, width, 3) from 0 to 255"""
    height, width, _ = colours.shape
    pixels = np.rint(colours).astype(np.uint8)
    lines = b"".join(b"\x00" + row.tobytes() for row in pixels)
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", head), (b"IDAT", zlib.compress(lines, 9)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, data) for kind, data in chunks)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
